"""Sweeps: same records whoever works, failures with their seed, and files that a sweep goes on from."""

import json
import os
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor
from functools import partial

import numpy as np
import pytest

import hysdel_py as hys
from hysdel_py.sweeps.attempt import plain


def draw(seed):
    return float(np.random.default_rng(seed).normal())


def picky(seed, bad=3):
    if seed == bad:
        raise ValueError(f"{seed} will not do")
    return {"square": np.float64(seed) ** 2, "seeds": np.array([seed, seed + 1])}


def fatal(seed):
    if seed == 2:
        os._exit(7)
    return seed


class CannotBeSent(Exception):
    """As exceptions of solvers are: it cannot be made again from its arguments."""

    def __init__(self, first, second):
        super().__init__(f"{first} and {second}")


def raises_unsendable(seed):
    raise CannotBeSent(seed, lambda: None)


class Backwards:
    """An executor of somebody else: it works when asked for more than two tasks, the last one first."""

    def __init__(self):
        self.waiting, self.most = [], 0

    def submit(self, function, *arguments):
        future = Future()
        self.waiting.append((future, function, arguments))
        self.most = max(self.most, len(self.waiting))
        if len(self.waiting) == 3:
            while self.waiting:
                last, function, arguments = self.waiting.pop()
                last.set_result(function(*arguments))
        return future


@pytest.fixture(scope="module")
def processes():
    with ProcessPoolExecutor(2) as pool:
        yield pool


@pytest.mark.parametrize("task", [draw, picky, partial(picky, bad=5)])
def test_records_do_not_depend_on_the_executor(task, processes, tmp_path):
    here = hys.sweep(task, range(9), resume=tmp_path / "here.jsonl")
    assert [record.seed for record in here.records] == list(range(9))
    with ThreadPoolExecutor(3) as threads:
        assert hys.sweep(task, range(9), executor=threads, resume=tmp_path / "threads.jsonl") == here
    assert hys.sweep(task, range(9), executor=processes, window=2, resume=tmp_path / "processes.jsonl") == here


def test_values_are_those_of_the_task():
    assert hys.sweep(draw, [4, 1]).values == (draw(4), draw(1))


def test_any_executor_with_submit_will_do():
    pool = Backwards()
    found = hys.sweep(draw, range(9), executor=pool, window=3)
    assert found == hys.sweep(draw, range(9))
    assert pool.most == 3


@pytest.mark.parametrize("pool", [None, "processes"])
def test_failures_are_records_with_their_seed(pool, request):
    executor = pool and request.getfixturevalue(pool)
    found = hys.sweep(picky, range(6), executor=executor)
    assert not found.ok
    assert len(found.values) == 5
    assert found.failure_text() == "seed 3: ValueError: 3 will not do"
    assert "in picky" in found[3].trace
    assert repr(found) == "<Sweep of 6 tasks: 5 done, 1 failed>"


def test_exceptions_that_cannot_be_sent_are_records(processes):
    found = hys.sweep(raises_unsendable, [1], executor=processes)
    assert found[1].error.startswith("CannotBeSent: 1 and")


def test_a_dead_worker_is_a_record_and_the_rest_goes_on_later(tmp_path):
    kept = tmp_path / "fatal.jsonl"
    with ProcessPoolExecutor(1) as pool:
        found = hys.sweep(fatal, range(5), executor=pool, resume=kept, window=1)
    assert not found[2].ok
    assert "BrokenProcessPool" in found[2].error
    with ProcessPoolExecutor(1) as pool:
        rest = hys.sweep(fatal, [0, 1, 3, 4], executor=pool, resume=kept)
    assert rest.ok
    assert rest.resumed == 2


