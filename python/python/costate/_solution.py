"""Solutions of problems."""

from __future__ import annotations

from os import PathLike, fspath
from pathlib import Path as _Path
from typing import TYPE_CHECKING, Any

from . import _show
from ._costate import _Solution
from ._errors import MotionError
from ._files import Files

if TYPE_CHECKING:
    from ._problem import Problem


class Solution(Files):
    """What solving a `Problem` gave; the best motion found unless ``solved``.

    Rows of arrays are the nodes of the motion, columns joints. At a switch, a via or a node of the direct method two
    rows have the same time, on both sides of a jump. Arrays are made once and cannot be written to.
    """

    @classmethod
    def _of(cls, core: _Solution, problem: Problem) -> Solution:
        solution = cls.__new__(cls)
        solution._core, solution._problem = core, problem
        return solution

    @classmethod
    def _read(cls, problem: Problem, text: str, seconds: float) -> Solution:
        return cls._of(problem._core.solution(text, True, seconds), problem)

    @classmethod
    def from_json(cls, text: str, problem: Problem) -> Solution:
        """Read what `to_json` or ``costate optimize --save`` wrote.

        Between the nodes q is then the cubic through positions and rates; iterations and estimated errors are not in
        the text. Pickles lose nothing.

        Parameters
        ----------
        text : str
            The JSON.
        problem : Problem
            The problem that it solves.

        Returns
        -------
        Solution
            The solution.

        Raises
        ------
        MotionError
            For another text, or a motion of another robot.
        """
        return cls._of(problem._core.solution(text, False, float("nan")), problem)

    @classmethod
    def load(cls, path: str | PathLike[str], problem: Problem) -> Solution:
        """Read a file that `save` wrote, as `from_json`.

        Parameters
        ----------
        path : path
            The file.
        problem : Problem
            The problem that it solves.

        Returns
        -------
        Solution
            The solution.

        Raises
        ------
        MotionError
            For another text, or a motion of another robot; with the name of the file.
        OSError
            Where the file cannot be read.
        """
        try:
            return cls.from_json(_Path(path).read_text(encoding="utf-8"), problem)
        except (MotionError, UnicodeDecodeError) as error:
            raise MotionError(f"{fspath(path)}: {error}") from None

    def __repr__(self) -> str:
        return f"Solution({self.status!r}, cost={self.cost:.9g}, T={self.final_time:.6g} s, {len(self.t)} nodes)"

    def __str__(self) -> str:
        return _show.text(self)

    def _repr_html_(self) -> str:
        return _show.html(self)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Solution):
            return NotImplemented
        return self._problem == other._problem and self._core.complete() == other._core.complete()

    def __hash__(self) -> int:
        return hash((self._problem, self.status, len(self.t)))

    def __reduce__(self) -> tuple[Any, ...]:
        return (Solution._read, (self._problem, self._core.complete(), self.seconds))
