"""What became of the tasks of a sweep."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ._errors import CostateError


def said(error: BaseException) -> str:
    """The name of an error and its words, where it has some."""
    try:
        return f"{type(error).__name__}: {error}"
    except Exception:
        return type(error).__name__


class WorkerDied(CostateError):
    """The process that computed a task of a sweep ended by itself."""


@dataclass(frozen=True)
class Outcome:
    """What became of a task of `sweep`.

    Attributes
    ----------
    index : int
        Its place among the tasks.
    task : object
        The task.
    value : object
        What the function returned; None where it failed.
    error : Exception or None
        What it raised.
    traceback : str
        Where it raised that; empty otherwise.
    seconds : float
        How long the function took (s), with all attempts.
    attempts : int
        How often it was called.
    """

    index: int
    task: Any
    value: Any
    error: Exception | None
    traceback: str
    seconds: float
    attempts: int

    @classmethod
    def failed(cls, index: int, task: Any, error: Exception, attempts: int = 0) -> Outcome:
        """A task that has no result because its worker has not answered.

        Parameters
        ----------
        index : int
            Its place among the tasks.
        task : object
            The task.
        error : Exception
            Why there is none.
        attempts : int
            How often the function was called.

        Returns
        -------
        Outcome
            Without a value.
        """
        return cls(index, task, None, error, "", float("nan"), attempts)

    @property
    def ok(self) -> bool:
        """Whether there is a value."""
        return self.error is None
