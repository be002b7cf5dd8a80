"""Robots in CasADi: functions with exact Jacobians and Hessians, without a compiler.

Each function is a ``casadi.Function`` that CasADi loads from costate's own library, and calls without Python. Its
first and second derivatives are functions of the library too: nothing is differenced, and nothing is expanded into a
graph. It can be called with numbers and with ``MX`` symbols, mapped over threads, and used by ``Opti`` and
``nlpsol`` with the exact Hessian. ``SX`` symbols need a CasADi that calls functions in their graphs: 3.8.2 does.

A state that cannot be evaluated (a number that is not finite, a singular mass matrix) is an error of CasADi, which
solvers such as IPOPT answer with a shorter step.

Functions are pickled with the text of their robot. At most 64 of them exist at once in a process; one that was
made twice counts once, derivatives and maps count with their function.

>>> import casadi, costate, costate.casadi
>>> builder = costate.Robot.builder("pendulum")
>>> robot = builder.revolute("hinge", axis=[0, 1, 0], mass=1, com=[0, 0, -1]).build()
>>> a = costate.casadi.dynamics(robot)
>>> a(0.1, 0.0, 0.0)
DM(-0.979366)
>>> q = casadi.MX.sym("q")
>>> casadi.Function("a_qq", [q], [casadi.hessian(a(q, 0, 0), q)[0]])(0.1)
DM(0.979366)
"""

from __future__ import annotations

import base64
import pickle
from typing import TYPE_CHECKING, Any, Literal

from . import _costate
from ._costate import Dynamics, Robot, _casadi_calls, _casadi_refusal, _casadi_slots, _CasadiSlot, codegen
from ._wanted import robot_of

if TYPE_CHECKING:
    from ._costate import _Scheme

__all__ = [
    "calls",
    "centre_of_mass",
    "dynamics",
    "frame",
    "inverse_dynamics",
    "refusal",
    "slots",
    "source",
    "step",
    "twist",
]


def dynamics(robot: Robot | Dynamics) -> Any:
    """Forward dynamics (q, v, tau) -> a.

    Parameters
    ----------
    robot : Robot or Dynamics
        The robot, or dynamics of it in (q, v); q, v, tau and a have n entries in the order of ``robot.joint_names`` (rad, m, N m, N).

    Returns
    -------
    casadi.Function
        Its derivatives are those of `costate.Dynamics` in (q, v, tau).

    Raises
    ------
    ArgumentError
        For what is neither a robot nor dynamics.
    CostateError
        Where all functions that CasADi can refer to are in use.

    Examples
    --------
    >>> import costate, costate.casadi
    >>> robot = costate.Robot.builder("cart").prismatic("rail", axis=[1, 0, 0], mass=2).build()
    >>> a = costate.casadi.dynamics(robot)
    >>> a(0, 0, 4), a.jacobian()(0, 0, 4, 0)[2]
    (DM(2), DM(0.5))
    """
    return _function("dynamics", robot)


def inverse_dynamics(robot: Robot | Dynamics) -> Any:
    """Inverse dynamics (q, v, a) -> tau.

    Parameters
    ----------
    robot : Robot or Dynamics
        The robot, or dynamics of it in (q, v); it may have a singular mass matrix.

    Returns
    -------
    casadi.Function
        Its derivatives are those of `costate.Dynamics.rnea`.

    Examples
    --------
    >>> import costate, costate.casadi
    >>> robot = costate.Robot.builder("cart").prismatic("rail", axis=[1, 0, 0], mass=2).build()
    >>> costate.casadi.inverse_dynamics(robot)(0, 0, 2)
    DM(4)
    """
    return _function("inverse_dynamics", robot)


