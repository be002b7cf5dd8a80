"""Derivatives of a motion that was solved by the numbers of its problem."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ._errors import whole
from ._feedback import MotionDerivative
from ._goals import copied
from ._settings import Settings

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


class Derivatives(Settings):
    """The part of `Resolve` that tells how cost, time, states and torques change with limits, tasks and masses."""

    def derivative_by(self, limit: str, joint: str | int | None = None) -> MotionDerivative | None:
        """Derivatives by a limit of a joint, or of all, from the factors of the last Newton step.

        Parameters
        ----------
        limit : {"q_min", "q_max", "v_max", "a_max", "torque_max", "power_max", "jerk_max", "torque_rate_max", \
                "corner_speed", "no_load_speed", "total_power_max"}
            The limit.
        joint : str or int, optional
            The joint, by name or from 0; none for ``"total_power_max"``.

        Returns
        -------
        MotionDerivative or None
            None where the motion is no strict minimum.

        Raises
        ------
        ArgumentError
            For a joint or a limit that the problem has not.
        """
        found = self._core.derivative_by_limit(limit, self._joint(joint))
        return None if found is None else MotionDerivative._make(found)

    def derivative_by_task(self, table: str, entry: int = 0) -> MotionDerivative | None:
        """Derivatives by a number of the task.

        Parameters
        ----------
        table : {"keep", "obstacle", "margin"}
            What ``keep[entry]`` allows at most (m, rad, m/s, m/s^2), the radius of ``obstacles[entry]`` (m), or the
            distance that bodies keep (m).
        entry : int
            Counted from 0; it does not count for the margin.

        Returns
        -------
        MotionDerivative or None
            None where the motion is no strict minimum, or before it is solved.

        Raises
        ------
        ArgumentError
            For an entry that the problem has not, a box, or an equation.
        """
        found = self._core.derivative_by_task(table, whole("entry", entry, 0))
        return None if found is None else MotionDerivative._make(found)

    def derivative_by_mass(
        self, frame: str, mass: float, com: ArrayLike = (0.0, 0.0, 0.0), inertia: ArrayLike = (0.0,) * 6
    ) -> MotionDerivative | None:
        """Derivatives by the mass of a body on a frame, whose inertia grows with it.

        Parameters
        ----------
        frame : str
            One of ``robot.frame_names``.
        mass : float
            In kg.
        com : array_like (3)
            Its centre of mass in the frame (m).
        inertia : array_like (6)
            xx, yy, zz, xy, xz, yz about the centre of mass (kg m^2).

        Returns
        -------
        MotionDerivative or None
            None where the motion is no strict minimum.

        Raises
        ------
        ArgumentError
            For a frame that the robot has not, or a body that cannot be.
        """
        found = self._core.derivative_by_mass(frame, mass, copied(com), copied(inertia))
        return None if found is None else MotionDerivative._make(found)
