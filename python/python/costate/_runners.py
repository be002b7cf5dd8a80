"""Where the calls of a sweep run: an executor of the caller, or processes of our own."""

from __future__ import annotations

import logging
import pickle
import time
import warnings
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Future, ProcessPoolExecutor
from typing import Any
from uuid import uuid4

from . import _workers
from ._errors import argument_error
from ._outcomes import WorkerDied, said

logger = logging.getLogger("costate")

# Chunks that each worker has at once, and those of an executor that does not say how many workers it has.
_EACH, _WINDOW = 4, 1024
# Seconds between two looks at a cluster, and without results before something is said.
_LOOK = 5.0
# After how many looks without a result a pool ends with one of its processes at the latest.
_SILENT = 3
# How often a pool is made again that ends before its first task, and after how many seconds.
_STARTS, _PAUSE = 3, 1.0


class Given:
    """An executor of the caller."""

    ends_together = False  # Whether all that runs ends with one worker.

    def __init__(self, function: Callable[[Any], Any], executor: Any, retries: int) -> None:
        self.executor, self.function, self.retries = _executor(executor), function, retries
        size = getattr(self.executor, "_max_workers", 0)  # Of the executors of Python.
        self.workers = size if isinstance(size, int) else 0
        self.running: set[Future[Any]] = set()
        client = getattr(self.executor, "_client", None)
        self.client = client if callable(getattr(client, "nthreads", None)) else None  # Of Dask.
        self.empty = False  # Whether it was said that there are no workers.
        self.heard = self.looked = time.monotonic()
        self._look()

    @property
    def window(self) -> int:
        """How many chunks it holds at once."""
        if self.client is None and not self.workers:
            return _WINDOW
        return max(_EACH * self.workers, 2 * _EACH)

    def _look(self) -> int | None:
        """How many workers a cluster has; None for other executors, and where it does not answer."""
        if self.client is None:
            return None
        try:
            self.workers = sum(self.client.nthreads().values())
        except Exception:
            return None
        return self.workers

    def watch(self, left: int, came: bool) -> str | None:
        """What to say about the workers of a cluster, with so many tasks left and whether results came."""
        now = time.monotonic()
        if came:
            self.heard, self.empty = now, False
        if self.client is None or now - self.looked < _LOOK:
            return None
        workers = self._look()
        self.looked = time.monotonic()
        if workers and self.empty:
            self.empty = False
            logger.info("sweep: %s has workers again", self._name())
        elif workers == 0 and not self.empty and now - self.heard >= _LOOK:
            self.empty = True
            return (
                f"{self._name()} has no workers, and the tasks that wait are {left}. The sweep goes on when workers come, "
                "for instance by cluster.scale(n); Ctrl-C ends it"
            )
        return None

    def _name(self) -> str:
        address = getattr(getattr(self.client, "scheduler", None), "address", "its cluster")
        return f"{type(self.executor).__name__} of {address}"

    def submit(self, tasks: list[Any]) -> Future[Any]:
        with _workers.submitting():
            future: Future[Any] = self.executor.submit(_workers.many, self.function, tasks, self.retries, uuid4().hex)
        if future.done() and not future.cancelled() and isinstance(future.exception(), KeyboardInterrupt):
            raise KeyboardInterrupt  # It computes at once, in this thread, where signals come.
        self.running.add(future)
        future.add_done_callback(self.running.discard)
        return future

    def results(self, future: Future[Any]) -> list[_workers.Result]:
        results: list[_workers.Result] = future.result()
        return results

    def broken(self) -> None:
        """Nothing to do: the next submission says whether the executor still works."""

    def stop(self) -> None:
        for future in list(self.running):
            future.cancel()

    def close(self) -> None:
        """The executor belongs to the caller."""


class Pool:
    """Processes of our own, made again when one of them dies."""

    ends_together = True

    def __init__(self, function: Callable[[Any], Any], workers: int, retries: int) -> None:
        try:
            self.function = pickle.dumps(function)
        except Exception as error:
            raise _no_function(function, said(error)) from None
        self.given = function
        self.workers, self.retries, self.window = workers, retries, 2 * workers
        self.executor: ProcessPoolExecutor | None = None
        self.silent = 0  # Looks in a row that found a process which has ended, and no result.
        self.worked, self.failed = False, 0  # Pools in a row that ended before their first task.

    def submit(self, tasks: list[Any]) -> Future[Any]:
        if self.executor is None:
            self.executor = self._new()
        return self.executor.submit(_workers.many_pickled, self.function, _pickled(tasks), self.retries)

    def _new(self) -> ProcessPoolExecutor:
        """A pool whose processes can read the function."""
        try:
            self.executor = _workers.new_pool(self.workers)
            fault = self.executor.submit(_workers.readable, self.function).result()
        except (BrokenExecutor, OSError) as error:
            self.broken()
            self.failed += 1
            if self.worked and self.failed < _STARTS:
                time.sleep(_PAUSE)
                raise BrokenExecutor("a new pool has ended") from None
            raise WorkerDied(
                f"no process can be started ({error})"
                if isinstance(error, OSError)
                else "a new process ended before its first task; a script that calls sweep needs the line "
                'if __name__ == "__main__": before what it does'
            ) from None
        if fault is not None:
            raise _no_function(self.given, fault)
        self.failed, self.worked = 0, True
        return self.executor

    def watch(self, left: int, came: bool) -> str | None:
        """End a pool that does not see that a process has ended: it waits for the rest of a result."""
        self.silent = self.silent + 1 if not came and self.executor is not None and _workers.lost(self.executor) else 0
        if self.silent >= _SILENT:
            self.silent = 0
            self.broken()
            raise BrokenExecutor("a process has ended while it sent a result")
        return None

    def results(self, future: Future[Any]) -> list[_workers.Result]:
        return [_workers.unpickled(result) for result in future.result()]

    def broken(self) -> None:
        if self.executor is not None:
            _workers.end(self.executor, at_once=True)
        self.executor = None

    def stop(self) -> None:
        """Tasks are not waited for."""
        self.broken()

    def close(self) -> None:
        if self.executor is not None and not _workers.end(self.executor):
            text = "processes of the sweep did not end by themselves: a task has left a thread or a process there"
            warnings.warn(f"{text}; they were ended", RuntimeWarning, stacklevel=3)
        self.executor = None


def _pickled(tasks: list[Any]) -> list[bytes | Exception]:
    texts: list[bytes | Exception] = []
    for task in tasks:
        try:
            texts.append(pickle.dumps(task))
        except Exception as error:
            texts.append(TypeError(f"the task cannot be pickled: {said(error)}"))
    return texts


def _executor(given: Any) -> Any:
    """An executor, also where a client of Dask was given."""
    if callable(getattr(given, "get_executor", None)) and not isinstance(given, type):
        given = given.get_executor()
    if isinstance(given, type) or not callable(getattr(given, "submit", None)):
        raise argument_error(
            "executor",
            f"executor {given!r} has no method submit; give an executor of concurrent.futures, a client of Dask or its "
            "client.get_executor(), or workers= for processes of this machine",
        )
    if getattr(getattr(given, "_client", None), "asynchronous", False) is True:
        raise argument_error(
            "executor", "the client of Dask is asynchronous: sweep would wait for its event loop for ever; give another one"
        )
    return given


def _no_function(function: object, reason: str) -> Exception:
    name = getattr(function, "__qualname__", repr(function))
    return argument_error(
        "function",
        f"function {name} cannot be sent to other processes ({reason}); define it at the top of a module that they can "
        "import, without lambda, or give an executor that takes it, such as client.get_executor() of Dask",
    )
