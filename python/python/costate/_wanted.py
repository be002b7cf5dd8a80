"""What adapters take: a robot, its dynamics or a time step of them."""

from __future__ import annotations

from typing import Any, cast

from ._costate import Dynamics, Robot, Step
from ._errors import ArgumentError, RobotError, argument_error


def robot_of(given: Any, name: str = "robot") -> Robot:
    """The robot; that of dynamics in (q, v)."""
    if isinstance(given, Dynamics) and given.coordinates == "qv":
        return given.robot
    if isinstance(given, Robot):
        return given
    raise _wrong(name, given, 'a costate.Robot, or costate.Dynamics in "qv"')


def dynamics_of(given: Any, name: str = "dynamics", *, free: bool = False) -> Dynamics:
    """The dynamics; those of a robot in (q, v). Floating and spherical joints are refused unless they are taken."""
    if isinstance(given, Robot):
        given = Dynamics(given)
    # Objects with the methods of dynamics, such as those that count calls, will do.
    if isinstance(given, Dynamics) or hasattr(given, "adjoint") and hasattr(given, "coordinates"):
        found = cast("Dynamics", given)
        robot = getattr(found, "robot", None)
        if not free and isinstance(robot, Robot):
            refuse_free_joints(robot)
        return found
    raise _wrong(name, given, "costate.Dynamics, or a costate.Robot")


def refuse_free_joints(robot: Robot) -> None:
    """An error for a robot with floating or spherical joints, where states are vectors of as many positions as rates."""
    if robot.free_joints:
        raise free_joint_error(
            robot, "positions here are as many as rates; use Dynamics, Step and Robot.integrate, costate.jax or costate.torch"
        )


def free_joint_error(robot: Robot, what: str) -> RobotError:
    """The error for a robot with floating or spherical joints, which says what its first one does not."""
    joint, kind, *_ = robot.free_joints[0]
    error = RobotError(f"joint '{joint}' is {kind}, its orientation a quaternion, and {what}")
    error.culprit = joint
    return error


def step_of(given: Any, name: str = "step") -> Step:
    """The time step, of a robot without floating and spherical joints."""
    if isinstance(given, Step) or hasattr(given, "dynamics") and hasattr(given, "contract"):
        found = cast("Step", given)
        robot = getattr(found.dynamics, "robot", None)
        if isinstance(robot, Robot):
            refuse_free_joints(robot)
        return found
    raise _wrong(name, given, 'a costate.Step, such as costate.Step(costate.Dynamics(robot), "rk4", 0.01)')


def _wrong(name: str, given: Any, wanted: str) -> ArgumentError:
    kind = type(given)
    known = {Robot: "Robot", Step: "Step"}.get(kind)
    found = f"costate.{known}" if known else f'Dynamics in "{given.coordinates}"' if kind is Dynamics else kind.__name__
    return argument_error(name, f"{name} is a {found}; give {wanted}")
