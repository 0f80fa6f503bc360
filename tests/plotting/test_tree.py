"""The picture of a search shows its nodes, bounds, fates and branching variables."""

import pytest

import hysdel_py as hys
from hysdel_py.errors import ArgumentError
from hysdel_py.optimize.mixed_integer import NodeFate, NodeRecord, SearchInfo
from hysdel_py.plotting.tree import places, plot_tree

SPLIT, CUT, EMPTY, LEAF = NodeFate.SPLIT, NodeFate.CUT_OFF, NodeFate.INFEASIBLE, NodeFate.LEAF


def searched(node_limit=None):
    """A search with some branching, and what its variables are called."""
    log = hys.NodeLog()
    mpc = hys.HybridMpc(
        hys.load("three_tanks"), 3, hys.Cost(y={"level(2)": 1}), progress=log, backend="piqp", node_limit=node_limit
    )
    move = mpc.solve([1, 2, 1], {"level(2)": 3})
    return log, move, [mpc.formulation.describe_variable(i) for i in range(mpc.formulation.layout.n)]


def words(figure):
    return [text.get_text() for text in figure.axes[0].texts]


def legend(figure):
    return [text.get_text() for text in figure.axes[0].get_legend().get_texts()]


def test_tree_shows_every_node_with_its_branching_variable_and_bound():
    log, move, names = searched(node_limit=25)
    figure = plot_tree(log.entries, names)
    texts = words(figure)
    records = [entry.node for entry in log.entries]
    assert len(records) == move.nodes == 25
    for record in records:
        assert any(text.split("\n")[0] == str(record.number) for text in texts)
        if record.parent:
            assert f"{names[record.variable].partition(' (line')[0]} = {record.value:g}" in texts
    root = next(text for text in texts if text.startswith("1\n"))
    assert root == f"1\n{records[0].bound:.5g}"
    assert any("open(1)" in text or "high(" in text for text in texts), "names of the source"
    counts = {fate: sum(record.fate is fate for record in records) for fate in NodeFate}
    assert {f"{fate.value} ({count})" for fate, count in counts.items() if count} <= set(legend(figure))
    assert "not visited" in legend(figure)
    assert "25 nodes" in figure.axes[0].get_title(loc="left")


def test_records_form_one_tree():
    log, move, _ = searched()
    records = [entry.node for entry in log.entries]
    assert [record.number for record in records] == list(range(1, move.nodes + 1))
    assert [record.parent for record in records].count(0) == 1
    by_number = {record.number: record for record in records}
    for record in records[1:]:
        parent = by_number[record.parent]
        assert parent.fate is SPLIT
        assert parent.number < record.number
        assert record.bound >= parent.bound
    halves = sorted((r.parent, r.value) for r in records[1:])
    assert halves == [(r.number, value) for r in records if r.fate is SPLIT for value in (0.0, 1.0)]
    assert move.status is hys.MoveStatus.OPTIMAL


def record(number, parent, value, fate):
    return NodeRecord(number, parent, 0, value, 1.0, fate)


def test_places_stand_above_the_middle_of_their_halves():
    """A root whose 1 is split into an empty half and one that was not visited; its 0 is a leaf."""
    tree = [record(1, 0, 0, SPLIT), record(2, 1, 1, SPLIT), record(3, 2, 0, EMPTY), record(4, 1, 0, LEAF)]
    drawn = places(tree)
    assert [(p.across, p.level, p.parent) for p in drawn] == [
        (0.75, 0, -1), (1.5, 1, 0), (1.0, 2, 1), (0.0, 1, 0), (2.0, 2, 1),
    ]  # fmt: skip
    assert [p.record for p in drawn] == [*tree, None]


def test_large_tree_has_no_words_and_still_a_legend():
    chain = [record(k, k - 1, 1.0, SPLIT) for k in range(1, 101)]
    figure = plot_tree([SearchInfo(r.number, r.number, 1, 5.0, 1.0, 0.1, r) for r in chain], ["d[0] x (line 3)"], "all")
    assert words(figure) == []
    assert "split (100)" in legend(figure)
    assert "better plan found (1)" in legend(figure)
    assert figure.axes[0].get_title(loc="left").startswith("all: 100 nodes")


@pytest.mark.parametrize("entries", [[], [SearchInfo(1, 1, 0, 1.0, 1.0, 0.1)]])
def test_log_without_nodes_is_refused(entries):
    with pytest.raises(ArgumentError, match="no nodes to draw"):
        plot_tree(entries, [])
