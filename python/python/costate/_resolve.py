"""A problem that is solved again and again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ._costate import _Feedback, _Resolve
from ._problem import Problem
from ._solution import Solution
from ._tables import text_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    _Array = NDArray[np.float64]
    _Vector = Sequence[float] | _Array


class Resolved(NamedTuple):
    """What solving again gave: figures of the motion that is shown.

    Attributes
    ----------
    status : str
        "solved" to the tolerance; else "iterations" or "out_of_time" where the budget was used up, or "no_progress".
        The motion is then the cheapest iterate that keeps all limits, or the one that exceeds them least.
    iterations : int
        Newton steps.
    cost : float
        J.
    gap : float
        What barriers cost at most.
    violation : float
        Largest violation of a limit at the points, in parts of its range.
    keeps_limits : bool
        Whether that is at most 1e-7.
    seconds : float
        How long it took.
    """

    status: str
    iterations: int
    cost: float
    gap: float
    violation: float
    keeps_limits: bool
    seconds: float


class Feedback:
    """Derivatives of an optimal motion by its ends: neighbouring optimal feedback.

    x = (q, v) has m = 2n entries, with continuous accelerations x = (q, v, a) has m = 3n; points are those of the mesh.
    A motion that starts at x_0 + dx_0 has at the same part of the time of its phase the state x + states_by_start dx_0
    and the torques tau + torques_by_start dx_0.

    Attributes
    ----------
    t : array (P)
        Times of the points (s).
    states_by_start, states_by_end : array (P, m, m)
        Derivatives of x.
    torques_by_start, torques_by_end : array (P, n, m)
        Derivatives of the torques.
    final_time_by_start, final_time_by_end : array (m)
        Derivatives of T; zero where it is fixed.
    cost_gradient : array (m)
        dJ/dx_0.
    cost_hessian : array (m, m)
        Second derivatives of the least cost by the start.
    """

    def __init__(self, core: _Feedback) -> None:
        self._core = core
        self.t: _Array = core.array("t")
        self.states_by_start: _Array = core.array("states_by_start")
        self.states_by_end: _Array = core.array("states_by_end")
        self.torques_by_start: _Array = core.array("torques_by_start")
        self.torques_by_end: _Array = core.array("torques_by_end")
        self.final_time_by_start: _Array = core.array("final_time_by_start")
        self.final_time_by_end: _Array = core.array("final_time_by_end")
        self.cost_gradient: _Array = core.array("cost_gradient")
        self.cost_hessian: _Array = core.array("cost_hessian")[0]

    def gain(self, t: float | _Vector) -> _Array | None:
        """K at times t (s): dtau = K dx, (n, m), or (N, n, m) for N times. None with continuous accelerations.

        Gains grow without bound towards given ends and vias; those
        of 98 % of the time of a phase are held.
        """
        found = self._core.gain(np.atleast_1d(np.asarray(t, float)))
        return None if found is None else found[0] if np.ndim(t) == 0 else found


class MotionDerivative(NamedTuple):
    """Derivatives of a motion by one of its numbers, at the points of `Feedback`.

    Attributes
    ----------
    cost, final_time : float
        dJ/dtheta and dT/dtheta.
    states : array (P, m)
        Derivatives of (q, v), with continuous accelerations (q, v, a), at the same part of the time of a phase.
    torques : array (P, n)
        Derivatives of the torques.
    """

    cost: float
    final_time: float
    states: _Array
    torques: _Array


class Resolve:
    """A problem that is solved again and again on one mesh, as a controller needs it.

    The mesh has (nodes - 1)/3 equal intervals. Each solve begins at the motion that is optimal for the new ends to
    first order. The limits of the robot are kept unless the problem says otherwise.

    Several threads may use one object: calls wait for each other, without the interpreter's lock, and the motion is
    that of the last solve. A thread with motions of its own needs its own object. Ctrl-C is handled after a solve;
    bound the first one by ``time_limit``.

    Parameters
    ----------
    problem : Problem
        The problem.
    near : Solution, optional
        Begins at this motion, on its mesh.
    **options
        ``nodes``, ``tolerance``, ``machine_code`` and other options of ``[solver]``. ``machine_code="at_once"`` is best
        for many solves.

    Raises
    ------
    ProblemError
        With ``key``: a problem that cannot be solved again, or an option that is refused.

    Examples
    --------
    >>> import costate
    >>> builder = costate.Robot.builder("cart", gravity=[0, 0, 0])
    >>> robot = builder.prismatic("rail", axis=[1, 0, 0], mass=2).build()
    >>> motion = costate.Resolve(costate.Problem(robot, start=[0.0], end=[1.0], time=1.0, cost=[1.0]))
    >>> motion.solve().status
    'solved'
    >>> motion.set_start([0.5], [0.0])
    >>> round(motion.solve(steps=5).cost, 6)
    6.0
    >>> q, v, a = motion.state(0.5)
    >>> q.round(6).tolist()
    [0.75]
    """

    def __init__(self, problem: Problem, *, near: Solution | None = None, **options: Any) -> None:
        self._problem = problem
        self._core: _Resolve = problem._core.resolve(text_of(options), None if near is None else near._core)
        self._n = problem.robot.n

    @property
    def problem(self) -> Problem:
        """The problem as it was at first."""
        return self._problem

    def set_start(self, q: _Vector, v: _Vector) -> None:
        """Start the next solve at these positions and rates (n); those that are free do not count.

        Raises `ArgumentError` for numbers beyond their limits.
        """
        self._core.set_start(q, v)

    def set_end(self, q: _Vector, v: _Vector) -> None:
        """End the next solve at these positions and rates (n)."""
        self._core.set_end(q, v)

    def set_via(self, number: int, q: _Vector, v: _Vector) -> None:
        """Move a via (from 0) to these positions and rates (n); those that are free do not count."""
        self._core.set_via(number, q, v)

    def set_start_acceleration(self, a: _Vector) -> None:
        """Start the next solve with these accelerations (n), where the problem gives them."""
        self._core.set_acceleration(False, a)

    def set_end_acceleration(self, a: _Vector) -> None:
        """End the next solve with these accelerations (n), where the problem gives them."""
        self._core.set_acceleration(True, a)

    def set_start_tool(self, number: int, xyz: _Vector) -> None:
        """Move a tool of the start (from 0) to this position (m); coordinates that are free stay so."""
        self._core.set_tool("start", number, xyz)

    def set_end_tool(self, number: int, xyz: _Vector) -> None:
        """Move a tool of the end (from 0) to this position (m)."""
        self._core.set_tool("end", number, xyz)

    def set_tool_cost(self, number: int, xyz: _Vector) -> None:
        """Move the goal of ``[[cost.tool]]`` (from 0) to this position (m)."""
        self._core.set_tool("cost", number, xyz)

    def set_obstacle(self, number: int, table: Mapping[str, Any] | None = None, **keys: Any) -> None:
        """Move an obstacle (from 0): the keys of ``[[obstacle]]``, of the same kind and size.

        >>> motion.set_obstacle(0, kind="sphere", xyz=[0.4, 0.1, 0.3], radius=0.1)  # doctest: +SKIP
        """
        self._core.set_obstacle(number, text_of({**(table or {}), **keys}))

    def set_reference(self, number: int, table: Mapping[str, Any] | None = None, **keys: Any) -> None:
        """Replace a reference (from 0): the keys of ``[[cost.reference]]``, of the same joints or tool."""
        self._core.set_reference(number, text_of({**(table or {}), **keys}))

    def set_start_time(self, time: float) -> None:
        """Start the next solve at this time (s) of all references."""
        self._core.set_start_time(time)

    def advance(self, dt: float) -> None:
        """Begin the next solve at the motion of the last one from ``dt`` (s) on; vias stay on the clock."""
        self._core.advance(dt)

    def solve(self, *, steps: int | None = None, seconds: float | None = None) -> Resolved:
        """Solve with what was set since the last time.

        Parameters
        ----------
        steps : int, optional
            Most Newton steps.
        seconds : float, optional
            Longest time; no step begins that would probably exceed it.

        Without both the limits of the options hold.

        Raises
        ------
        StateError
            Where the motion cannot be evaluated.
        """
        return Resolved._make(self._core.solve(steps, seconds))

    @property
    def final_time(self) -> float:
        """T (s); 0 before the first solve."""
        return self._core.final_time()

    def state(self, t: float | _Vector) -> tuple[_Array, _Array, _Array]:
        """q, v and a at times t (s): (n) each, or (N, n) for N times; those of the ends beyond them."""
        rows = self._core.states(np.atleast_1d(np.asarray(t, float)))
        rows = rows[0] if np.ndim(t) == 0 else rows
        return rows[..., : self._n], rows[..., self._n : 2 * self._n], rows[..., 2 * self._n :]

    def torques(self, t: float | _Vector) -> _Array:
        """Torques at times t (s), cut to their limits: (n), or (N, n) for N times."""
        rows = self._core.torques(np.atleast_1d(np.asarray(t, float)))
        return rows[0] if np.ndim(t) == 0 else rows

    def feedback(self) -> Feedback | None:
        """Derivatives of the motion by its ends; None where it is no strict minimum, or before it is solved."""
        found = self._core.feedback()
        return None if found is None else Feedback(found)

    def derivative_by(self, limit: str, joint: str | int) -> MotionDerivative | None:
        """Derivatives by a limit of a joint, from the factors of the last Newton step.

        Parameters
        ----------
        limit : {"q_min", "q_max", "v_max", "a_max", "torque_max", "power_max", "jerk_max", "torque_rate_max"}
            The limit.
        joint : str or int
            The joint, by name or from 0.
        """
        names = self._problem.robot.joint_names
        if isinstance(joint, str) and joint not in names:
            raise _unknown(joint, names)
        index = names.index(joint) if isinstance(joint, str) else joint
        found = self._core.derivative_by_limit(limit, index)
        return None if found is None else MotionDerivative._make(found)

    def derivative_by_mass(
        self, frame: str, mass: float, com: _Vector = (0.0, 0.0, 0.0), inertia: _Vector = (0.0,) * 6
    ) -> MotionDerivative | None:
        """Derivatives by the mass (kg) of a body on a frame, with its centre (m) and its inertia xx, yy, zz, xy, xz, yz."""
        found = self._core.derivative_by_mass(frame, mass, list(com), list(inertia))
        return None if found is None else MotionDerivative._make(found)

    def __repr__(self) -> str:
        return f"Resolve({self._problem!r}, T={self.final_time:.6g} s)"


def _unknown(joint: str, names: list[str]) -> Exception:
    from ._errors import ArgumentError

    error = ArgumentError(f"there is no joint '{joint}'; the joints are {', '.join(names)}")
    error.argument = "joint"
    return error
