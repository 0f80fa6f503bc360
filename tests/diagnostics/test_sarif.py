"""The log has the properties that SARIF 2.1.0 requires, and points where the text does."""

import json

import pytest

import hysdel_py as hys
from hysdel_py.diagnostics.sarif import as_sarif
from hysdel_py.syntax.source import Source

TEXT = """SYSTEM s {
  INTERFACE { STATE { REAL x [-1, 1]; REAL x [0, 1]; } }
  IMPLEMENTATION { CONTINUOUS { x = 0.5*x } }
}
"""


@pytest.fixture
def log(tmp_path):
    path = tmp_path / "with blank.hys"
    path.write_text(TEXT, encoding="utf-8")
    with pytest.raises(hys.CompileError) as caught:
        hys.load(path)
    source = Source(path.name, TEXT, path)
    return json.loads(json.dumps(as_sarif([(source, d) for d in caught.value.diagnostics], "1.0")))


def test_log_and_run(log):
    assert log["version"] == "2.1.0"
    assert log["$schema"].endswith("sarif-2.1.0.json")
    (run,) = log["runs"]
    driver = run["tool"]["driver"]
    assert driver["name"] == "hysdel"
    assert [rule["id"] for rule in driver["rules"]] == ["HYS104", "HYS202"]
    assert all(rule["shortDescription"]["text"] for rule in driver["rules"])


def test_results(log):
    (run,) = log["runs"]
    twice, semicolon = run["results"]
    for result in (twice, semicolon):
        assert run["tool"]["driver"]["rules"][result["ruleIndex"]]["id"] == result["ruleId"]
        assert result["level"] == "error"
        assert result["message"]["text"]
        physical = result["locations"][0]["physicalLocation"]
        assert physical["artifactLocation"]["uri"].endswith("with%20blank.hys")
    region = semicolon["locations"][0]["physicalLocation"]["region"]
    assert region == {"startLine": 3, "startColumn": 41, "endLine": 3, "endColumn": 42}
    (replacement,) = semicolon["fixes"][0]["artifactChanges"][0]["replacements"]
    assert replacement["insertedContent"] == {"text": ";"}
    assert replacement["deletedRegion"]["startColumn"] == replacement["deletedRegion"]["endColumn"] == 42
    (related,) = twice["relatedLocations"]
    assert related["message"]["text"] == "declared here"
    assert related["physicalLocation"]["region"]["startColumn"] == 28


def test_empty_log():
    assert as_sarif([], "1.0")["runs"][0]["results"] == []
