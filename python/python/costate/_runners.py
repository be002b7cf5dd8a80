"""Where the calls of a sweep run: an executor of the caller, or processes of our own."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Executor, Future
from typing import Any
from uuid import uuid4

from . import _workers
from ._errors import argument_error
from ._outcomes import WorkerDied

# Chunks that another executor holds at once.
_WINDOW = 1024


class Given:
    """An executor of the caller."""

    ends_together = False  # Whether all that runs ends with one worker.
    window = _WINDOW

    def __init__(self, function: Callable[[Any], Any], executor: Executor, retries: int) -> None:
        self.executor, self.function, self.retries = executor, function, retries
        size = getattr(executor, "_max_workers", 0)  # Of the executors of Python.
        self.workers = size if isinstance(size, int) else 0
        self.running: set[Future[Any]] = set()

    def submit(self, tasks: list[Any]) -> Future[Any]:
        future = self.executor.submit(_workers.many, self.function, tasks, self.retries, uuid4().hex)
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
            raise _no_function(function, str(error)) from None
        self.given = function
        self.workers, self.retries, self.window = workers, retries, 2 * workers
        self.executor: Executor | None = None

    def submit(self, tasks: list[Any]) -> Future[Any]:
        if self.executor is None:
            self.executor = _workers.new_pool(self.workers)
            try:
                fault = self.executor.submit(_workers.readable, self.function).result()
            except BrokenExecutor:
                raise WorkerDied(
                    "a new process ended before its first task; a script that calls sweep needs the line "
                    'if __name__ == "__main__": before what it does'
                ) from None
            if fault is not None:
                raise _no_function(self.given, fault)
        return self.executor.submit(_workers.many_pickled, self.function, _pickled(tasks), self.retries)

    def results(self, future: Future[Any]) -> list[_workers.Result]:
        return [_workers.unpickled(result) for result in future.result()]

    def broken(self) -> None:
        if self.executor is not None:
            self.executor.shutdown(wait=False)
        self.executor = None

    def stop(self) -> None:
        if self.executor is not None:
            # Their tasks are not waited for.
            for process in list((getattr(self.executor, "_processes", None) or {}).values()):
                process.terminate()
            self.executor.shutdown(wait=True, cancel_futures=True)

    def close(self) -> None:
        if self.executor is not None:
            self.executor.shutdown()


def _pickled(tasks: list[Any]) -> list[bytes | Exception]:
    texts: list[bytes | Exception] = []
    for task in tasks:
        try:
            texts.append(pickle.dumps(task))
        except Exception as error:
            texts.append(TypeError(f"the task cannot be pickled: {error}"))
    return texts


def _no_function(function: object, reason: str) -> Exception:
    name = getattr(function, "__qualname__", repr(function))
    return argument_error(
        "function",
        f"function {name} cannot be sent to other processes ({reason}); define it at the top of a module that they can "
        "import, without lambda, or give an executor that takes it, such as client.get_executor() of Dask",
    )
