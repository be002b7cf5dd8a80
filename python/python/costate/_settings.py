"""What is set between two solves of one problem."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ._costate import _Resolve
from ._tables import text_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


class Settings:
    """The part of `Resolve` that changes the problem."""

    _core: _Resolve
    # What was set last, for copies: the name of a method of the core and a key, then its arguments.
    _calls: dict[tuple[str, Any], tuple[Any, ...]]

    def _set(self, name: str, key: Any, *arguments: Any) -> None:
        getattr(self._core, name)(*arguments)
        self._calls[name, key] = arguments

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
        self._set("set_via", number, number, copied(q), copied(v))

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

    def set_start_tool(self, number: int, xyz: ArrayLike) -> None:
        """Move a tool of the start; coordinates that are free stay so.

        Parameters
        ----------
        number : int
            Which of ``start.tool``, from 0.
        xyz : array_like (3)
            Its position in the world (m).

        Raises
        ------
        ArgumentError
            For a tool that the problem has not.
        """
        self._set("set_tool", ("start", number), "start", number, copied(xyz))

    def set_end_tool(self, number: int, xyz: ArrayLike) -> None:
        """Move a tool of the end; coordinates that are free stay so.

        Parameters
        ----------
        number : int
            Which of ``end.tool``, from 0.
        xyz : array_like (3)
            Its position in the world (m).

        Raises
        ------
        ArgumentError
            For a tool that the problem has not.
        """
        self._set("set_tool", ("end", number), "end", number, copied(xyz))

    def set_tool_cost(self, number: int, xyz: ArrayLike) -> None:
        """Move the goal of a cost of a tool.

        Parameters
        ----------
        number : int
            Which of ``[[cost.tool]]``, from 0.
        xyz : array_like (3)
            Its position in the world (m).

        Raises
        ------
        ArgumentError
            For a cost that the problem has not.
        """
        self._set("set_tool", ("cost", number), "cost", number, copied(xyz))

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
        self._set("set_obstacle", number, number, text_of({**(table or {}), **keys}))

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
        self._set("set_reference", number, number, text_of({**(table or {}), **keys}))

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


def copied(given: ArrayLike) -> Any:
    """The numbers of a vector; what is none is left to those who refuse it."""
    try:
        array = np.asarray(given, dtype=float)
    except (TypeError, ValueError):
        return given
    return array.tolist() if array.ndim == 1 else given
