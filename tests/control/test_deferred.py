"""What a move works out only when it is asked for."""

import pickle

import pytest

from hysdel_py.control.move import Deferred, Move, MoveStatus


def counted(calls, value):
    def make():
        calls.append(value)
        return value

    return Deferred(make)


def test_a_deferred_field_is_worked_out_once_and_only_when_asked():
    calls = []
    move = Move(MoveStatus.OPTIMAL, counted(calls, "words"))
    later = move.at(0.5)
    assert (calls, later.seconds) == ([], 0.5)
    assert later.message == later.message == "words"
    assert calls == ["words"]


def test_a_move_with_deferred_fields_can_be_stored():
    move = Move(MoveStatus.OPTIMAL, counted([], "words"))
    assert pickle.loads(pickle.dumps(move)).message == "words"


def test_time_does_not_change_the_rest():
    move = Move(MoveStatus.FEASIBLE, "as it is", cost=3.0, nodes=7)
    later = move.at(2.0)
    assert (later.status, later.message, later.cost, later.nodes) == (MoveStatus.FEASIBLE, "as it is", 3.0, 7)
    with pytest.raises(AttributeError):
        later.cost = 4.0
