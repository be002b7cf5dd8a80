"""Many tasks on many processes or machines."""

from __future__ import annotations

import logging
import os
import warnings
from collections.abc import Callable, Iterable
from os import PathLike
from typing import Any

from . import _workers
from ._chunks import Chunks
from ._drive import drive
from ._errors import Interrupted, argument_error, whole
from ._outcomes import Outcome, said
from ._parquet import Table
from ._progress import Counter
from ._runners import Given, Pool

__all__ = ["sweep"]

logger = logging.getLogger("costate")


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
    are called again, one at a time; a task that ends three workers while it runs alone fails with `WorkerDied`. Ctrl-C ends
    the sweep: `Interrupted.reached` has the outcomes so far; with ``parquet`` they are kept, and the same call goes on.

    Parameters
    ----------
    function : callable
        Takes one task. For the pool it is defined at the top of a module, and what it takes and returns can be pickled.
        It should compute on one thread: ``Dynamics(..., threads=1)``, ``problem.solve(threads=1)``.
    tasks : iterable
        The arguments, one for each call.
    executor : concurrent.futures.Executor, optional
        Where the calls run, such as ``client.get_executor()`` of Dask, or that client. Unless given, new processes of
        this machine (start method "spawn": a script needs ``if __name__ == "__main__":``).
    workers : int, optional
        Processes of that pool, without an executor; as many as the process may use processors unless given, and at
        most 61 on Windows.
    chunk : int, optional
        Most tasks that are sent at once. Unless given, one at first, and then as many as take half a second by the
        measured times, at most 100, and fewer where each worker would get less than four times. A worker that has
        computed for a second sends back what it has; what is left of its chunk is sent again.
    retries : int
        How often a task that raises is tried again.
    progress : None, True or function
        True shows a bar (of tqdm, if installed). A function is called with each `Outcome` as it comes; where it
        raises an `Exception`, the sweep warns once and goes on.
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
        For an argument that does not fit, a function that cannot be pickled, a file that holds something else, and,
        with ``parquet``, a task that cannot be pickled.
    Interrupted
        On Ctrl-C, also where a ``progress`` function raises `KeyboardInterrupt`. One that a task raises is its error.
    WorkerDied
        Where a new process cannot start at all.

    Warns
    -----
    RuntimeWarning
        Where a cluster of Dask has no workers for five seconds while tasks wait, results cannot be kept, a
        ``progress`` function raises, or processes of the pool do not end with the sweep.

    Examples
    --------
    >>> import costate, math
    >>> from concurrent.futures import ThreadPoolExecutor
    >>> with ThreadPoolExecutor(2) as threads:
    ...     outcomes = costate.sweep(math.sqrt, [4.0, -1.0, 9.0], threads)
    >>> [outcome.value for outcome in outcomes], outcomes[1].error
    ([2.0, None, 3.0], ValueError('math domain error'))
    """
    if not callable(function):
        raise argument_error("function", f"function {function!r} cannot be called; give a function of one task")
    retries = whole("retries", retries, 0)
    chunk = None if chunk is None else whole("chunk", chunk, 1)
    workers = None if workers is None else whole("workers", workers, 1)
    if executor is not None and workers is not None:
        raise argument_error("workers", "workers is of the pool of this machine; the executor has its own number, leave it out")
    if progress is not None and not isinstance(progress, bool) and not callable(progress):
        raise argument_error("progress", f"progress is {progress!r}; give None, True, or a function of an Outcome")
    try:
        iter(tasks)
    except TypeError:
        raise argument_error("tasks", f"tasks {tasks!r} cannot be iterated; give a list, one entry a call") from None
    tasks = list(tasks)
    runner: Pool | Given
    if executor is None:
        runner = Pool(function, _workers.processes(workers), retries)
    else:
        runner = Given(function, executor, retries)
    table = None if parquet is None else Table(_path(parquet), tasks)
    found: dict[int, Outcome] = {} if table is None else table.known()
    bar = Counter(progress is True, len(tasks), len(found))
    warned = False

    def keep(outcome: Outcome, told: bool = True) -> None:
        nonlocal warned
        if outcome.index in found:
            return
        if table is not None:
            outcome = table.add(outcome)
        found[outcome.index] = outcome
        bar.add(outcome.error is not None)
        if told and callable(progress):
            try:
                progress(outcome)
            except Exception as error:  # A fault there is no reason to lose what was computed.
                if not warned:
                    warned = True
                    text = f"progress has raised {said(error)} for the outcome of task {outcome.index}; the sweep goes on"
                    warnings.warn(text, RuntimeWarning, stacklevel=5)

    def tell(text: str) -> None:
        bar.say(text)
        logger.warning("sweep: %s", text)
        warnings.warn(text, RuntimeWarning, stacklevel=4)

    chunks = Chunks([index for index in range(len(tasks)) if index not in found], chunk)
    try:
        try:
            drive(runner, tasks, chunks, keep, table, tell)
        finally:
            bar.close()
            if table is not None:
                table.close()
        runner.close()
    except KeyboardInterrupt:
        runner.stop()
        text = f"interrupted: {len(found)} of {len(tasks)} tasks have an outcome; .reached has the outcomes"
        raise Interrupted([found[index] for index in sorted(found)], text) from None
    except BaseException:
        runner.stop()
        raise
    return [found[index] for index in range(len(tasks))]


def _path(given: Any) -> str:
    try:
        return os.fsdecode(given)
    except TypeError:
        raise argument_error("parquet", f"parquet is {given!r}; give the path of a file") from None