def step(
    robot: Robot | Dynamics,
    scheme: _Scheme,
    dt: float,
) -> Any:
    """One time step (x, tau) -> x_next under constant torques.

    Parameters
    ----------
    robot : Robot or Dynamics
        A robot, for x = (q, v), or dynamics with their coordinates: ``Dynamics(robot, "qp")`` for x = (q, p).
    scheme : {"rk4", "midpoint", "verlet", "semi_implicit_euler"}
        As in `costate.Step`.
    dt : float
        Duration (s).

    Returns
    -------
    casadi.Function
        Its derivatives are those of `costate.Step`: one call where a scheme that is written in CasADi calls the
        dynamics and their derivatives at every stage.

    Examples
    --------
    >>> import costate, costate.casadi
    >>> robot = costate.Robot.builder("cart").prismatic("rail", axis=[1, 0, 0], mass=2).build()
    >>> costate.casadi.step(robot, "rk4", 0.5)([0, 1], 4)  # 0.5 s at 2 m/s^2
    DM([0.75, 2])
    """
    if isinstance(robot, Dynamics):
        return _function("step", robot.robot, robot.coordinates, scheme, dt)
    return _function("step", robot, "qv", scheme, dt)


def frame(robot: Robot | Dynamics, name: str) -> Any:
    """Pose of a frame, q -> (R, x): orientation (3, 3) and position (3) in m, both in the world.

    Parameters
    ----------
    robot : Robot or Dynamics
        The robot, or dynamics of it in (q, v).
    name : str
        One of ``robot.frame_names``.

    Returns
    -------
    casadi.Function
        With exact first and second derivatives of both.

    Examples
    --------
    >>> import costate, costate.casadi
    >>> robot = costate.Robot.builder("arm").revolute("hinge", axis=[0, 1, 0], mass=1, com=[1, 0, 0]).build()
    >>> R, x = costate.casadi.frame(robot.add_frame("tip", "hinge", [2, 0, 0]), "tip")(0)
    >>> x
    DM([2, 0, 0])
    """
    return _function("frame", robot, "qv", name)


def twist(robot: Robot | Dynamics, name: str) -> Any:
    """Twist of a frame, (q, v) -> (omega, rate): its angular velocity (rad/s) and the velocity of its origin (m/s).

    Both have 3 entries, in axes of the world, as ``Frame.twist`` has by default. Use it for constraints on the velocity
    of a tool: ``jacobian(x, q) @ v`` of `frame` has the same values, but second derivatives of that are third
    derivatives of the pose, which do not exist.

    Parameters
    ----------
    robot : Robot or Dynamics
        The robot, or dynamics of it in (q, v).
    name : str
        One of ``robot.frame_names``.

    Returns
    -------
    casadi.Function
        With exact first and second derivatives of both.

    Examples
    --------
    >>> import costate, costate.casadi
    >>> robot = costate.Robot.builder("arm").revolute("hinge", axis=[0, 1, 0], mass=1, com=[1, 0, 0]).build()
    >>> costate.casadi.twist(robot.add_frame("tip", "hinge", [2, 0, 0]), "tip")(0, 3)
    (DM([0, 3, 0]), DM([0, 0, -6]))
    """
    return _function("twist", robot, "qv", name)


def centre_of_mass(robot: Robot | Dynamics) -> Any:
    """Centre of mass of the moved links, q -> c: its position (3) in the world (m).

    Parameters
    ----------
    robot : Robot or Dynamics
        The robot, or dynamics of it in (q, v).

    Returns
    -------
    casadi.Function
        With exact first and second derivatives.

    Examples
    --------
    >>> import costate, costate.casadi
    >>> robot = costate.Robot.builder("arm").revolute("hinge", axis=[0, 1, 0], mass=1, com=[1, 0, 0]).build()
    >>> costate.casadi.centre_of_mass(robot)(0)
    DM([1, 0, 0])
    """
    return _function("centre_of_mass", robot)


