"""Solutions while a parameter changes."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from ._costate import _Solution
from ._solution import Solution

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ._problem import Problem

    _Array = NDArray[np.float64]


class Branch:
    """Solutions of a problem while one of its parameters changes.

    Attributes
    ----------
    end : str
        How it ended: "reached"; "turned_back" beyond a turning point, "stuck", "too_many_points", "not_started",
        "interrupted".
    parameter, cost, penalty_cost, final_time, hamiltonian : array (N)
        The parameter at each point, J, the integral of the penalties, T (s) and the mean of H*.
    turning_points : list of dict
        ``parameter``, ``cost``, ``final_time`` where the branch turns back, and ``after`` how many points.
    solution : Solution
        The last one.
    """

    def __init__(self, end: str, points: list[dict[str, Any]], turning_points: list[dict[str, Any]]) -> None:
        self.end = end
        self.turning_points = turning_points
        columns = ("parameter", "cost", "penalty_cost", "final_time", "hamiltonian")
        self.parameter, self.cost, self.penalty_cost, self.final_time, self.hamiltonian = (
            np.array([point[name] for point in points], dtype=float) for name in columns
        )
        self.solution: Solution

    @classmethod
    def _of(cls, found: Any, core: _Solution, problem: Problem, parameter: str, first: float) -> Branch:
        branch = cls(*map(json.loads, found))
        last = branch.parameter[-1] if len(branch.parameter) else first
        posed = problem if parameter == "smoothing" else problem.with_parameter(parameter, float(last))
        branch.solution = Solution._of(posed._core.adopt(core), posed)
        return branch

    @property
    def reached(self) -> bool:
        """Whether the last value was reached."""
        return self.end == "reached"

    def __len__(self) -> int:
        return len(self.parameter)

    def __repr__(self) -> str:
        return f"Branch({self.end!r}, {len(self)} points)"
