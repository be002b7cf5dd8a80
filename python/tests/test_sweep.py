"""Many tasks on processes and threads."""

import os
import pickle
import signal
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace

import costate
import numpy as np
import pytest
from conftest import pendulum
from costate import _workers
from costate._chunks import Chunks


def square(x):
    return x * x


def picky(x):
    if x % 5 == 3:
        raise ValueError(f"not {x}")
    return {"square": x * x, "pair": np.array([x, -x]), "name": "odd" if x % 2 else None}


def least_effort(q):
    """J of a pendulum that is led to q."""
    cost = costate.Problem(pendulum(), start=[0.0], end=[q], time=1.0, cost=[1.0]).solve(threads=1).check().cost
    return {"q": q, "cost": cost}


def killed_once(task):
    """Kills its own process the first time."""
    number, mark = task
    if number == 7 and not os.path.exists(mark):
        Path(mark).touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def killed_always(number):
    if number == 5:
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def third_time(path):
    """Fails twice."""
    with open(path, "a") as file:
        file.write("x")
    if os.path.getsize(path) < 3:
        raise OSError("not yet")
    return "done"


def lambda_of(x):
    return lambda: x


class NoPickle(Exception):
    def __init__(self, a, b):
        super().__init__(a)


def hard_to_send(x):
    raise NoPickle(x, x)


def test_results_come_in_order_from_a_pool():
    outcomes = costate.sweep(square, range(50), workers=2, chunk=3)
    assert [outcome.value for outcome in outcomes] == [x * x for x in range(50)]
    assert [outcome.index for outcome in outcomes] == list(range(50))
    assert all(outcome.ok and outcome.attempts == 1 and outcome.seconds >= 0 for outcome in outcomes)
    assert costate.sweep(square, []) == []


def test_failed_tasks_have_their_error():
    seen = []
    outcomes = costate.sweep(picky, range(10), workers=2, progress=seen.append)
    assert [outcome.index for outcome in outcomes if not outcome.ok] == [3, 8]
    assert isinstance(outcomes[3].error, ValueError) and str(outcomes[3].error) == "not 3"
    assert "in picky" in outcomes[3].traceback and outcomes[3].task == 3
    assert sorted(outcome.index for outcome in seen) == list(range(10))


def test_tasks_are_tried_again(tmp_path):
    (outcome,) = costate.sweep(third_time, [str(tmp_path / "count")], workers=1, retries=2)
    assert (outcome.value, outcome.attempts) == ("done", 3)
    (outcome,) = costate.sweep(third_time, [str(tmp_path / "other")], workers=1, retries=1)
    assert isinstance(outcome.error, OSError) and outcome.attempts == 2


def test_chunks_take_as_long_as_tasks_allow():
    """One task at first; then half a second by the times of tasks, if that leaves work for all."""
    chunks = Chunks(range(1000))
    assert chunks.next(2) == [0]
    chunks.measured([0.1, float("nan")])
    assert chunks.next(2) == [1, 2, 3, 4, 5] and len(chunks.next(50)) == 4
    chunks.measured([0.9])  # The mean is half a second now.
    assert len(chunks.next(2)) == 1
    chunks.again([8, 9])
    chunks.again([1, 5], single=True)
    assert [chunks.next(2) for _ in range(3)] == [[1], [5], [8]]
    for _ in range(20):
        chunks.measured([1e-6] * 5)
    assert len(chunks.next(2)) == 100 and len(chunks.next(0)) == (len(chunks) + 3) // 256 == 3
    assert len(Chunks(range(9), 4).next(64)) == 4
    assert chunks.all() == list(range(113, 1000)) and not chunks


def test_chunks_grow_where_tasks_are_quick():
    sizes = []

    class Watched(ThreadPoolExecutor):
        def submit(self, call, function, tasks, *rest):
            sizes.append(len(tasks))
            return super().submit(call, function, tasks, *rest)

    with Watched(2) as threads:
        costate.sweep(square, range(200), threads)
    assert sizes[0] == 1 and max(sizes) > 1 and sum(sizes) == 200


def test_windows_has_at_most_61_processes(monkeypatch):
    assert _workers.processes(100) == 100 and _workers.processes(None) >= 1
    monkeypatch.setattr("costate._workers.os", SimpleNamespace(name="nt", cpu_count=lambda: 96))
    assert _workers.processes(100) == _workers.processes(None) == 61 and _workers.processes(3) == 3


def test_what_cannot_be_sent_is_said():
    with pytest.raises(costate.ArgumentError, match="top of a module") as raised:
        costate.sweep(lambda x: x, [1], workers=1)
    assert raised.value.argument == "function"
    outcomes = costate.sweep(square, [1, lambda: 2, 3], workers=1)
    assert [outcome.value for outcome in outcomes] == [1, None, 9] and "cannot be pickled" in str(outcomes[1].error)
    (outcome,) = costate.sweep(lambda_of, [1], workers=1)
    assert "result cannot be pickled" in str(outcome.error)
    (outcome,) = costate.sweep(hard_to_send, [1], workers=1)
    assert "NoPickle" in str(outcome.error)


@pytest.mark.parametrize(
    ("name", "given", "words"),
    [
        ("chunk", 0, "chunk is 0"),
        ("chunk", 2.5, "whole number"),
        ("workers", "2", "workers is '2'"),
        ("workers", -1, "workers is -1"),
        ("retries", None, "retries is None"),
        ("progress", "x", "None, True, or a function"),
        ("parquet", 3, "give the path of a file"),
        ("executor", 3, "workers="),
        ("executor", ThreadPoolExecutor, "workers="),
        ("tasks", 7, "cannot be iterated"),
        ("function", None, "cannot be called"),
    ],
)
def test_arguments_that_do_not_fit_are_named(name, given, words):
    with pytest.raises(costate.ArgumentError, match=words) as raised:
        costate.sweep(**{"function": square, "tasks": [1], name: given})
    assert raised.value.argument == name


def test_other_executors_take_anything():
    with ThreadPoolExecutor(2) as threads:
        outcomes = costate.sweep(lambda x: -x, range(9), threads, chunk=2)
    assert [outcome.value for outcome in outcomes] == [-x for x in range(9)]


def test_motions_are_those_of_one_process():
    tasks = [0.2, 0.4, 0.6]
    for outcome, q in zip(costate.sweep(least_effort, tasks, workers=2, chunk=1), tasks):
        assert outcome.value == least_effort(q)


def test_outcomes_are_pickled():
    (outcome,) = costate.sweep(square, [3], workers=1)
    assert pickle.loads(pickle.dumps(outcome)) == outcome