def source(
    robot: Robot | Dynamics,
    scheme: Literal["rk4", "semi_implicit_euler"] | None = None,
    dt: float = 0.0,
    *,
    limit: int = 25_000,
) -> str:
    """C source of the same functions, for ``casadi.external`` where costate is not installed.

    Parameters
    ----------
    robot : Robot or Dynamics
        The robot, or dynamics of it in (q, v), whose constants become numbers of the source.
    scheme : {"rk4", "semi_implicit_euler"}, optional
        Adds ``ROBOT_step`` of this scheme, for x = (q, v).
    dt : float
        Its duration (s).
    limit : int
        Most operations of a function.

    Returns
    -------
    str
        ``ROBOT_fd(q, v, tau) -> a`` and ``ROBOT_id(q, v, a) -> tau`` with Jacobian, adjoint and the Jacobian of
        that, ROBOT the name of the robot in small letters; derivatives of the Jacobian itself are in `dynamics` and
        its kin alone. Compile it with ``cc -O3 -shared -fPIC FILE.c -o FILE.so -lm``.

    Raises
    ------
    ArgumentError
        For an unknown scheme, and a limit that is negative or no whole number.
    CodegenError
        Where a function is longer than the limit.

    Examples
    --------
    >>> import costate, costate.casadi
    >>> robot = costate.Robot.builder("cart").prismatic("rail", axis=[1, 0, 0], mass=2).build()
    >>> "int jac_adj1_cart_fd(" in costate.casadi.source(robot)
    True
    """
    return codegen(robot_of(robot), abi="casadi", scheme=scheme, dt=float(dt), limit=limit)


def calls(function: Any) -> dict[str, int]:
    """How often CasADi has evaluated a function of this module and its derivatives, in this process.

    Parameters
    ----------
    function : casadi.Function
        What one of the functions above returned.

    Returns
    -------
    dict
        ``"f"``, its Jacobian ``"jac_f"``, its adjoint y'f_z ``"adj1_f"``, and the Jacobian of that with the contracted
        Hessian y'f_zz, ``"jac_adj1_f"``; and the Jacobian of the Jacobian, all of f_zz, ``"jac_jac_f"``.

    Examples
    --------
    >>> import costate, costate.casadi
    >>> robot = costate.Robot.builder("cart").prismatic("rail", axis=[1, 0, 0], mass=2).build()
    >>> a = costate.casadi.dynamics(robot)
    >>> _ = a(0, 0, 1), a(0, 0, 2), a.jacobian()(0, 0, 1, 0)
    >>> costate.casadi.calls(a)
    {'f': 2, 'jac_f': 1, 'adj1_f': 0, 'jac_adj1_f': 0, 'jac_jac_f': 0}
    """
    return dict(zip(("f", "jac_f", "adj1_f", "jac_adj1_f", "jac_jac_f"), _casadi_calls(function.name())))


def refusal(function: Any) -> str | None:
    """Why the last state was refused that CasADi gave to a function of this module or its derivatives.

    CasADi itself says ``Evaluation failed``.

    Parameters
    ----------
    function : casadi.Function
        What one of the functions above returned.

    Returns
    -------
    str or None
        The reason; None where no state was refused.

    Examples
    --------
    >>> import costate, costate.casadi
    >>> robot = costate.Robot.builder("cart").prismatic("rail", axis=[1, 0, 0], mass=2).build()
    >>> a = costate.casadi.dynamics(robot)
    >>> try:
    ...     _ = a(0, float("nan"), 0)
    ... except RuntimeError:
    ...     print("not finite" in costate.casadi.refusal(a))
    True
    """
    return _casadi_refusal(function.name())


def slots() -> tuple[int, int]:
    """How many functions CasADi refers to, and how many it can refer to at once.

    Examples
    --------
    >>> import costate.casadi
    >>> costate.casadi.slots()[1]
    64
    """
    return _casadi_slots()


def _function(kind: str, robot: Robot | Dynamics, coordinates: str = "qv", name: str = "", dt: float = 0.0) -> Any:
    try:
        import casadi
    except ImportError as error:
        raise ImportError("costate.casadi needs CasADi 3.6.7 or later: pip install casadi") from error
    given = (kind, robot_of(robot), coordinates, name, float(dt))
    # What a pickle of the function contains: CasADi passes it to the library of the process that reads it.
    text = base64.b64encode(pickle.dumps(given, 4)).decode()
    slot = _CasadiSlot(given, text)
    return casadi.external(slot.name, _costate.__file__, {"config_args": [text]})


def _read(text: str) -> Any:
    return pickle.loads(base64.b64decode(text))
