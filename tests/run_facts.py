"""Check the package against a folder of facts: problems with answers that other toolboxes published or computed.

    python tests/run_facts.py FOLDER [--kind KIND] [--explicit]

FOLDER holds JSON files with the entries id, kind, problem, expected and tolerance. One line is printed per fact, then
``N passed, M failed, K skipped``; the exit status is 1 if any fact failed. With ``--explicit`` only the costs of
controllers of piecewise affine systems are compared, by their explicit laws.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

from fact_checks import CHECKS
from fact_hybrid_laws import sampled_law
from fact_tools import NotSupported


def read_facts(folder: Path, kind: str | None) -> list[dict[str, Any]]:
    facts = [json.loads(path.read_text(encoding="utf-8")) for path in sorted(folder.glob("*.json"))]
    return [fact for fact in facts if kind in (None, fact["kind"])]


def check_fact(fact: dict[str, Any]) -> str:
    """Say what was compared; an AssertionError carries a difference, NotSupported what is missing."""
    if fact["kind"] not in CHECKS:
        raise NotSupported(f"facts of the kind {fact['kind']}")
    return CHECKS[fact["kind"]](fact)


def verdict(fact: dict[str, Any], check: Callable[[dict[str, Any]], str] = check_fact) -> tuple[str, str]:
    """The word that counts and the line that is printed."""
    try:
        return "passed", f"{fact['id']}: passed ({check(fact)})"
    except NotSupported as reason:
        return "skipped", f"{fact['id']}: not yet supported ({reason})"
    except AssertionError as difference:
        return "failed", f"{fact['id']}: FAILED, {difference}"


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Check the package against a folder of facts.")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--kind", help="only facts of this kind")
    parser.add_argument("--explicit", action="store_true", help="the costs of controllers, by their explicit laws")
    options = parser.parse_args(arguments)
    check = sampled_law if options.explicit else check_fact
    count: Counter[str] = Counter()
    for fact in read_facts(options.folder, options.kind):
        if options.explicit and "samples" not in fact["expected"]:
            continue
        word, line = verdict(fact, check)
        count[word] += 1
        print(line, flush=True)
    print(f"{count['passed']} passed, {count['failed']} failed, {count['skipped']} skipped")
    return 1 if count["failed"] else 0


if __name__ == "__main__":
    raise SystemExit(main())
