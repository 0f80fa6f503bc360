"""A task for each seed, on any executor: the same records in the same order, whoever did the work.

Tasks are handed out a window at a time, so that a sweep of a million seeds holds no million futures. Nothing is
scheduled here: order and placement of the work are the executor's.
"""

from __future__ import annotations

import pickle
from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from contextlib import suppress
from numbers import Integral
from pathlib import Path
from typing import Any, Protocol

from hysdel_py.errors import ArgumentError
from hysdel_py.sweeps.attempt import attempt, failed
from hysdel_py.sweeps.journal import Journal, task_name
from hysdel_py.sweeps.record import Seed, Sweep, SweepRecord

__all__ = ["SubmitsTasks", "sweep"]

Task = Callable[[Any], Any]
Progress = Callable[[int, int], Any]


class SubmitsTasks(Protocol):
    """Anything with the `submit` of :class:`concurrent.futures.Executor`."""

    def submit(self, function: Callable[..., Any], /, *arguments: Any) -> Future[Any]:
        """Call a function somewhere, some time."""


def sweep(
    task: Task,
    seeds: Iterable[Seed],
    *,
    executor: SubmitsTasks | None = None,
    resume: str | Path | None = None,
    progress: Progress | None = None,
    window: int = 256,
) -> Sweep:
    """Call a task once for each seed, and keep what each call returned or why it failed.

    The records come in the order of the seeds and do not depend on the executor, as long as a task depends on its seed
    alone: draw random numbers from ``numpy.random.default_rng(seed)``.

    Parameters
    ----------
    task : callable
        Takes a seed. For processes and clusters it has to be a function of a module; ``functools.partial`` gives it
        more arguments.
    seeds : iterable of int or str
        Numbers or names, each once.
    executor : optional
        A pool of threads or processes of :mod:`concurrent.futures`, ``client.get_executor()`` of Dask, or anything
        whose ``submit`` returns a :class:`concurrent.futures.Future`; without one the tasks run here, one by one.
    resume : path, optional
        A file that every finished task is written to. Where it exists, results in it are taken over and failed tasks
        are run again. Results are then plain data: arrays become lists, keys of mappings texts.
    progress : callable, optional
        Told (number of tasks that ended, number of tasks) after each.
    window : int
        Tasks that are handed to the executor at a time.

    Returns
    -------
    Sweep
        An exception in a task, a worker that died and a result that cannot be kept are records with their seed.

    Raises
    ------
    ArgumentError
        A seed is twice there or neither int nor str, the task cannot be sent to processes, the executor returns no
        futures, or the file belongs to another task or is damaged in its middle.
    """
    every = _checked(seeds)
    _require(task, executor, progress, window)
    journal = Journal(resume, task_name(task)) if resume is not None else None
    found = _taken_over(journal, every)
    resumed = len(found)
    todo = [seed for seed in every if seed not in found]
    for record in _records(task, todo, executor, window, journal is not None):
        found[record.seed] = record
        if journal is not None:
            journal.add(record)
        if progress is not None:
            progress(len(found), len(every))
    return Sweep(tuple(found[seed] for seed in every), resumed)


def _checked(seeds: Iterable[Seed]) -> list[Seed]:
    """The seeds, numbers of numpy made plain ones."""
    if not isinstance(seeds, Iterable):
        raise ArgumentError(f"the seeds of a sweep are several, as range(10), not {seeds!r}")
    given: Iterable[Any] = seeds
    every = [seed.item() if getattr(seed, "shape", None) == () else seed for seed in given]
    wrong = next((seed for seed in every if not isinstance(seed, int | str) or isinstance(seed, bool)), None)
    if wrong is not None:
        raise ArgumentError(f"a seed is an int or a str, not {wrong!r}")
    if len(set(every)) < len(every):
        twice = Counter(every).most_common(1)[0][0]
        raise ArgumentError(f"seed {twice!r} is there twice; each seed stands for one task")
    return every


def _require(task: Task, executor: SubmitsTasks | None, progress: Progress | None, window: int) -> None:
    if not callable(task):
        raise ArgumentError(f"the task of a sweep is called with a seed, and {task!r} cannot be called")
    if progress is not None and not callable(progress):
        raise ArgumentError(f"progress is called with two numbers, and {progress!r} cannot be called")
    if not isinstance(window, Integral) or window < 1:
        raise ArgumentError(
            f"the window of a sweep is the number of tasks handed out at a time, at least 1, not {window!r}"
        )
    if executor is not None and not hasattr(executor, "submit"):
        raise ArgumentError(f"an executor has a method submit, and {type(executor).__name__} has none")
    if isinstance(executor, ProcessPoolExecutor):
        _require_sendable(task)


def _require_sendable(task: Task) -> None:
    try:
        pickle.dumps(task)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        raise ArgumentError(
            f"the task cannot be sent to processes: {error}; define it at the top of a module, or use a pool of threads"
        ) from None


def _taken_over(journal: Journal | None, seeds: list[Seed]) -> dict[Seed, SweepRecord]:
    """Results in the file; failed tasks are run again."""
    if journal is None:
        return {}
    return {seed: journal.records[seed] for seed in seeds if seed in journal.records and journal.records[seed].ok}


def _records(
    task: Task, seeds: list[Seed], executor: SubmitsTasks | None, window: int, is_kept: bool
) -> Iterator[SweepRecord]:
    """Records as the tasks end."""
    if executor is None:
        yield from (attempt(task, seed, is_kept) for seed in seeds)
        return
    waiting = deque(seeds)
    running: dict[Future[Any], Seed] = {}
    try:
        while waiting or running:
            chunk = [waiting.popleft() for _ in range(min(len(waiting), window - len(running)))]
            yield from _hand_out(task, chunk, executor, running, is_kept)
            done, _ = wait(running, return_when=FIRST_COMPLETED) if running else (set(), None)
            yield from (_outcome(future, running.pop(future)) for future in done)
    finally:
        _withdraw(running)


def _hand_out(
    task: Task, seeds: Iterable[Seed], executor: SubmitsTasks, running: dict[Future[Any], Seed], is_kept: bool
) -> Iterator[SweepRecord]:
    """Give tasks to the executor; what it does not take is a record at once."""
    for seed in seeds:
        try:
            future = executor.submit(attempt, task, seed, is_kept)
        except Exception as error:
            yield failed(seed, error)
            continue
        running[_waitable(future, executor)] = seed


def _waitable(future: Any, executor: SubmitsTasks) -> Future[Any]:
    """Futures of other kinds, as those of a Dask client itself, cannot be waited for here."""
    if not isinstance(future, Future):
        raise ArgumentError(
            f"submit of {type(executor).__name__} returned a {type(future).__name__}, not a concurrent.futures.Future; "
            "a client of Dask has client.get_executor()"
        )
    return future


def _outcome(future: Future[Any], seed: Seed) -> SweepRecord:
    """The record that a worker sent, or why there is none."""
    try:
        record: SweepRecord = future.result()
    except Exception as error:
        return failed(seed, error)
    return record


def _withdraw(running: dict[Future[Any], Seed]) -> None:
    """Ask for nothing more when a sweep is broken off."""
    for future in running:
        with suppress(Exception):
            future.cancel()
