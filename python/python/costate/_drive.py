"""Running the tasks of a sweep until each has an outcome."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Future, wait
from contextlib import suppress
from typing import Any

from ._chunks import Chunks
from ._errors import ArgumentError
from ._outcomes import Outcome, WorkerDied, said
from ._parquet import Table
from ._runners import Given, Pool
from ._workers import Result

# How often a task that runs alone is tried again when its worker dies, or when its executor fails.
_LIVES = 2
# Seconds after which results are kept and the executor is looked at though nothing comes.
_TICK = 1.0
# Seconds that the calls of a pool have to end with it.
_END = 10.0


def drive(
    runner: Pool | Given,
    tasks: list[Any],
    chunks: Chunks,
    keep: Callable[..., None],
    table: Table | None = None,
    tell: Callable[[str], None] | None = None,
) -> None:
    """Run what waits; `keep` takes each outcome, `tell` what a user should know."""
    suspects: deque[int] = deque()  # Their worker died, perhaps because of another task.
    deaths: dict[int, int] = {}
    running: dict[Future[Any], list[int]] = {}
    single = False  # Whether what runs is one suspect.
    started = False

    def fail(indices: list[int], error: Exception) -> None:
        for index in indices:
            keep(Outcome.failed(index, tasks[index], error))

    def start(chunk: list[int]) -> bool:
        nonlocal started
        try:
            running[runner.submit([tasks[index] for index in chunk])] = chunk
            started = True
        except BrokenExecutor as error:
            if runner.ends_together:
                if single:
                    suspects.appendleft(chunk[0])
                else:
                    chunks.again(chunk)
                lost()
                return False
            fail(chunk, error)
        except Exception as error:
            if runner.ends_together:
                if not started or not isinstance(error, (ArgumentError, WorkerDied)):
                    raise
                # No new pool can be made any more: what the old one has computed is not lost.
                fail([*chunk, *suspects, *chunks.all()], error)
                suspects.clear()
            elif len(chunk) > 1:
                chunks.again(chunk, single=True)  # Perhaps one of them cannot be sent.
            else:
                fail(chunk, error)
        return True

    def lost() -> None:
        """The pool has ended, and all that ran there."""
        wait(running, timeout=_END)
        runner.broken()
        for future in list(running):
            finish(future)

    def take(future: Future[Any], keep: Callable[[Outcome], None] = keep) -> list[Result]:
        results = runner.results(future)
        for index, result in zip(running[future], results):
            keep(Outcome(index, tasks[index], *result))
        return results

    def finish(future: Future[Any]) -> None:
        chunk, error = running[future], _failure(future)
        if error is None:
            results = take(future)
            # A chunk ends early after a while.
            chunks.again(chunk[len(results) :])
            chunks.measured(seconds for *_, seconds, _ in results)
        else:
            # A worker that dies takes the tasks with it that waited there, so only one that ran alone is to blame.
            suspect = _died(error)
            for index in chunk:
                deaths[index] = deaths.get(index, 0) + (_times(error) if single or not suspect else 0)
                if deaths[index] > _LIVES:
                    keep(Outcome.failed(index, tasks[index], _death(error, deaths[index]), deaths[index]))
                elif suspect:
                    suspects.append(index)
                else:
                    chunks.again([index], single=True)
        del running[future]

    try:
        while chunks or suspects or running:
            if not running:
                single = bool(suspects)
                if single:
                    start([suspects.popleft()])
            while chunks and not suspects and not single and len(running) < runner.window:
                if not start(chunks.next(runner.workers)):
                    break
            if not running:
                continue
            done, _ = wait(running, timeout=_TICK, return_when=FIRST_COMPLETED)
            if runner.ends_together and any(isinstance(_failure(future), BrokenExecutor) for future in done):
                lost()
            else:
                for future in done:
                    finish(future)
            if table is not None:
                table.tick()
            left = len(chunks) + len(suspects) + sum(map(len, running.values()))
            try:
                text = runner.watch(left, bool(done))
            except BrokenExecutor:
                lost()
                continue
            if text is not None and tell is not None:
                tell(text)
    except BaseException:
        # What has come in the meantime is not lost.
        for future in running:
            with suppress(Exception):
                if future.done() and not future.cancelled() and future.exception() is None:
                    take(future, lambda outcome: keep(outcome, False))
        raise


def _failure(future: Future[Any]) -> Exception | None:
    """Why a call has no results."""
    if not future.done():
        return BrokenExecutor("the pool has ended, and this call with it")
    if future.cancelled():
        return CancelledError("the executor has cancelled this call")
    error = future.exception()
    if isinstance(error, KeyboardInterrupt):
        raise KeyboardInterrupt  # Of a signal: those of tasks are results.
    return error if error is None or isinstance(error, Exception) else RuntimeError(said(error))


def _died(error: Exception) -> bool:
    """Whether a worker died: of a pool, or of Dask (its own error, after it has tried again by itself)."""
    return isinstance(error, BrokenExecutor) or type(error).__name__ == "KilledWorker"


def _times(error: Exception) -> int:
    """How many workers died: Dask tries again by itself before it says so."""
    again = getattr(error, "allowed_failures", 0)
    return 1 + again if isinstance(again, int) else 1


def _death(error: Exception, times: int) -> Exception:
    if _died(error):
        return WorkerDied(f"the process of this task died {times} times: out of memory, or a crash of native code")
    return error