def test_a_sweep_goes_on_where_it_was_broken_off(tmp_path):
    kept, told = tmp_path / "run.jsonl", []

    def stop(done, total):
        told.append((done, total))
        if done == 4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        hys.sweep(picky, range(8), resume=kept, progress=stop)
    with kept.open("a") as file:
        file.write('{"seed": 4, "val')  # a line that a crash cut off
    found = hys.sweep(picky, range(8), resume=kept, progress=lambda *counts: told.append(counts))
    assert found == hys.sweep(picky, range(8), resume=tmp_path / "other.jsonl")
    assert found.resumed == 3  # the failed one is run again
    assert told == [(1, 8), (2, 8), (3, 8), (4, 8), (4, 8), (5, 8), (6, 8), (7, 8), (8, 8)]
    lines = [json.loads(line) for line in kept.read_text().splitlines()]
    assert [line.get("seed") for line in lines] == [None, 0, 1, 2, 3, 3, 4, 5, 6, 7]


def test_files_of_other_tasks_are_refused(tmp_path):
    kept = tmp_path / "run.jsonl"
    hys.sweep(draw, [1], resume=kept)
    with pytest.raises(hys.ArgumentError, match="holds results of draw, not of picky"):
        hys.sweep(picky, [1], resume=kept)
    hys.sweep(partial(picky, bad=1), [1], resume=tmp_path / "one.jsonl")
    with pytest.raises(hys.ArgumentError, match=r"picky\(bad=1\), not of picky\(bad=2\)"):
        hys.sweep(partial(picky, bad=2), [1], resume=tmp_path / "one.jsonl")
    (tmp_path / "notes.txt").write_text("hello\n")
    with pytest.raises(hys.ArgumentError, match="is no file of a sweep"):
        hys.sweep(draw, [1], resume=tmp_path / "notes.txt")
    assert (tmp_path / "notes.txt").read_text() == "hello\n"


@pytest.mark.parametrize(
    "line",
    [b'{"value": 1}', b"???", b'{"seed": 2}', b'{"seed": true, "value": 1}', b'{"seed": [1], "value": 1}', b"\0\0",
     b'{"seed": 2, "value": "\xff"}', b'{"seed": 2, "va{"seed": 3, "value": 1}', b'{"seed": 2, "error": null}'],
)  # fmt: skip
def test_a_damaged_line_is_named_and_the_others_stay(line, tmp_path):
    kept = tmp_path / "run.jsonl"
    hys.sweep(draw, [1], resume=kept)
    before = kept.read_bytes() + line + b"\n"
    kept.write_bytes(before)
    with pytest.raises(hys.ArgumentError, match=r"line 3 of .* is no result of a task"):
        hys.sweep(draw, [1], resume=kept)
    assert kept.read_bytes() == before


@pytest.mark.parametrize("cut", [0, 1, 10, 34, 40])
def test_a_file_cut_off_in_its_head_begins_anew(cut, tmp_path):
    kept = tmp_path / "run.jsonl"
    first = hys.sweep(draw, [1], resume=kept)
    kept.write_bytes(kept.read_bytes()[:cut])
    assert hys.sweep(draw, [1], resume=kept) == first
    assert hys.sweep(draw, [1], resume=kept).resumed == 1


@pytest.mark.parametrize("content", [b"one line of notes", b'{"results": [1, 2]}', b"\xff\xd8"])
def test_files_of_others_without_a_last_newline_stay(content, tmp_path):
    kept = tmp_path / "notes.txt"
    kept.write_bytes(content)
    with pytest.raises(hys.ArgumentError, match="is no file of a sweep"):
        hys.sweep(draw, [1], resume=kept)
    assert kept.read_bytes() == content


class Gain:
    """A task with an attribute and the representation that Python gives it."""

    def __init__(self, factor):
        self.factor = factor

    def __call__(self, seed):
        return self.factor * seed

    def of(self, seed):
        return self.factor * seed


def scaled(seed, weights):
    return float(weights.sum()) * seed


