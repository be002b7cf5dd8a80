"""Errors and warnings of costate."""

from __future__ import annotations

import operator
from typing import Any


class CostateError(ValueError):
    """What costate refuses. The message says what is wrong and what to do."""


class ArgumentError(CostateError):
    """An argument that does not fit: its type, shape or layout, or a name that does not exist.

    Attributes
    ----------
    argument : str or None
        The argument.
    """

    argument: str | None = None


def argument_error(name: str, message: str) -> ArgumentError:
    """The error about an argument."""
    error = ArgumentError(message)
    error.argument = name
    return error


def whole(name: str, given: object, least: int) -> int:
    """A whole number that is large enough.

    >>> whole("steps", 3, 1)
    3
    """
    try:
        if isinstance(given, bool):
            raise TypeError
        number = operator.index(given)  # type: ignore[arg-type]
    except TypeError:
        raise argument_error(name, f"{name} is {given!r}; give a whole number") from None
    if not least <= number < 2**63:
        raise argument_error(name, f"{name} is {number}; give a whole number, at least {least}")
    return number


class RobotError(CostateError):
    """A robot that cannot be read, built or changed.

    Attributes
    ----------
    path : str or None
        The file.
    line : int or None
        The line of the culprit, from 1.
    culprit : str or None
        The joint, link or frame at fault.
    """

    path: str | None = None
    line: int | None = None
    culprit: str | None = None


class ProblemError(CostateError):
    """A problem, or an option of its solver, that is refused.

    Attributes
    ----------
    key : str or None
        The key at fault, as in a problem file: ``"limits.v_max"``.
    path : str or None
        The problem file.
    line : int or None
        The line of the key, from 1.
    """

    key: str | None = None
    path: str | None = None
    line: int | None = None


class MotionError(CostateError):
    """What cannot be asked of a motion: samples where there is none, feedback where it is no minimum."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during long work, with what was reached.

    Parameters
    ----------
    reached : Solution, Resolved, CheckReport, ndarray, tuple of ndarray or list of Outcome
        What was reached.
    message : str, optional
        What to say; about the motion of a `Solution` unless given.

    Attributes
    ----------
    reached : Solution, Resolved, CheckReport, ndarray, tuple of ndarray or list of Outcome
        Of `Problem.solve` and `Problem.follow` the best motion so far, with the status ``"cancelled"`` unless it was
        solved in the last moment; of `Resolve.solve` its figures; of `check` the report on the states that were compared;
        of a batch its results, not-a-number at states that were not computed; of `sweep` the outcomes of its tasks.
    solution : Solution or None
        The same where it is a motion of `Problem.solve` or `Problem.follow`.
    """

    def __init__(self, reached: Any, message: str | None = None) -> None:
        if message is None:
            message = f"interrupted: {reached.status}, cost {reached.cost:.9g}; .solution is the best motion so far"
        super().__init__(message)
        self.reached = reached

    @property
    def solution(self) -> Any:
        """The best motion so far, where there is one."""
        from ._solution import Solution

        return self.reached if isinstance(self.reached, Solution) else None

    def __reduce__(self) -> tuple[type[Interrupted], tuple[Any, str]]:
        return (type(self), (self.reached, str(self)))


class StateError(CostateError):
    """A state at which nothing can be computed.

    Attributes
    ----------
    index : tuple of int
        The batch index of the state, ``()`` where there is no batch.
    joint : str or None
        The joint.
    argument : str or None
        The argument with a number that is not finite, or a quaternion that is not unit.
    """

    index: tuple[int, ...] = ()
    joint: str | None = None
    argument: str | None = None


class NonFiniteState(StateError):
    """An argument has an entry that is infinite or not a number."""


class NonUnitQuaternion(StateError):
    """A quaternion of a configuration has another length than 1; ``Robot.normalize`` divides it by its length.

    Attributes
    ----------
    length : float
        Its length.
    """

    length: float = float("nan")


class NonFiniteResult(StateError):
    """Finite arguments lead to a result that is beyond all numbers.

    ``argument`` and ``joint`` are those of the largest number of the arguments; of a state within a time step ``joint``
    is the one that is beyond all numbers.
    """


class SingularMassMatrix(StateError):
    """The mass matrix has no inverse in working precision."""


class StepNotSolved(StateError):
    """The implicit equation of a time step was not solved: take a shorter step."""


class ConstraintError(StateError):
    """Constraints that cannot be satisfied, or not from this position.

    Attributes
    ----------
    constraint : str or None
        The constraint that misses most.
    miss : float or None
        By how much (m, rad).
    """

    constraint: str | None = None
    miss: float | None = None


class CodegenError(CostateError):
    """A quantity of which no source text can be written."""


class RobotWarning(UserWarning):
    """What is unusual about the description of a robot."""


class ProblemWarning(UserWarning):
    """What is probably not meant in a problem."""


class LimitWarning(ProblemWarning):
    """Limits of the robot that a motion was not asked to keep, since the problem says nothing about limits."""


class StateWarning(RuntimeWarning):
    """States that could not be evaluated: their rows are not-a-number."""
