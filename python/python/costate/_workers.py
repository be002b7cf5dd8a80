"""What the processes of a sweep run."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import threading
import time
import traceback
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures import process as _process
from contextlib import contextmanager, suppress
from multiprocessing import connection
from typing import Any, TypeAlias

from ._outcomes import said

# Value, error, its traceback, seconds, attempts.
Result: TypeAlias = tuple[Any, Exception | None, str, float, int]

# The function of the sweep that this process serves.
_functions: dict[bytes, Callable[[Any], Any]] = {}
# What a thread of the process that sweeps is doing.
_submits = threading.local()

# Seconds after which a chunk ends with the task that runs, and those that processes have to end.
_SECONDS, _GRACE = 1.0, 2.0

# The pool of Python cannot wait for more processes there.
_MOST_ON_WINDOWS = 61


def processes(given: int | None) -> int:
    """How many processes a pool has: as many as this one may use processors unless given."""
    if given is None:
        given = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return min(given, _MOST_ON_WINDOWS) if os.name == "nt" else given


def new_pool(workers: int) -> ProcessPoolExecutor:
    """Processes that have copied nothing of this one: threads and locks do not survive a fork."""
    context = multiprocessing.get_context("spawn")
    return guarded(ProcessPoolExecutor(workers, mp_context=context, initializer=_begin))


class _Calls(dict[int, Any]):
    """The calls that wait in a pool.

    In Python 3.10 and 3.11 the thread that ends a broken pool iterates over them without the lock that `submit` holds. A
    call submitted in that moment changes the dictionary: the thread ends with a RuntimeError, or nobody fails the call.
    Here the thread waits for the lock, as in later versions, and iterates over a copy.
    """

    def __init__(self, lock: Any) -> None:
        super().__init__()
        self._lock = lock

    def items(self) -> Any:
        with self._lock:
            return self.copy().items()


def guarded(pool: ProcessPoolExecutor) -> ProcessPoolExecutor:
    """The pool, before its first call: a process that dies while a call is submitted fails that call too."""
    manager = getattr(_process, "_ExecutorManagerThread", None)
    if not hasattr(manager, "_terminate_broken") and hasattr(pool, "_shutdown_lock"):
        pool._pending_work_items = _Calls(pool._shutdown_lock)
    return pool


def end(pool: ProcessPoolExecutor, at_once: bool = False) -> bool:
    """End a pool: whether its processes have ended in time, by themselves unless at once."""
    processes = _processes(pool)
    manager = getattr(pool, "_executor_manager_thread", None)
    pipes = [("_writer", getattr(pool, "_result_queue", None)), ("_reader", getattr(pool, "_call_queue", None))]
    try:
        pool.shutdown(wait=False, cancel_futures=True)
        left = late = processes if at_once else _running(processes, _GRACE)
        for act in ("terminate", "kill"):
            for process in left:
                getattr(process, act)()
            left = _running(left, _GRACE)
        if manager is not None:
            manager.join(_GRACE / 4)
            if manager.is_alive():
                # It reads or writes the rest of what a process that was ended has begun, and Python would wait for it.
                for name, queue in pipes:
                    with suppress(Exception):
                        getattr(queue, name).close()
                manager.join(_GRACE)
    except BaseException:
        for process in processes:
            process.kill()
        raise
    return not late


def lost(pool: ProcessPoolExecutor) -> bool:
    """Whether a process of a pool has ended."""
    return bool(connection.wait([process.sentinel for process in _processes(pool)], 0.0))


def _processes(pool: ProcessPoolExecutor) -> list[Any]:
    return list((getattr(pool, "_processes", None) or {}).values())


def _running(processes: list[Any], seconds: float) -> list[Any]:
    """Those that have not ended in so many seconds."""
    end = time.monotonic() + seconds
    while processes:
        ended = connection.wait([process.sentinel for process in processes], max(0.0, end - time.monotonic()))
        if not ended:
            break
        processes = [process for process in processes if process.sentinel not in ended]
    return processes


def _begin() -> None:
    # Ctrl-C reaches all processes of a terminal; the one that sweeps decides.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    # A process that is killed cannot end its workers.
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _function(text: bytes) -> Callable[[Any], Any]:
    if text not in _functions:
        _functions.clear()
        _functions[text] = pickle.loads(text)
    return _functions[text]


@contextmanager
def submitting() -> Iterator[None]:
    """While this thread gives a call to an executor."""
    before, _submits.process = getattr(_submits, "process", None), os.getpid()
    try:
        yield
    finally:
        _submits.process = before


def readable(function: bytes) -> str | None:
    """Why a function cannot be read here."""
    try:
        _function(function)
    except BaseException as error:  # Its module may call sys.exit().
        return said(error)
    return None


def many(function: Callable[[Any], Any], tasks: Sequence[Any], retries: int, call: str = "") -> list[Result]:
    """Results of the first tasks, one after the other, and of all of them within a second.

    The other tasks are sent again: what a worker has computed should not wait for long. Executors such as Dask's take
    calls with equal arguments for one.
    """
    return list(_in_time(function, tasks, retries))


def many_pickled(function: bytes, tasks: Sequence[bytes | Exception], retries: int) -> list[bytes]:
    """The same of pickles: what cannot be read or written is the fault of one task, not of the pool."""
    return list(map(_pickled, _in_time(lambda text: _function(function)(_task(text)), tasks, retries)))


def _in_time(function: Callable[[Any], Any], tasks: Sequence[Any], retries: int) -> Iterator[Result]:
    start = time.perf_counter()
    for task in tasks:
        result, interrupted = _one(function, task, retries)
        yield result
        if interrupted or time.perf_counter() - start > _SECONDS:
            return


def unpickled(text: bytes) -> Result:
    """A result of `many_pickled`."""
    try:
        result: Result = pickle.loads(text)
    except Exception as error:
        return None, TypeError(f"the result cannot be read: {said(error)}"), "", float("nan"), 1
    return result


def _task(text: bytes | Exception) -> Any:
    if isinstance(text, Exception):
        raise text
    return pickle.loads(text)


def _pickled(result: Result) -> bytes:
    try:
        return pickle.dumps(result)
    except Exception as error:
        _, _, _, *figures = result
        return pickle.dumps((None, TypeError(f"the result cannot be pickled: {said(error)}"), "", *figures))


def _one(function: Callable[[Any], Any], task: Any, retries: int) -> tuple[Result, bool]:
    """The result of a task, and whether it was interrupted."""
    start, interrupted = time.perf_counter(), False
    for attempt in range(1, retries + 2):
        try:
            return (function(task), None, "", time.perf_counter() - start, attempt), False
        except BaseException as error:  # sys.exit() too ends a task, and not the sweep.
            interrupted = isinstance(error, KeyboardInterrupt)
            if interrupted and getattr(_submits, "process", None) == os.getpid():
                raise  # Of the process that sweeps, by an executor that computes at once.
            found, text = _portable(error), traceback.format_exc()
            if interrupted:
                break
    return (None, found, text, time.perf_counter() - start, attempt), interrupted


def _portable(error: BaseException) -> Exception:
    """The error without its frames, or its words where it cannot be pickled."""
    try:
        copy = pickle.loads(pickle.dumps(error))
    except Exception:
        copy = None
    if isinstance(copy, Exception):
        return copy
    return RuntimeError(said(error))
