"""How tasks, processes and sweeps end: nothing is lost."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections import Counter
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures import process as futures_process
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import connection
from pathlib import Path
from threading import Timer

import costate
import pytest
from costate import _drive, _runners, _workers
from costate._chunks import Chunks
from test_sweep import killed_always, killed_once, square


class Fragile:
    """A pool that task 20 ends after a while, with all that runs beside it; other tasks are quicker."""

    ends_together, window, workers = True, 4, 2

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

    def watch(self, left, came): ...


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
    with _workers.guarded(ProcessPoolExecutor(1)) as pool:
        outcomes = costate.sweep(killed_always, range(20), pool, chunk=4)
    assert [outcome.value for outcome in outcomes[:4]] == [0, 1, 2, 3]
    assert not any(outcome.ok for outcome in outcomes[4:])


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no signal that kills")
def test_a_call_that_is_submitted_while_its_pool_breaks_fails(monkeypatch):
    """The thread that ends a broken pool waits for the submission; so every call has an end."""
    pool = _workers.new_pool(1)
    worker = pool.submit(os.getpid).result()
    waiting = pool.submit(time.sleep, 60)
    make = futures_process._base.Future

    def late():
        os.kill(worker, signal.SIGKILL)
        end = time.monotonic() + 10
        while not pool._broken and pool._executor_manager_thread.is_alive() and time.monotonic() < end:
            # From Python 3.12 on the pool is not broken before the submission has ended.
            if hasattr(futures_process._ExecutorManagerThread, "_terminate_broken") and time.monotonic() > end - 9.5:
                break
            time.sleep(0.01)
        time.sleep(0.2)
        return make()

    monkeypatch.setattr(futures_process._base, "Future", late)
    submitted = pool.submit(os.getpid)
    monkeypatch.undo()
    for future in (waiting, submitted):
        assert isinstance(future.exception(timeout=10), BrokenProcessPool)
    pool._executor_manager_thread.join(10)
    assert _workers.end(pool)


def test_only_a_suspect_that_runs_alone_is_counted():
    """Nothing starts beside a suspect, though it is the last one, and only its own deaths are counted."""
    runner, found = Fragile(), {}
    _drive.drive(runner, list(range(60)), Chunks(range(60), 1), lambda of: found.update({of.index: of}))
    assert [found[k].value for k in range(60)] == [k if k != 20 else None for k in range(60)]
    assert isinstance(found[20].error, costate.WorkerDied) and found[20].attempts == 3 and runner.calls.pop(20) == 4
    assert max(runner.calls.values()) <= 2
    assert runner.beside == [[20]] * 3


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


def leaves(x):
    sys.exit(x)


def test_a_task_that_leaves_python_fails_alone():
    with ThreadPoolExecutor(1) as threads:
        for executor in (None, threads):
            (outcome,) = costate.sweep(leaves, [3], executor, workers=None if executor else 1)
            assert not outcome.ok and str(outcome.error) == "SystemExit: 3" and "in leaves" in outcome.traceback


def test_a_script_without_its_guard_is_told(tmp_path):
    script = tmp_path / "script.py"
    script.write_text("import costate, math\nprint([of.value for of in costate.sweep(math.sqrt, [4.0], workers=1)])\n")
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=120)
    assert "__main__" in done.stderr.splitlines()[-1] and done.returncode == 1


def leaves_a_thread(x):
    threading.Thread(target=time.sleep, args=(1000,)).start()
    return x


def leaves_a_thread_and_will_not_end(x):
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    return leaves_a_thread(x)


@pytest.mark.parametrize("function", [leaves_a_thread, leaves_a_thread_and_will_not_end])
def test_processes_that_do_not_end_are_ended(monkeypatch, function):
    monkeypatch.setattr(_workers, "_GRACE", 0.5)
    with pytest.warns(RuntimeWarning, match="a task has left a thread"):
        outcomes = costate.sweep(function, range(2), workers=1)
    assert [outcome.value for outcome in outcomes] == [0, 1]


def interrupts(x):
    if x == 2:
        raise KeyboardInterrupt
    if x == 4:
        raise costate.Interrupted([], "by itself")
    return x


def test_an_interrupt_of_a_task_is_its_error():
    with ThreadPoolExecutor(2) as threads:
        for executor in (None, threads):
            workers = None if executor else 1
            outcomes = costate.sweep(interrupts, range(8), executor, workers=workers, chunk=8, retries=2)
            assert [outcome.value for outcome in outcomes] == [0, 1, None, 3, None, 5, 6, 7]
            assert outcomes[2].attempts == 1 and "KeyboardInterrupt" in str(outcomes[2].error)
            assert str(outcomes[4].error) == "Interrupted: by itself" and "in interrupts" in outcomes[4].traceback


class Inline(Executor):
    """Calls in the thread that sweeps, where a signal would come."""

    def submit(self, call, /, *arguments):
        future = Future()
        try:
            future.set_result(call(*arguments))
        except BaseException as error:
            future.set_exception(error)
        return future


def test_an_interrupt_of_the_process_that_sweeps_ends_the_sweep():
    with pytest.raises(costate.Interrupted, match="of 8 tasks have an outcome") as raised:
        costate.sweep(interrupts, range(8), Inline(), chunk=1)
    assert [outcome.value for outcome in raised.value.reached] == [0, 1]
    assert raised.value.solution is None


def test_outcomes_are_reached_where_a_sweep_is_interrupted():
    def stop(outcome):
        if outcome.index == 5:
            raise KeyboardInterrupt

    with ThreadPoolExecutor(1) as threads, pytest.raises(costate.Interrupted) as raised:
        costate.sweep(square, range(100), threads, chunk=1, progress=stop)
    reached = raised.value.reached
    assert [outcome.value for outcome in reached[:6]] == [0, 1, 4, 9, 16, 25] and len(reached) < 100


def test_a_progress_function_that_raises_loses_nothing():
    seen = []

    def wrong(outcome):
        seen.append(outcome.index)
        raise TypeError("of the function")

    with ThreadPoolExecutor(1) as threads, pytest.warns(RuntimeWarning, match="TypeError: of the function") as warned:
        outcomes = costate.sweep(square, range(5), threads, progress=wrong)
    assert [outcome.value for outcome in outcomes] == [0, 1, 4, 9, 16] and sorted(seen) == [0, 1, 2, 3, 4]
    assert len([of for of in warned if "progress" in str(of.message)]) == 1


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no signal that kills")
def test_what_a_pool_has_computed_is_kept_where_no_other_one_starts(monkeypatch):
    new_pool, pools = _workers.new_pool, []

    def once(workers):
        if pools:
            raise OSError("no memory")
        pools.append(new_pool(workers))
        return pools[-1]

    monkeypatch.setattr(_workers, "new_pool", once)
    monkeypatch.setattr(_runners, "_PAUSE", 0.0)
    outcomes = costate.sweep(killed_always, range(30), workers=1, chunk=1)
    assert [outcome.value for outcome in outcomes[:4]] == [0, 1, 2, 3] and not any(of.ok for of in outcomes[5:])
    assert isinstance(outcomes[29].error, costate.WorkerDied) and "no memory" in str(outcomes[29].error)
    with pytest.raises(costate.WorkerDied, match="no memory"):
        costate.sweep(square, range(3), workers=1)


def test_tasks_that_an_executor_does_not_take_fail_alone():
    class Refuses(ThreadPoolExecutor):
        def submit(self, call, function, tasks, *rest):
            if 5 in tasks:
                raise TypeError("it cannot be sent")
            return super().submit(call, function, tasks, *rest)

    with Refuses(1) as threads:
        outcomes = costate.sweep(square, range(12), threads, chunk=4)
    assert [outcome.value for outcome in outcomes] == [k * k if k != 5 else None for k in range(12)]
    assert str(outcomes[5].error) == "it cannot be sent"

    def shuts(x):
        if x == 3:
            threads.shutdown(wait=False)
        return x

    threads = ThreadPoolExecutor(1)
    outcomes = costate.sweep(shuts, range(40), threads, chunk=1)
    assert [outcome.value for outcome in outcomes[:4]] == [0, 1, 2, 3]
    assert isinstance(outcomes[39].error, RuntimeError) and "shutdown" in str(outcomes[39].error)


def test_a_worker_sends_what_it_has_after_a_second():
    calls, first = [], []

    def slow(x):
        calls.append(x)
        time.sleep(0.25)
        return x

    assert 1 <= len(_workers.many(slow, range(16), 0)) < 16
    calls.clear()
    with ThreadPoolExecutor(1) as threads:
        outcomes = costate.sweep(
            slow, range(12), threads, chunk=12, progress=lambda outcome: first.append(len(calls))
        )
    assert [outcome.value for outcome in outcomes] == calls == list(range(12)) and first[0] < 12


def dies_while_it_sends(task):
    """Its result is more than a pipe holds."""
    number, mark = task
    if number == 1 and not os.path.exists(mark):
        Path(mark).touch()
        threading.Timer(0.5, os.kill, [os.getpid(), signal.SIGKILL]).start()
        return bytes(2**23)
    return number


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no signal that kills")
def test_a_worker_that_dies_while_it_sends_is_missed(monkeypatch, tmp_path):
    receive = connection.Connection._recv

    def late(self, size, *rest):
        if size > 2**20:
            time.sleep(2.0)  # The sender has ended in the middle then.
        return receive(self, size, *rest)

    monkeypatch.setattr(connection.Connection, "_recv", late)
    mark = str(tmp_path / "mark")
    outcomes = costate.sweep(dies_while_it_sends, [(k, mark) for k in range(6)], workers=2, chunk=1)
    assert [outcome.value for outcome in outcomes] == list(range(6))
