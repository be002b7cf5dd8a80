"""Errors and warnings of costate."""

from __future__ import annotations


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


class StateWarning(RuntimeWarning):
    """States that could not be evaluated: their rows are not-a-number."""
