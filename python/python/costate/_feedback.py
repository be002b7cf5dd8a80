"""What solving again gives."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ._costate import _Feedback
from ._errors import argument_error

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    _Array = NDArray[np.float64]


class Resolved(NamedTuple):
    """What solving again gave: figures of the motion that is shown.

    Attributes
    ----------
    status : str
        "solved" to the tolerance; else "iterations" or "out_of_time" where the budget was used up, "cancelled" after
        Ctrl-C, or "no_progress". The motion is then the cheapest iterate that keeps all limits, or the one that exceeds
        them least.
    iterations : int
        Newton steps.
    cost : float
        J.
    gap : float
        What barriers cost at most.
    violation : float
        Largest violation of a limit, a tool or a clearance at the points, in parts of its range.
    clearance_violation : float
        Largest violation of a clearance between the points, in parts of the sum of the radii and the margin.
    keeps_limits : bool
        Whether the first is at most 1e-7, and the second 1e-2.
    seconds : float
        How long it took.
    """

    status: str
    iterations: int
    cost: float
    gap: float
    violation: float
    clearance_violation: float
    keeps_limits: bool
    seconds: float


class Feedback:
    """Derivatives of an optimal motion by its ends: neighbouring optimal feedback.

    x = (q, v) has m = 2n entries, with continuous accelerations x = (q, v, a) has m = 3n; points are those of the mesh. A
    motion that starts at x_0 + dx_0 has at the same part of the time of its phase the state x + states_by_start dx_0 and
    the torques tau + torques_by_start dx_0. Feedbacks with equal numbers are equal. A. E. Bryson, Y.-C. Ho, Applied Optimal Control, 1975, section 6.4.

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

    def gain(self, t: ArrayLike) -> _Array | None:
        """The gain K of dtau = K dx; with continuous accelerations that of the jerk, da/dt = jerk + K dx.

        With continuous accelerations there are gains where the jerk, or the rate of the torque, of each joint costs
        something and all later times are given. Gains grow without bound towards given ends and vias; those of 98 % of the time of a phase are held.

        Parameters
        ----------
        t : float or array_like (N)
            Times (s).

        Returns
        -------
        ndarray (n, m) or (N, n, m), or None
            In N m/rad, N m s/rad, N/m, N s/m; of jerks in 1/s^3, 1/s^2, 1/s. None where there is no gain.

        Raises
        ------
        ArgumentError
            For a time that is not finite.
        """
        times = np.atleast_1d(np.asarray(t, float))
        if not np.isfinite(times).all():
            raise argument_error("t", "t is not finite; give seconds since the start")
        found = self._core.gain(times)
        return None if found is None else found[0] if np.ndim(t) == 0 else found

    @classmethod
    def _of(cls, n: int, numbers: _Array) -> Feedback:
        return cls(_Feedback.of(n, numbers))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Feedback):
            return NotImplemented
        return np.array_equal(self._core.numbers(), other._core.numbers(), equal_nan=True)

    def __reduce__(self) -> tuple[Any, ...]:
        return (Feedback._of, (self._core.n, self._core.numbers()))

    def __repr__(self) -> str:
        return f"Feedback({len(self.t)} points, n={self._core.n})"


class MotionDerivative(NamedTuple):
    """Derivatives of a motion by one of its numbers, at the points of `Feedback`.

    Attributes
    ----------
    cost, final_time : float
        dJ/dtheta and dT/dtheta.
    states : array (P, m)
        Derivatives of x at the same part of the time, with x and m as there.
    torques : array (P, n)
        Derivatives of the torques.
    """

    cost: float
    final_time: float
    states: _Array
    torques: _Array
