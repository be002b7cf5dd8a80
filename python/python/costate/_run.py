"""Waiting for a solve: progress, logging, Ctrl-C."""

from __future__ import annotations

import logging
import sys
from typing import TYPE_CHECKING, Any, NamedTuple

from ._costate import _Run, _Solution
from ._errors import ArgumentError
from ._progress import tqdm_or_none

logger = logging.getLogger("costate")
logger.addHandler(logging.NullHandler())

# Seconds between two looks at the steps; a signal is handled after as long.
_PAUSE = 0.05


class Iteration(NamedTuple):
    """A Newton step.

    Attributes
    ----------
    phase : str
        What is being solved: "direct", "restoration", "polish", "fixed time", ...
    nodes : int
        Nodes of the mesh.
    number : int
        Number of the step on this mesh, from 1.
    residual : float
        Relative change of the cost that is expected, or the largest violation of a limit; of the indirect methods
        the relative correction.
    step : float
        The part of the correction that was taken, in (0, 1].
    final_time : float
        T (s).
    cost : float
        J so far, with penalties.
    """

    phase: str
    nodes: int
    number: int
    residual: float
    step: float
    final_time: float
    cost: float


if TYPE_CHECKING:
    from collections.abc import Callable

    _Progress = bool | None | Callable[[Iteration], Any]


def finish(run: _Run, progress: _Progress, show: bool) -> tuple[_Solution, bool]:
    """Wait for a solve; the solution, and whether Ctrl-C ended it.

    Only this function calls Python code during a solve: the solver runs on a thread that knows nothing of Python.
    """
    report = _Bar() if progress is True else None
    if progress is not None and not isinstance(progress, bool) and not callable(progress):
        raise _wrong("progress", "give None, True, or a function of an Iteration")
    interrupted = stopped = False
    try:
        while True:
            try:
                ended = run.wait(_PAUSE)
                for step in map(Iteration._make, run.steps()):
                    if show:
                        logger.debug(
                            "%s, %d nodes, step %d: residual %.1e, cost %.9g, T %.6g s",
                            *(step.phase, step.nodes, step.number, step.residual, step.cost, step.final_time),
                        )
                    if report is not None:
                        report.show(step)
                    elif not stopped and callable(progress) and progress(step):
                        stopped = True
                        run.cancel()
                if ended:
                    break
            except KeyboardInterrupt:
                if interrupted:  # The second one is not waited for.
                    raise
                interrupted = True
                run.cancel()
    except BaseException:
        run.cancel()
        raise
    finally:
        if report is not None:
            report.close()
    solution = run.solution()
    assert solution is not None
    return solution, interrupted


def _wrong(argument: str, message: str) -> ArgumentError:
    error = ArgumentError(f"{argument}: {message}")
    error.argument = argument
    return error


class _Bar:
    """A bar of tqdm where that is installed, else a line on standard error."""

    def __init__(self) -> None:
        self.bar: Any = None
        tqdm = tqdm_or_none()
        if tqdm is None:
            return
        self.bar = tqdm(unit=" steps", desc="costate")

    def show(self, step: Iteration) -> None:
        text = f"{step.phase}, {step.nodes} nodes, residual {step.residual:.1e}, cost {step.cost:.6g}"
        if self.bar is not None:
            self.bar.set_postfix_str(text, refresh=False)
            self.bar.update()
        else:
            print(f"\r\x1b[K{text}", end="", file=sys.stderr, flush=True)

    def close(self) -> None:
        if self.bar is not None:
            self.bar.close()
        else:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)


def check_on_interrupt(on_interrupt: str) -> None:
    """Refuse what is neither of the two."""
    if on_interrupt not in ("raise", "return"):
        raise _wrong("on_interrupt", f"unknown value {on_interrupt!r}; give 'raise' or 'return'")