@pytest.mark.parametrize(
    ("first", "second"),
    [
        (Gain(1), Gain(2)),
        (Gain(1).of, Gain(2).of),
        (lambda seed: seed, lambda seed: 2 * seed),
        (partial(scaled, weights=np.eye(1, 5000, 2000)), partial(scaled, weights=2 * np.eye(1, 5000, 2000))),
        (partial(Gain.of, Gain(1)), partial(Gain.of, Gain(2))),
    ],
)
def test_tasks_that_differ_in_what_they_hold_are_others(first, second, tmp_path):
    kept = tmp_path / "run.jsonl"
    found = hys.sweep(first, [1, 2], resume=kept)
    assert hys.sweep(first, [1, 2], resume=kept) == found
    with pytest.raises(hys.ArgumentError, match="holds results of"):
        hys.sweep(second, [1, 2], resume=kept)


def leaves(seed):
    raise SystemExit(3)


def test_a_task_that_exits_ends_itself():
    here = hys.sweep(leaves, [1, 2])
    assert [record.error for record in here.failures] == ["SystemExit: 3", "SystemExit: 3"]
    with ThreadPoolExecutor(1) as pool:
        assert hys.sweep(leaves, [1, 2], executor=pool) == here


def test_mappings_whose_keys_would_become_one_are_not_kept(tmp_path):
    found = hys.sweep(lambda seed: {1: seed, "1": 0}, [5], resume=tmp_path / "run.jsonl")
    assert "two keys of the same text" in found[5].error
    assert hys.sweep(lambda seed: {(1, 2): seed}, [5], resume=tmp_path / "keys.jsonl").failures


def test_a_client_in_the_place_of_its_executor(tmp_path):
    class Client:
        def submit(self, function, *arguments):
            return "a future of another kind"

    with pytest.raises(hys.ArgumentError, match=r"client\.get_executor"):
        hys.sweep(draw, [1], executor=Client())


def test_names_that_cannot_be_a_file(tmp_path):
    for name, message in ((tmp_path, "is a folder"), (tmp_path / "no" / "x", "does not exist"), (True, "name of a")):
        with pytest.raises(hys.ArgumentError, match=message):
            hys.sweep(draw, [1], resume=name)


def test_results_that_cannot_be_kept_are_records(tmp_path):
    found = hys.sweep(lambda seed: object(), [1], resume=tmp_path / "run.jsonl")
    assert "returned a object; return numbers" in found[1].error
    assert hys.sweep(lambda seed: object(), [1]).ok


def test_numbers_come_back_as_they_were(tmp_path):
    kept = tmp_path / "run.jsonl"
    first = hys.sweep(draw, range(50), resume=kept)
    second = hys.sweep(draw, range(50), resume=kept)
    assert second == first
    assert second.resumed == 50
    assert plain([np.float64(0.1), np.inf, (1, True, None)]) == [0.1, float("inf"), [1, True, None]]


@pytest.mark.parametrize(
    ("seeds", "options", "message"),
    [
        ([1, 1], {}, "seed 1 is there twice"),
        ([1.5], {}, "an int or a str, not 1.5"),
        ([True], {}, "an int or a str, not True"),
        ([1], {"window": 0}, "at least 1, not 0"),
        ([1], {"window": "3"}, "at least 1, not '3'"),
        ([1], {"executor": 4}, "int has none"),
        ([1], {"progress": 4}, "4 cannot be called"),
        (5, {}, "several, as range"),
        (np.eye(2), {}, "an int or a str, not array"),
    ],
)
def test_wrong_arguments(seeds, options, message):
    with pytest.raises(hys.ArgumentError, match=message):
        hys.sweep(draw, seeds, **options)


def test_tasks_that_processes_cannot_find_are_told_before_the_start(processes):
    with pytest.raises(hys.ArgumentError, match="define it at the top of a module"):
        hys.sweep(lambda seed: seed, [1], executor=processes)
    with pytest.raises(hys.ArgumentError, match="cannot be called"):
        hys.sweep(5, [1])
    with pytest.raises(hys.ArgumentError, match="no seed 'x'"):
        hys.sweep(draw, np.arange(2))["x"]
