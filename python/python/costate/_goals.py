"""What tools shall do, set between two solves of one problem."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ._costate import _Resolve
from ._errors import whole
from ._tables import text_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


class Goals:
    """The part of `Resolve` that moves and turns tools."""

    _core: _Resolve
    # What was set last, for copies: the name of a method of the core and a key, then its arguments.
    _calls: dict[tuple[str, Any], tuple[Any, ...]]

    def _set(self, name: str, key: Any, *arguments: Any) -> None:
        getattr(self._core, name)(*arguments)
        self._calls[name, key] = arguments

    def _set_numbered(self, name: str, number: int, *arguments: Any) -> None:
        """Sets what an entry of a list of the problem is about."""
        number = whole("number", number, 0)
        self._set(name, number, number, *arguments)

    def _set_of_tool(self, name: str, of: str, number: int, *arguments: Any) -> None:
        """Sets what an entry of the tools of the start, the end or the cost is about."""
        number = whole("number", number, 0)
        self._set(name, (of, number), of, number, *arguments)

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
        self._set_of_tool("set_tool", "start", number, copied(xyz))

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
        self._set_of_tool("set_tool", "end", number, copied(xyz))

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
        self._set_of_tool("set_tool", "cost", number, copied(xyz))

    def set_start_orientation(self, number: int, table: Mapping[str, Any] | None = None, **keys: Any) -> None:
        """Turn a tool of the start; it stays an orientation of all axes, or of one.

        Parameters
        ----------
        number : int
            Which of ``start.tool``, from 0.
        table : dict, optional
            ``rpy`` (rad, fixed axes) or ``rotation`` (3, 3), from the tool to the world; or ``along``, the direction in
            the world that ``axis`` of the tool has, z unless given.
        **keys
            More of them.

        Raises
        ------
        ArgumentError
            For a tool that the problem has not, one without an orientation, and an orientation of the other kind.
        ProblemError
            With ``key``: for a wrong key.

        Examples
        --------
        >>> motion.set_start_orientation(0, rpy=[3.14, 0.0, 0.5])  # doctest: +SKIP
        """
        self._set_of_tool("set_orientation", "start", number, text_of({**(table or {}), **keys}))

    def set_end_orientation(self, number: int, table: Mapping[str, Any] | None = None, **keys: Any) -> None:
        """Turn a tool of the end, as `set_start_orientation`.

        Parameters
        ----------
        number : int
            Which of ``end.tool``, from 0.
        table : dict, optional
            As there.
        **keys
            More of them.

        Raises
        ------
        ArgumentError, ProblemError
            As there.
        """
        self._set_of_tool("set_orientation", "end", number, text_of({**(table or {}), **keys}))

    def set_tool_cost_orientation(self, number: int, table: Mapping[str, Any] | None = None, **keys: Any) -> None:
        """Turn the goal of a cost of a tool, as `set_start_orientation`.

        Parameters
        ----------
        number : int
            Which of ``[[cost.tool]]``, from 0.
        table : dict, optional
            As there.
        **keys
            More of them.

        Raises
        ------
        ArgumentError, ProblemError
            As there.
        """
        self._set_of_tool("set_orientation", "cost", number, text_of({**(table or {}), **keys}))


def copied(given: ArrayLike) -> Any:
    """The numbers of a vector; what is none is left to those who refuse it."""
    try:
        array = np.asarray(given)
    except (TypeError, ValueError):
        return given
    return array.astype(float).tolist() if array.ndim == 1 and array.dtype.kind in "iuf" else given
