"""The motion of a solution: its nodes, samples, feedback and derivatives of its cost."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ._errors import ArgumentError, MotionError
from ._figures import Figures
from ._samples import Gains, Samples, Sensitivity, fixed

if TYPE_CHECKING:
    from numpy.typing import NDArray

    _Array = NDArray[np.float64]


class Motion(Figures):
    """The part of `Solution` with the motion."""

    @cached_property
    def t(self) -> _Array:
        """Times of the nodes (N), s."""
        return fixed(self._core.array("t"))

    @cached_property
    def q(self) -> _Array:
        """Positions (N, n), rad or m; with floating and spherical joints (N, nq), quaternions of length 1."""
        return fixed(self._core.array("q"))

    @cached_property
    def v(self) -> _Array:
        """Rates (N, n); of floating and spherical joints in the axes of the moved frame."""
        return fixed(self._core.array("v"))

    @cached_property
    def p(self) -> _Array:
        """Momenta p = M v (N, n)."""
        return fixed(self._core.array("p"))

    @cached_property
    def u(self) -> _Array:
        """Controls (N, n), before the gain."""
        return fixed(self._core.array("u"))

    @cached_property
    def tau(self) -> _Array:
        """Torques and forces at the joints (N, n), N m or N."""
        return fixed(self.u * self._core.gain())

    @cached_property
    def a(self) -> _Array:
        """Accelerations (N, n), of the polynomials of the direct method, else by forward dynamics."""
        return fixed(self._core.accelerations())

    @cached_property
    def costates(self) -> _Array:
        """Costates y = (y_q, y_p) of (q, p) (N, 2n); y(0) = -dJ/dx(0), by d in q (+) d with quaternions."""
        return fixed(np.hstack([self._core.array("y_q"), self._core.array("y_p")]))

    @cached_property
    def hamiltonian(self) -> _Array:
        """H* at the nodes (N); empty for a motion that was read from a file."""
        return fixed(self._core.array("hamiltonian"))

    def sample(self, rate: float | None = None, *, times: Any = None) -> Samples:
        """The motion at a fixed rate, or at given times.

        Motions of the direct method are sampled from their polynomials, with torques of inverse dynamics cut to their
        limits; at a switch a sample is that of the arc that begins.

        Parameters
        ----------
        rate : float
            Samples in a second (Hz): at k/rate, and at T, the last one.
        times : array
            Times (s) between 0 and T, instead. Others are refused, where `Resolve.state` gives the states of the ends.

        Returns
        -------
        Samples
            One row for each time.

        Raises
        ------
        ArgumentError
            For a rate that is not positive, or a time that is not on the motion.
        MotionError
            Where there is no motion.
        """
        if (rate is None) == (times is None):
            error = ArgumentError("give either rate or times")
            error.argument = "rate"
            raise error
        core = self._core.sample(float(rate)) if rate is not None else self._core.sample_at(times)
        return Samples(core, self._problem.robot.joint_names)

    def feedback(self, rate: float | None = None) -> Gains:
        """The gains of the optimal feedback, and derivatives by limits.

        The problem is solved once more, on the mesh of the motion or on equal intervals, then on a finer mesh.

        Parameters
        ----------
        rate : float, optional
            In a second (Hz); at the points of the motion unless given.

        Returns
        -------
        Gains
            Gains over time.

        Raises
        ------
        ProblemError
            For a problem that it is not computed for.
        MotionError
            Where the motion is infeasible or no strict minimum.

        References
        ----------
        A. E. Bryson, Y.-C. Ho, Applied Optimal Control, 1975, section 6.4.
        """
        if self._core.status in ("infeasible", "locally_infeasible"):
            raise MotionError(f"an infeasible motion has no feedback: {self._core.message}")
        return Gains(self._core.gains_json(rate))

    def sensitivities(self) -> dict[str, Sensitivity]:
        """dJ/dtheta for masses, inertias, lengths and all other numbers of the robot; nothing is solved again.

        Returns
        -------
        dict of Sensitivity
            By names such as ``"elbow.mass"``.

        Raises
        ------
        MotionError
            For a motion that is not optimal, a step of a gait, or where given ends hold with this robot alone.
        """
        return {row[0]: Sensitivity._make(row) for row in self._core.sensitivities()}
