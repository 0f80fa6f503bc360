"""``hysdel audit``: the table, its JSON, and what it says of dead branches."""


def test_table(hysdel):
    shown = hysdel("audit", "two_tanks", "--rows", "2")
    lines = shown.out.splitlines()
    assert shown.status == 0
    assert lines[0].startswith("two_tanks: 12 big-M constants, 2 of them smaller by linear programs than by intervals")
    assert lines[2].split()[:4] == ["4", "0.00012", "0", "inf"]
    assert lines[2].endswith("line 47: q_pipe = {IF above THEN k_pipe*(h1 - h_pipe) ELSE 0}")
    assert lines[3].strip() == "0.00024 of 0.00024 comes from the range [0, 0.6] of h1, line 24"
    assert "10 more rows; --rows N shows more of them" in lines


def test_json_has_all_rows(hysdel):
    data = hysdel("audit", "two_tanks", "--json").json
    assert len(data["rows"]) == 12
    assert data["rows"][0]["looseness"] is None
    assert data["rows"][0]["sources"][0] == {
        "name": "h1", "size": 0.00024, "declared": "h1", "line": 24, "low": 0.0, "high": 0.6,
    }  # fmt: skip
    assert data["decided"] == []


def test_dead_branches_are_shown_in_the_source(hysdel, tmp_path):
    text = """SYSTEM s { INTERFACE { STATE { REAL x [-1, 9]; } }
  IMPLEMENTATION { AUX { BOOL d; REAL z; }
    AD { d = x <= 5; }
    DA { z = {IF d THEN x ELSE 7}; }
    CONTINUOUS { x = z; } MUST { x <= 4; x <= 8; } } }"""
    (tmp_path / "dead.hys").write_text(text, encoding="utf-8")
    shown = hysdel("audit", tmp_path / "dead.hys").out
    assert "note[HYS540]: d is always true" in shown
    assert "note[HYS540]: only the THEN branch is ever used" in shown
    assert "follows from the others: line 5: x <= 8" in shown


def test_a_mistake_is_reported(hysdel, tmp_path):
    (tmp_path / "wrong.hys").write_text(
        "SYSTEM s { INTERFACE { } IMPLEMENTATION { LOGIC { a = b; } } }", encoding="utf-8"
    )
    assert hysdel("audit", tmp_path / "wrong.hys").status == 1


def test_a_negative_count_is_refused(hysdel):
    shown = hysdel("audit", "two_tanks", "--rows", "-1")
    assert shown.status == 2
    assert "--rows -1: a number of at least 0 was expected" in shown.err
    assert hysdel("audit", "two_tanks", "--rows", "0").status == 0
