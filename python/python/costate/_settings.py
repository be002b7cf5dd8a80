"""What is set between two solves of one problem."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ._errors import argument_error, whole
from ._goals import Goals, copied
from ._tables import text_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


class Settings(Goals):
    """The part of `Resolve` that changes the problem."""

    _joints: list[str]

    def set_start(self, q: ArrayLike, v: ArrayLike) -> None:
        """Start the next solve at another state; components that are free do not count.

        Parameters
        ----------
        q, v : array_like (n)
            Positions (rad, m) and rates (rad/s, m/s).

        Raises
        ------
        ArgumentError
            For numbers beyond their limits.
        """
        self._set("set_start", None, copied(q), copied(v))

    def set_end(self, q: ArrayLike, v: ArrayLike) -> None:
        """End the next solve at another state; components that are free do not count.

        Parameters
        ----------
        q, v : array_like (n)
            Positions (rad, m) and rates (rad/s, m/s).

        Raises
        ------
        ArgumentError
            For numbers beyond their limits.
        """
        self._set("set_end", None, copied(q), copied(v))

    def set_via(self, number: int, q: ArrayLike, v: ArrayLike) -> None:
        """Move a via; components that are free do not count.

        Parameters
        ----------
        number : int
            Which of ``[[via]]``, from 0.
        q, v : array_like (n)
            Positions (rad, m) and rates (rad/s, m/s).

        Raises
        ------
        ArgumentError
            For a via that the problem has not, and for numbers beyond their limits.
        """
        self._set_numbered("set_via", number, copied(q), copied(v))

    def set_start_acceleration(self, a: ArrayLike) -> None:
        """Start the next solve with other accelerations.

        Parameters
        ----------
        a : array_like (n)
            In rad/s^2, m/s^2.

        Raises
        ------
        ArgumentError
            Where the problem leaves them free.
        """
        self._set("set_acceleration", False, False, copied(a))

    def set_end_acceleration(self, a: ArrayLike) -> None:
        """End the next solve with other accelerations.

        Parameters
        ----------
        a : array_like (n)
            In rad/s^2, m/s^2.

        Raises
        ------
        ArgumentError
            Where the problem leaves them free.
        """
        self._set("set_acceleration", True, True, copied(a))

    def set_limit(self, limit: str, value: float, joint: str | int | None = None) -> None:
        """Keep another value of a limit that the problem has.

        Parameters
        ----------
        limit : {"q_min", "q_max", "v_max", "a_max", "torque_max", "power_max", "jerk_max", "torque_rate_max", \
                "total_power_max"}
            The limit.
        value : float
            In rad, m; in both directions in rad/s, m/s, rad/s^2, m/s^2, N m, N, W, rad/s^3, m/s^3, N m/s, N/s.
        joint : str or int, optional
            The joint, by name or from 0; none for ``"total_power_max"``.

        Raises
        ------
        ArgumentError
            For a joint or a limit that the problem has not, a torque limit that falls with the speed, a value that the
            limit cannot have, and a start or end that lies outside.
        """
        index = self._joint(joint)
        self._set("set_limit", (limit, index), limit, index, float(value))

    def _joint(self, joint: str | int | None) -> int | None:
        """The number of a joint."""
        if joint is None:
            return None
        if not isinstance(joint, str):
            return whole("joint", joint, 0)
        if joint not in self._joints:
            raise argument_error("joint", f"there is no joint '{joint}'; the joints are {', '.join(self._joints)}")
        return self._joints.index(joint)

    def set_obstacle(self, number: int, table: Mapping[str, Any] | None = None, **keys: Any) -> None:
        """Move an obstacle.

        Parameters
        ----------
        number : int
            Which of ``[[obstacle]]``, from 0.
        table : dict, optional
            Its keys, of the same kind and size.
        **keys
            More of them.

        Raises
        ------
        ArgumentError
            For an obstacle that the problem has not, or one of another kind or size.
        ProblemError
            With ``key``: for a wrong key.

        Examples
        --------
        >>> motion.set_obstacle(0, kind="sphere", xyz=[0.4, 0.1, 0.3], radius=0.1)  # doctest: +SKIP
        """
        self._set_numbered("set_obstacle", number, text_of({**(table or {}), **keys}))

    def set_reference(self, number: int, table: Mapping[str, Any] | None = None, **keys: Any) -> None:
        """Replace a reference.

        Parameters
        ----------
        number : int
            Which of ``[[cost.reference]]``, from 0.
        table : dict, optional
            Its keys, of the same joints or tool.
        **keys
            More of them.

        Raises
        ------
        ArgumentError
            For a reference that the problem has not, or one of other joints.
        ProblemError
            With ``key``: for a wrong key.
        """
        self._set_numbered("set_reference", number, text_of({**(table or {}), **keys}))

    def set_start_time(self, time: float) -> None:
        """Start the next solve at another time of all references.

        Parameters
        ----------
        time : float
            In s.

        Raises
        ------
        ArgumentError
            For a time that is not finite.
        """
        self._set("set_start_time", None, time)
