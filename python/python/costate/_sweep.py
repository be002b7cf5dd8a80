"""Many tasks on many processes or machines."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future, wait
from contextlib import suppress
from os import PathLike, fspath
from typing import Any

from . import _workers
from ._errors import argument_error
from ._outcomes import Outcome, WorkerDied
from ._parquet import Table
from ._progress import Counter
from ._runners import Given, Pool

__all__ = ["sweep"]

# How often a task that runs alone is tried again when its worker dies.
_LIVES = 2
# Seconds after which results are kept though none comes.
_TICK = 1.0
# Most tasks of a chunk that is not given, and chunks that each worker gets at least.
_CHUNK, _SHARE = 8, 4


def sweep(
    function: Callable[[Any], Any],
    tasks: Iterable[Any],
    executor: Any = None,
    *,
    workers: int | None = None,
    chunk: int | None = None,
    retries: int = 0,
    progress: bool | Callable[[Outcome], Any] | None = None,
    parquet: str | PathLike[str] | None = None,
) -> list[Outcome]:
    """Call a function with each of many tasks, on a pool of processes or on a cluster.

    A task that raises does not end the sweep: its outcome has the error. When a worker dies, the tasks that were running
    are called again, one at a time; one that ends three workers while it runs alone fails with `WorkerDied`. Ctrl-C ends the sweep; with ``parquet`` its results are kept, and the same call goes on.

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
        Processes of that pool; as many as the process may use processors unless given, and at most 61 on Windows.
    chunk : int, optional
        Tasks that are sent at once; more of them where a task takes milliseconds. Unless given, up to 8, and fewer where
        each worker would get less than four times; one where the size of the executor is not known.
    retries : int
        How often a task that raises is tried again.
    progress : None, True or function
        True shows a bar (of tqdm, if installed). A function is called with each `Outcome` as it comes.
    parquet : path, optional
        A file of results, with pyarrow installed: ``index``, ``key`` (a digest of the task), ``error``, ``seconds``,
        ``attempts``, ``columns`` (the keys of the result), and one column for each key of the dictionaries that the
        function returns; other results are in ``value``. They are kept every few seconds beside it, in ``PATH.parts``,
        and the file is replaced at the end. Tasks whose results are there are not computed again, though the function
        may be another one; failed ones are. What is read back: keys are text, arrays and tuples are lists, and what
        Arrow has no type for is what its JSON text says, with ``repr`` of other objects.

    Returns
    -------
    list of Outcome
        In the order of the tasks.

    Raises
    ------
    ArgumentError
        For a function that cannot be pickled, a file that holds something else, and, with ``parquet``, a task that
        cannot be pickled.
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
    for name, value, least in (("chunk", chunk, 1), ("retries", retries, 0), ("workers", workers, 1)):
        if value is not None and value < least:
            raise argument_error(name, f"{name} is {value}; at least {least} is needed")
    tasks = list(tasks)
    table = None if parquet is None else Table(fspath(parquet), tasks)
    runner: Pool | Given
    if executor is None:
        runner = Pool(function, _workers.processes(workers), retries)
    else:
        runner = Given(function, executor, retries)
    found: dict[int, Outcome] = {} if table is None else table.known()
    bar = Counter(progress is True, len(tasks), len(found))

    def keep(outcome: Outcome, told: bool = True) -> None:
        if outcome.index in found:
            return
        if table is not None:
            table.add(outcome)
        found[outcome.index] = outcome
        bar.add(outcome.error is not None)
        if told and callable(progress):
            progress(outcome)

    left = [index for index in range(len(tasks)) if index not in found]
    if chunk is None:
        chunk = max(1, min(_CHUNK, len(left) // (_SHARE * runner.workers))) if runner.workers else 1
    chunks = [left[k : k + chunk] for k in range(0, len(left), chunk)]
    try:
        try:
            _drive(runner, tasks, chunks, keep, table)
        finally:
            bar.close()
            if table is not None:
                table.close()
    except BaseException:
        runner.stop()
        raise
    runner.close()
    return [found[index] for index in range(len(tasks))]


def _drive(
    runner: Pool | Given,
    tasks: list[Any],
    chunks: list[list[int]],
    keep: Callable[..., None],
    table: Table | None = None,
) -> None:
    """Run chunks of tasks (their indices) until each task has an outcome."""
    waiting = deque(chunks)
    suspects: deque[int] = deque()  # Their worker died, perhaps because of another task.
    deaths: dict[int, int] = {}
    running: dict[Future[Any], list[int]] = {}
    single = False  # Whether what runs is one suspect.

    def start(chunk: list[int]) -> bool:
        try:
            running[runner.submit([tasks[index] for index in chunk])] = chunk
        except BrokenExecutor as error:
            if not runner.ends_together:
                for index in chunk:
                    keep(Outcome.failed(index, tasks[index], error))
                return True
            runner.broken()
            if single:
                suspects.appendleft(chunk[0])
            else:
                waiting.appendleft(chunk)
            return False
        return True

    def finish(future: Future[Any]) -> None:
        chunk = running[future]
        try:
            results = runner.results(future)
        except Exception as error:
            # A worker that dies takes the tasks with it that waited there, so only one that ran alone is to blame.
            suspect = runner.ends_together or _died(error)
            for index in chunk:
                deaths[index] = deaths.get(index, 0) + (single or not suspect)
                if deaths[index] > _LIVES:
                    keep(Outcome.failed(index, tasks[index], _death(error), deaths[index]))
                elif suspect:
                    suspects.append(index)
                else:
                    waiting.appendleft([index])
        else:
            for index, result in zip(chunk, results, strict=True):
                keep(Outcome(index, tasks[index], *result))
        del running[future]

    try:
        while waiting or suspects or running:
            if not running:
                single = bool(suspects)
                if single:
                    start([suspects.popleft()])
            while waiting and not suspects and not single and len(running) < runner.window:
                if not start(waiting.popleft()):
                    break
            if not running:
                continue
            done, _ = wait(running, timeout=_TICK, return_when=FIRST_COMPLETED)
            if runner.ends_together and any(isinstance(future.exception(), BrokenExecutor) for future in done):
                done, _ = wait(running)  # All of them have ended with the pool.
                runner.broken()
            for future in done:
                finish(future)
            if table is not None:
                table.tick()
    except BaseException:
        # What has come in the meantime is not lost.
        for future, chunk in running.items():
            with suppress(Exception):
                if future.done() and not future.cancelled() and future.exception() is None:
                    for index, result in zip(chunk, runner.results(future), strict=True):
                        keep(Outcome(index, tasks[index], *result), False)
        raise


def _died(error: Exception) -> bool:
    """Whether a worker died: of a pool, or of Dask (its own error, after it has tried again by itself)."""
    return isinstance(error, BrokenExecutor) or type(error).__name__ == "KilledWorker"


def _death(error: Exception) -> Exception:
    if _died(error):
        return WorkerDied(f"the process of this task died {_LIVES + 1} times: out of memory, or a crash of native code")
    return error
