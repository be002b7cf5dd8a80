"""Many tasks on many processes or machines."""

from __future__ import annotations

import os
import pickle
from collections import deque
from collections.abc import Callable, Iterable
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from os import PathLike, fspath
from typing import Any

from . import _workers
from ._errors import argument_error
from ._outcomes import Outcome, WorkerDied
from ._parquet import Table
from ._progress import Counter

__all__ = ["sweep"]

# How often a task is tried again when its worker dies.
_LIVES = 2
# Chunks that another executor holds at once.
_WINDOW = 1024


def sweep(
    function: Callable[[Any], Any],
    tasks: Iterable[Any],
    executor: Any = None,
    *,
    workers: int | None = None,
    chunk: int = 8,
    retries: int = 0,
    progress: bool | Callable[[Outcome], Any] | None = None,
    parquet: str | PathLike[str] | None = None,
) -> list[Outcome]:
    """Call a function with each of many tasks, on a pool of processes or on a cluster.

    A task that raises does not end the sweep: its outcome has the error. A task whose worker dies is tried again, alone
    and up to twice. Ctrl-C ends the sweep; with ``parquet`` its results are kept, and the same call goes on.

    Parameters
    ----------
    function : callable
        Takes one task. For the pool it is defined at the top of a module, and what it takes and returns can be pickled.
        It should compute on one thread: ``Dynamics(..., threads=1)``, ``problem.solve(threads=1)``.
    tasks : iterable
        The arguments, one for each call.
    executor : concurrent.futures.Executor, optional
        Where the calls run, such as ``client.get_executor()`` of Dask. Unless given, new processes of this machine
        (start method "spawn": a script needs ``if __name__ == "__main__":``).
    workers : int, optional
        Processes of that pool; as many as the process may use processors unless given.
    chunk : int
        Tasks that are sent at once; more of them where a task takes milliseconds.
    retries : int
        How often a task that raises is tried again.
    progress : None, True or function
        True shows a bar (of tqdm, if installed). A function is called with each `Outcome` as it comes.
    parquet : path, optional
        A file of results, with pyarrow installed: ``index``, ``key`` (a digest of the task), ``error``, ``seconds``,
        ``attempts``, and one column for each key of the dictionaries that the function returns; other results are in
        ``value``. They are kept every few seconds beside it, in ``PATH.parts``, and the file is replaced at the end.
        Tasks whose results are there are not computed again; failed ones are.

    Returns
    -------
    list of Outcome
        In the order of the tasks.

    Raises
    ------
    ArgumentError
        For a function that cannot be pickled, and a file that holds something else.
    WorkerDied
        Where a new process cannot start at all.

    Examples
    --------
    >>> import costate, math
    >>> from concurrent.futures import ThreadPoolExecutor
    >>> with ThreadPoolExecutor(2) as threads:
    ...     outcomes = costate.sweep(math.sqrt, [4.0, -1.0, 9.0], threads)
    >>> [outcome.value for outcome in outcomes], outcomes[1].error
    ([2.0, None, 3.0], ValueError('math domain error'))
    """
    for name, value, least in (("chunk", chunk, 1), ("retries", retries, 0), ("workers", workers or 1, 1)):
        if value < least:
            raise argument_error(name, f"{name} is {value}; at least {least} is needed")
    tasks = list(tasks)
    table = None if parquet is None else Table(fspath(parquet), tasks)
    runner: _Pool | _Given
    if executor is None:
        runner = _Pool(function, workers or _processors(), retries)
    else:
        runner = _Given(function, executor, retries)
    found: dict[int, Outcome] = {} if table is None else table.known()
    bar = Counter(progress is True, len(tasks), len(found))

    def keep(outcome: Outcome) -> None:
        found[outcome.index] = outcome
        if table is not None:
            table.add(outcome)
        bar.add(outcome.error is not None)
        if callable(progress):
            progress(outcome)

    left = [index for index in range(len(tasks)) if index not in found]
    try:
        _drive(runner, tasks, [left[k : k + chunk] for k in range(0, len(left), chunk)], keep)
    except BaseException:
        runner.stop()
        raise
    finally:
        bar.close()
        if table is not None:
            table.close()
    runner.close()
    return [found[index] for index in range(len(tasks))]


def _processors() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class _Given:
    """An executor of the caller."""

    alone = False  # Whether tasks that may have killed a worker run one by one.
    window = _WINDOW

    def __init__(self, function: Callable[[Any], Any], executor: Executor, retries: int) -> None:
        self.executor, self.function, self.retries = executor, function, retries
        self.running: set[Future[Any]] = set()

    def submit(self, tasks: list[Any]) -> Future[Any]:
        future = self.executor.submit(_workers.many, self.function, tasks, self.retries)
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


class _Pool:
    """Processes of our own, made again when one of them dies."""

    alone = True

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


def _drive(
    runner: _Pool | _Given, tasks: list[Any], chunks: list[list[int]], keep: Callable[[Outcome], None]
) -> None:
    """Run chunks of tasks (their indices) until each task has an outcome."""
    waiting = deque(chunks)
    suspects: deque[int] = deque()  # Their worker died, perhaps because of another task.
    deaths: dict[int, int] = {}
    running: dict[Future[Any], list[int]] = {}

    def start(chunk: list[int]) -> None:
        try:
            running[runner.submit([tasks[index] for index in chunk])] = chunk
        except BrokenExecutor as error:
            if not runner.alone:
                for index in chunk:
                    keep(Outcome.failed(index, tasks[index], error))
                return
            runner.broken()
            waiting.appendleft(chunk)

    while waiting or suspects or running:
        single = bool(suspects) and not running
        if single:
            start([suspects.popleft()])
        while waiting and not suspects and len(running) < runner.window:
            start(waiting.popleft())
        if not running:
            continue
        done, _ = wait(running, return_when=FIRST_COMPLETED)
        if runner.alone and any(isinstance(future.exception(), BrokenExecutor) for future in done):
            done, _ = wait(running)  # All of them have ended with the pool.
            runner.broken()
        for future in done:
            chunk = running.pop(future)
            try:
                results = runner.results(future)
            except Exception as error:
                guilty = single or not runner.alone
                for index in chunk:
                    deaths[index] = deaths.get(index, 0) + guilty
                    if deaths[index] > _LIVES:
                        keep(Outcome.failed(index, tasks[index], _death(error), deaths[index]))
                    elif runner.alone:
                        suspects.append(index)
                    else:
                        waiting.appendleft([index])
                continue
            for index, result in zip(chunk, results, strict=True):
                keep(Outcome(index, tasks[index], *result))


def _death(error: Exception) -> Exception:
    # Dask's own error, after it has tried again by itself.
    if isinstance(error, BrokenExecutor) or type(error).__name__ == "KilledWorker":
        return WorkerDied(f"the process of this task died {_LIVES + 1} times: out of memory, or a crash of native code")
    return error
