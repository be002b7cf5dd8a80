"""What the processes of a sweep run."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import threading
import time
import traceback
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from typing import Any, TypeAlias

# Value, error, its traceback, seconds, attempts.
Result: TypeAlias = tuple[Any, Exception | None, str, float, int]

# The function of the sweep that this process serves.
_functions: dict[bytes, Callable[[Any], Any]] = {}


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
    return ProcessPoolExecutor(workers, mp_context=context, initializer=_begin)


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


def readable(function: bytes) -> str | None:
    """Why a function cannot be read here."""
    try:
        _function(function)
    except Exception as error:
        return str(error)
    return None


def many(function: Callable[[Any], Any], tasks: Sequence[Any], retries: int, call: str = "") -> list[Result]:
    """Results of tasks, one after the other. Executors such as Dask's take calls with equal arguments for one."""
    return [_one(function, task, retries) for task in tasks]


def many_pickled(function: bytes, tasks: Sequence[bytes | Exception], retries: int) -> list[bytes]:
    """The same of pickles: what cannot be read or written is the fault of one task, not of the pool."""
    return [_pickled(_one(lambda text: _function(function)(_task(text)), task, retries)) for task in tasks]


def unpickled(text: bytes) -> Result:
    """A result of `many_pickled`."""
    try:
        result: Result = pickle.loads(text)
    except Exception as error:
        return None, TypeError(f"the result cannot be read: {error}"), "", float("nan"), 1
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
        return pickle.dumps((None, TypeError(f"the result cannot be pickled: {error}"), "", *figures))


def _one(function: Callable[[Any], Any], task: Any, retries: int) -> Result:
    start = time.perf_counter()
    for attempt in range(1, retries + 2):
        try:
            return function(task), None, "", time.perf_counter() - start, attempt
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # sys.exit() too ends a task, and not the sweep.
            found, text = _portable(error), traceback.format_exc()
    return None, found, text, time.perf_counter() - start, attempt


def _portable(error: BaseException) -> Exception:
    """The error without its frames, or its words where it cannot be pickled."""
    try:
        copy = pickle.loads(pickle.dumps(error))
    except Exception:
        copy = None
    if isinstance(copy, Exception):
        return copy
    return RuntimeError(f"{type(error).__name__}: {error}")
