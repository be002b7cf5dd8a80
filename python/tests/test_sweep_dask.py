"""Sweeps on clusters: workers that die, workers that are not there."""

import logging
import os
import signal
import sys
import time
from collections import Counter
from concurrent.futures import Executor, Future
from threading import Timer

import costate
import pytest
from costate import _runners
from test_sweep import killed_always, killed_once, least_effort, picky, square


class KilledWorker(Exception):
    """Has the name of Dask's error, and how often Dask tries again by itself."""

    def __init__(self, allowed_failures):
        super().__init__("one of them")
        self.allowed_failures = allowed_failures


class Cluster(Executor):
    """One worker that is sent two calls at once; both fail with it when one has task 5."""

    def __init__(self, allowed_failures):
        self.sent, self.calls, self.allowed_failures = [], Counter(), allowed_failures

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
                future.set_exception(KilledWorker(self.allowed_failures))
            else:
                future.set_result(call(*arguments))


@pytest.mark.parametrize(("allowed", "calls", "workers"), [(0, 4, 3), (3, 2, 4)])
def test_tasks_beside_one_that_kills_its_workers_are_not_to_blame(allowed, calls, workers):
    cluster = Cluster(allowed)
    outcomes = costate.sweep(square, range(12), cluster, chunk=1)
    assert [outcome.value for outcome in outcomes] == [k * k if k != 5 else None for k in range(12)]
    assert isinstance(outcomes[5].error, costate.WorkerDied) and outcomes[5].attempts == workers
    # With other tasks, and then alone: workers that Dask has lost by trying again are counted.
    assert cluster.calls[5] == calls


class Empty(Executor):
    """A cluster of Dask that has workers once somebody has complained."""

    class Client:
        workers: dict[str, int] = {}

        def nthreads(self):
            return self.workers

    def __init__(self):
        self._client, self.sent = self.Client(), []

    def submit(self, call, /, *arguments):
        self.sent.append((Future(), call, arguments))
        self.run()
        return self.sent[-1][0]

    def run(self):
        for future, call, arguments in self.sent if self._client.workers else []:
            if not future.done():
                future.set_result(call(*arguments))

    def begin(self):
        self._client.workers = {"worker": 2}
        self.run()


class Handler(logging.Handler):
    """Does something once the log says something."""

    def __init__(self, words, act):
        super().__init__()
        self.words, self.act, self.texts = words, act, []

    def emit(self, record):
        self.texts.append(record.getMessage())
        if self.words in self.texts[-1]:
            self.act()


@pytest.fixture
def when_logged():
    logger, handlers = logging.getLogger("costate"), []

    def add(words, act):
        handlers.append(Handler(words, act))
        logger.addHandler(handlers[-1])
        return handlers[-1]

    yield add
    for handler in handlers:
        logger.removeHandler(handler)


def test_a_cluster_without_workers_is_told(monkeypatch, when_logged, capsys):
    monkeypatch.setattr(_runners, "_LOOK", 0.1)
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    cluster = Empty()
    handler = when_logged("no workers", cluster.begin)
    with pytest.warns(RuntimeWarning, match="^Empty of its cluster has no workers, and the tasks that wait are 20"):
        outcomes = costate.sweep(square, range(20), cluster, progress=True)
    assert [outcome.value for outcome in outcomes] == [k * k for k in range(20)]
    assert sum("no workers" in text for text in handler.texts) == 1
    assert "0 of 20, Empty of its cluster has no workers" in capsys.readouterr().err


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


def counted(task):
    """Notes that it is called."""
    number, file = task
    with open(file, "a") as calls:
        calls.write(f"{number}\n")
    return number


def test_dask_calls_equal_tasks_each_time(client, tmp_path):
    file = str(tmp_path / "calls")
    outcomes = costate.sweep(counted, [(1, file)] * 6, client.get_executor(), chunk=1)
    assert len(outcomes) == 6 and os.path.getsize(file) == 6 * len("1\n")


def test_a_client_is_as_good_as_its_executor(client):
    outcomes = costate.sweep(square, range(200), client)
    assert [outcome.value for outcome in outcomes] == [k * k for k in range(200)]


def test_a_sweep_goes_on_when_workers_come_back(client, monkeypatch, when_logged):
    monkeypatch.setattr(_runners, "_LOOK", 0.5)
    client.cluster.scale(0)
    end = time.monotonic() + 60
    while client.nthreads() and time.monotonic() < end:
        time.sleep(0.05)
    when_logged("no workers", lambda: client.cluster.scale(1))
    with pytest.warns(RuntimeWarning, match="ClientExecutor of tcp://.* has no workers, and the tasks that wait are 6"):
        outcomes = costate.sweep(square, range(6), client.get_executor())
    assert [outcome.value for outcome in outcomes] == [0, 1, 4, 9, 16, 25]


def test_an_asynchronous_client_is_refused():
    class Client:
        asynchronous = True

    class Asynchronous(Executor):
        _client = Client()

    with pytest.raises(costate.ArgumentError, match="asynchronous") as raised:
        costate.sweep(square, [1], Asynchronous())
    assert raised.value.argument == "executor"
