"""Many tasks on processes, threads and Dask: nothing is lost."""

import os
import pickle
import signal
import subprocess
import sys
import time
from collections import Counter
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from threading import Timer
from types import SimpleNamespace

import costate
import numpy as np
import pytest
from conftest import pendulum
from costate import _sweep, _workers


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


def counted(task):
    """Notes that it is called."""
    number, file = task
    with open(file, "a") as calls:
        calls.write(f"{number}\n")
    return number


class Fragile:
    """A pool that task 20 ends after a while, with all that runs beside it; other tasks are quicker."""

    ends_together, window = True, 4

    def __init__(self):
        self.running, self.calls, self.beside = {}, Counter(), []

    def submit(self, tasks):
        future, (task,) = Future(), tasks
        self.running[future] = task
        self.calls[task] += 1
        if self.calls[20] > 1 and 20 in self.running.values():
            self.beside.append(sorted(self.running.values()))
        Timer(0.05 if task == 20 else 0.01, self.end, [future, task]).start()
        return future

    def end(self, future, task):
        if task == 20:
            for other in list(self.running):
                self.running.pop(other)
                other.set_exception(BrokenProcessPool("killed"))
        elif self.running.pop(future, None) is not None:
            future.set_result([(task, None, "", 0.0, 1)])

    def results(self, future):
        return future.result()

    def broken(self): ...


class KilledWorker(Exception):
    """Has the name of Dask's error."""


class Cluster(Executor):
    """One worker that is sent two calls at once; both fail with it when one has task 5."""

    def __init__(self):
        self.sent, self.calls = [], Counter()

    def submit(self, call, /, *arguments):
        future = Future()
        self.sent.append((future, call, arguments))
        Timer(0.02, self.run).start()
        return future

    def run(self):
        pair, self.sent = self.sent[:2], self.sent[2:]
        dies = any(5 in tasks for _, _, (_, tasks, *_) in pair)
        for future, call, arguments in pair:
            self.calls.update(arguments[1])
            if dies:
                future.set_exception(KilledWorker("one of them"))
            else:
                future.set_result(call(*arguments))


def leaves(x):
    sys.exit(x)


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


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no signal that kills")
def test_nothing_is_lost_when_a_worker_is_killed(tmp_path):
    mark = tmp_path / "killed"
    outcomes = costate.sweep(killed_once, [(k, str(mark)) for k in range(40)], workers=2, chunk=4)
    assert mark.exists() and [outcome.value for outcome in outcomes] == list(range(40))


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no signal that kills")
def test_a_task_that_kills_its_worker_is_the_only_one_that_fails():
    outcomes = costate.sweep(killed_always, range(20), workers=2, chunk=4)
    assert [outcome.value for outcome in outcomes] == [k if k != 5 else None for k in range(20)]
    assert isinstance(outcomes[5].error, costate.WorkerDied) and outcomes[5].attempts == 3
    # A pool of the caller is not made again: what it has not computed says so.
    with ProcessPoolExecutor(1) as pool:
        outcomes = costate.sweep(killed_always, range(20), pool, chunk=4)
    assert [outcome.value for outcome in outcomes[:4]] == [0, 1, 2, 3]
    assert not any(outcome.ok for outcome in outcomes[4:])


def test_only_a_suspect_that_runs_alone_is_counted():
    """Nothing starts beside a suspect, though it is the last one, and only its own deaths are counted."""
    runner, found = Fragile(), {}
    _sweep._drive(runner, list(range(60)), [[k] for k in range(60)], lambda of: found.update({of.index: of}))
    assert [found[k].value for k in range(60)] == [k if k != 20 else None for k in range(60)]
    assert isinstance(found[20].error, costate.WorkerDied) and found[20].attempts == 3 and runner.calls.pop(20) == 4
    assert max(runner.calls.values()) <= 2
    assert runner.beside == [[20]] * 3


def test_a_task_that_leaves_python_fails_alone():
    with ThreadPoolExecutor(1) as threads:
        for executor in (None, threads):
            (outcome,) = costate.sweep(leaves, [3], executor, workers=1)
            assert not outcome.ok and str(outcome.error) == "SystemExit: 3" and "in leaves" in outcome.traceback


def test_chunks_leave_work_for_all():
    """Chunks that are not given are small where there are few tasks."""
    sizes = []

    class Watched(ThreadPoolExecutor):
        def submit(self, call, function, tasks, *rest):
            sizes.append(len(tasks))
            return super().submit(call, function, tasks, *rest)

    for count, expected in [(6, [1] * 6), (32, [4] * 8), (200, [8] * 25)]:
        sizes.clear()
        with Watched(2) as threads:
            costate.sweep(square, range(count), threads)
        assert sizes == expected


def test_windows_has_at_most_61_processes(monkeypatch):
    assert _workers.processes(100) == 100 and _workers.processes(None) >= 1
    monkeypatch.setattr("costate._workers.os", SimpleNamespace(name="nt", cpu_count=lambda: 96))
    assert _workers.processes(100) == _workers.processes(None) == 61 and _workers.processes(3) == 3


