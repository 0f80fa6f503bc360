"""The grammar for editors is up to date and colours samples as it should."""

import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from hysdel_py.export.tmlanguage import SCOPE, grammar_json, tmlanguage
from hysdel_py.syntax.parser import grammar_text
from hysdel_py.syntax.tokens import KEYWORDS

ROOT = Path(__file__).parents[2]
EXTENSION = ROOT / "editors" / "vscode"
FILE = EXTENSION / "syntaxes" / "hysdel.tmLanguage.json"

SAMPLE = """/* [m] two
lines REAL */ SYSTEM tank2 {
REAL x [-1.5e-3, .5], sinus; // rest
d = a <-> ~b2 && TRUE; z = {IF d THEN sin(pi*x) ELSE 2^x}; REALM IFS d4 = x(2:3) == 1.;
INDEX i; FOR (i = 1:n) { t1.q < W(i, 1); INDEX = 2;
"""
SECTION, TYPE, NAME = "keyword.other.section", "storage.type", "variable.other"
EXPECTED = [
    ("/*", "comment.block"), ("[m]", "constant.other.unit"), ("two", "comment.block"), ("lines REAL", "comment.block"),
    ("*/", "comment.block"), ("SYSTEM", SECTION), ("tank2", NAME), ("REAL", TYPE), ("x", NAME),
    ("-", "keyword.operator"), ("1.5e-3", "constant.numeric"), (",", "punctuation.separator"),
    (".5", "constant.numeric"), ("sinus", NAME), ("// rest", "comment.line.double-slash"), ("<->", "keyword.operator"),
    ("~", "keyword.operator"), ("b2", NAME), ("&&", "keyword.operator"), ("TRUE", "constant.language"),
    ("IF", "keyword.control"), ("THEN", "keyword.control"), ("sin", "support.function"), ("pi", "variable.language"),
    ("ELSE", "keyword.control"), ("REALM", NAME), ("IFS", NAME), ("d4", NAME), (":", "keyword.operator"),
    ("==", "keyword.operator"), ("1.", "constant.numeric"), ("INDEX", TYPE), ("i", NAME),
    ("FOR", "keyword.control"), ("=", "keyword.operator"),
    (":", "keyword.operator"), ("t1.q", NAME), ("<", "keyword.operator"), ("W", NAME), ("INDEX", NAME),
]  # fmt: skip


def by_python(text, grammar):
    """What a TextMate tokenizer does with the few features that the grammar uses."""
    rules, pairs, at, inside = grammar["patterns"], [], 0, None

    def note(piece, scope):
        if piece.strip():
            pairs.extend((line.strip(), scope) for line in piece.split("\n") if line.strip())

    while at < len(text):
        active = inside["patterns"] if inside else rules
        found = [(m, r) for r in active if (m := re.compile(r.get("match") or r["begin"], re.M).search(text, at))]
        if inside and (end := re.compile(inside["end"]).search(text, at)):
            found.insert(0, (end, {"name": inside["name"], "ends": True}))
        if not found:
            break
        match, rule = min(found, key=lambda pair: pair[0].start())
        note(text[at : match.start()], inside["name"] if inside else SCOPE)
        capture = rule.get("captures")
        if capture:
            note(match[1], capture["1"]["name"])
        else:
            note(match[0], rule["name"])
        at = match.end()
        inside = None if rule.get("ends") else rule if "begin" in rule else inside
    return pairs


def check(pairs):
    wanted = [(text, f"{scope}.hysdel") for text, scope in EXPECTED]
    found = iter(tuple(pair) for pair in pairs)
    missing = [pair for pair in wanted if pair not in found]  # in this order, others between them
    assert not missing


def test_file_is_up_to_date():
    assert FILE.read_text(encoding="utf-8") == grammar_json(), "run python -m hysdel_py.export.tmlanguage " + str(FILE)


def test_sample():
    check(by_python(SAMPLE, json.loads(FILE.read_text(encoding="utf-8"))))


def test_every_keyword_is_coloured():
    grammar = tmlanguage(grammar_text())
    for word in KEYWORDS:
        assert by_python(word, grammar)[0][1].startswith(("keyword.", "storage.", "constant.language"))


def test_extension_names_its_files():
    package = json.loads((EXTENSION / "package.json").read_text(encoding="utf-8"))["contributes"]
    files = [package["languages"][0]["configuration"], package["grammars"][0]["path"]]
    assert all(json.loads((EXTENSION / name).read_text(encoding="utf-8")) for name in files)
    assert package["grammars"][0]["scopeName"] == SCOPE


def test_sample_by_the_tokenizer_of_vs_code():
    folder = os.environ.get("HYSDEL_TEXTMATE", str(EXTENSION))
    if shutil.which("node") is None or not (Path(folder) / "node_modules" / "vscode-textmate").is_dir():
        pytest.skip("needs node, and vscode-textmate and vscode-oniguruma installed in the folder HYSDEL_TEXTMATE")
    program = Path(__file__).with_name("textmate.js")
    shown = subprocess.run(
        ["node", program, folder, FILE], input=SAMPLE, capture_output=True, text=True, check=True, timeout=60
    )
    check(json.loads(shown.stdout))
