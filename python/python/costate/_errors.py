"""Errors and warnings of costate."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ._solution import Solution


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
    """Ctrl-C during a solve.

    Attributes
    ----------
    solution : Solution
        The best motion so far; its status is ``"cancelled"``, unless it was solved in the last moment.
    """

    def __init__(self, solution: Solution) -> None:
        super().__init__(
            f"interrupted: {solution.status}, cost {solution.cost:.9g}; .solution is the best motion so far"
        )
        self.solution = solution

    def __reduce__(self) -> tuple[type[Interrupted], tuple[Solution]]:
        return (type(self), (self.solution,))


class StateError(CostateError):
    """A state at which nothing can be computed.

    Attributes
    ----------
    index : tuple of int
        The batch index of the state, ``()`` where there is no batch.
    joint : str or None
        The joint.
    argument : str or None
        The argument with a number that is not finite.
    """

    index: tuple[int, ...] = ()
    joint: str | None = None
    argument: str | None = None


class NonFiniteState(StateError):
    """An argument has an entry that is infinite or not a number."""


class SingularMassMatrix(StateError):
    """The mass matrix has no inverse in working precision."""


class StepNotSolved(StateError):
    """The implicit equation of a time step was not solved: take a shorter step."""


class CodegenError(CostateError):
    """A quantity of which no source text can be written."""


class RobotWarning(UserWarning):
    """What is unusual about the description of a robot."""


class ProblemWarning(UserWarning):
    """What is probably not meant in a problem."""


class StateWarning(RuntimeWarning):
    """States that could not be evaluated: their rows are not-a-number."""