ORPHANS = """
import os, sys, time, costate
def noted(x):
    open(f"{sys.argv[1]}/{os.getpid()}", "w").close()
    time.sleep(0.1)
if __name__ == "__main__":
    costate.sweep(noted, range(2000), workers=2, chunk=1)
"""


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no signal that kills")
def test_workers_end_with_a_process_that_is_killed(tmp_path):
    script, folder = tmp_path / "orphans.py", tmp_path / "pids"
    folder.mkdir()
    script.write_text(ORPHANS)
    process = subprocess.Popen([sys.executable, script, folder], stderr=subprocess.DEVNULL)
    end = time.monotonic() + 60
    while len(os.listdir(folder)) < 2 and time.monotonic() < end:
        time.sleep(0.05)
    workers = [int(name) for name in os.listdir(folder)]
    assert len(workers) == 2
    process.kill()
    process.wait(30)
    end = time.monotonic() + 10
    while (left := [pid for pid in workers if alive(pid)]) and time.monotonic() < end:
        time.sleep(0.05)
    for pid in left:
        os.kill(pid, signal.SIGKILL)
    assert not left


def alive(pid):
    """Whether a process runs; one that has ended waits for whoever adopted it."""
    done = subprocess.run(["ps", "-o", "stat=", "-p", str(pid)], capture_output=True, text=True).stdout.strip()
    return bool(done) and not done.startswith("Z")


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
    with pytest.raises(costate.ArgumentError, match="chunk is 0"):
        costate.sweep(square, [1], chunk=0)


def test_a_script_without_its_guard_is_told(tmp_path):
    script = tmp_path / "script.py"
    script.write_text("import costate, math\nprint([of.value for of in costate.sweep(math.sqrt, [4.0], workers=1)])\n")
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=120)
    assert "__main__" in done.stderr.splitlines()[-1] and done.returncode == 1


def test_other_executors_take_anything():
    with ThreadPoolExecutor(2) as threads:
        outcomes = costate.sweep(lambda x: -x, range(9), threads, chunk=2)
    assert [outcome.value for outcome in outcomes] == [-x for x in range(9)]


def test_motions_are_those_of_one_process():
    tasks = [0.2, 0.4, 0.6]
    for outcome, q in zip(costate.sweep(least_effort, tasks, workers=2, chunk=1), tasks):
        assert outcome.value == least_effort(q)


def test_tasks_beside_one_that_kills_its_workers_are_not_to_blame():
    cluster = Cluster()
    outcomes = costate.sweep(square, range(12), cluster, chunk=1)
    assert [outcome.value for outcome in outcomes] == [k * k if k != 5 else None for k in range(12)]
    assert isinstance(outcomes[5].error, costate.WorkerDied) and cluster.calls[5] == 4


@pytest.fixture(scope="module")
def client():
    """One cluster for all tests; what a worker ran when it died is not tried again by Dask itself."""
    distributed = pytest.importorskip("distributed")
    import dask

    with dask.config.set({"distributed.scheduler.allowed-failures": 0}):
        with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
            with distributed.Client(cluster) as client:
                yield client


def test_dask_computes_the_same(client):
    tasks = [0.2, 0.4, 0.6, 0.8]
    there = costate.sweep(least_effort, tasks, client.get_executor(), chunk=2)
    failing = costate.sweep(picky, range(10), client.get_executor(), chunk=3)
    assert [outcome.value for outcome in there] == [least_effort(q) for q in tasks]
    assert [outcome.index for outcome in failing if not outcome.ok] == [3, 8] and str(failing[8].error) == "not 8"


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no signal that kills")
def test_nothing_is_lost_when_a_worker_of_dask_is_killed(client, tmp_path):
    mark = tmp_path / "killed"
    # Dask makes new workers; the tasks that were running are sent again, one by one.
    outcomes = costate.sweep(killed_once, [(k, str(mark)) for k in range(40)], client.get_executor(), chunk=4)
    assert mark.exists() and [outcome.value for outcome in outcomes] == list(range(40))
    outcomes = costate.sweep(killed_always, range(12), client.get_executor(), chunk=4)
    assert [outcome.value for outcome in outcomes] == [k if k != 5 else None for k in range(12)]
    assert isinstance(outcomes[5].error, costate.WorkerDied)


def test_dask_calls_equal_tasks_each_time(client, tmp_path):
    file = str(tmp_path / "calls")
    outcomes = costate.sweep(counted, [(1, file)] * 6, client.get_executor(), chunk=1)
    assert len(outcomes) == 6 and os.path.getsize(file) == 6 * len("1\n")


def test_outcomes_are_pickled():
    (outcome,) = costate.sweep(square, [3], workers=1)
    assert pickle.loads(pickle.dumps(outcome)) == outcome
