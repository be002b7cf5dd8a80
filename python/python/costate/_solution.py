"""Solutions of problems: figures, arrays, files, pictures."""

from __future__ import annotations

import json
import warnings
from functools import cached_property
from os import PathLike, fspath
from pathlib import Path as _Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _show
from ._costate import _Solution
from ._errors import ArgumentError, MotionError
from ._run import Iteration
from ._samples import Gains, Samples, Sensitivity

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from ._problem import Problem

    _Array = NDArray[np.float64]


class Solution:
    """What solving a `Problem` gave; the best motion found unless ``solved``.

    Rows of arrays are the nodes of the motion, columns joints. At a switch, a via or a node of the direct method two
    rows have the same time, on both sides of a jump. Arrays are made once and cannot be written to.
    """

    _core: _Solution
    _problem: Problem

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

        Raises
        ------
        MotionError
            For another text, or a motion of another robot.
        """
        return cls._of(problem._core.solution(text, False, float("nan")), problem)

    @classmethod
    def load(cls, path: str | PathLike[str], problem: Problem) -> Solution:
        """Read a file that `save` wrote, as `from_json`."""
        return cls.from_json(_Path(path).read_text(encoding="utf-8"), problem)

    # How it ended.

    @property
    def problem(self) -> Problem:
        """The problem."""
        return self._problem

    @property
    def status(self) -> str:
        """How it ended: ``"converged"``, ``"infeasible"``, ``"time_limit"``, ...; see ``docs/optimize.md``."""
        return self._core.status

    @property
    def message(self) -> str:
        """The status in words, with what to do."""
        return self._core.message

    @property
    def solved(self) -> bool:
        """Whether the motion is a solution, of the problem or of its smoothed form."""
        return self._core.solved

    @property
    def converged(self) -> bool:
        """Whether all checks hold: the status is ``"converged"``."""
        return self.status == "converged"

    def check(self) -> Solution:
        """This solution; a `MotionError` with its message unless it is ``solved``."""
        if not self.solved:
            raise MotionError(f"{self.status}: {self.message}")
        return self

    # Figures.

    @cached_property
    def _figures(self) -> dict[str, Any]:
        figures: dict[str, Any] = json.loads(self._core.figures_json())
        return figures

    def _number(self, key: str) -> float:
        value = self._figures.get(key)
        return float("nan") if value is None else float(value)

    @property
    def cost(self) -> float:
        """J, without penalties; infinite where there is no motion."""
        return self._core.cost

    @property
    def penalty_cost(self) -> float:
        """The integral of the penalties."""
        return self._number("penalty_cost")

    @property
    def final_time(self) -> float:
        """T (s)."""
        return self._core.final_time

    @property
    def seconds(self) -> float:
        """How long solving took (s); not a number for a solution that was read from a file."""
        return self._core.seconds

    @property
    def verification(self) -> str:
        """How the motion was verified: "full", "factors" or "none"."""
        return str(self._figures["verification"])

    @property
    def end_defect(self) -> float:
        """Largest miss at the end when the motion is integrated again (rad, m, rad/s, m/s); NaN unless it was."""
        return self._number("end_defect")

    @property
    def shooting_defect(self) -> float:
        """Largest relative miss of segments with their costates; NaN unless they were integrated again."""
        return self._number("shooting_defect")

    @property
    def hamiltonian_mean(self) -> float:
        """Mean of H*; dJ/dT = -H*."""
        return self._number("hamiltonian")

    @property
    def hamiltonian_drift(self) -> float:
        """Largest deviation from the mean, relative to the largest sum of magnitudes in y'f - l."""
        return self._number("hamiltonian_drift")

    @property
    def certificate(self) -> str:
        """What the second variation shows: "local_minimum", "not_minimal" or "not_checked"."""
        return str(self._figures["certificate"])

    @property
    def conjugate_time(self) -> float | None:
        """The first conjugate time (s), if there is one."""
        time: float | None = self._figures["conjugate_time"]
        return time

    @property
    def switches(self) -> list[float]:
        """Times (s) at which a control reaches or leaves a bound."""
        switches: list[float] = self._figures["switches"]
        return switches

    @property
    def via_times(self) -> list[float]:
        """Times of the vias (s)."""
        return list(self._figures.get("via_times", []))

    @property
    def limits(self) -> dict[str, Any]:
        """How the motion uses its limits, by "position", "rate", "acceleration", "torque", "jerk", "torque_rate", "power",
        "torque_speed" and "task", where they are limited.

        Each holds the largest violation ``at_points`` and ``between`` them, the ``worst`` one (``joint``, ``time``,
        ``excess``, ``unit``, ``value``, ``limit``), and the spans ``active`` (``joint``, ``side``, ``from``, ``to``).
        """
        return {kind: use for kind, use in self._figures.get("limits", {}).items() if kind != "infeasible"}

    @property
    def infeasible(self) -> dict[str, Any] | None:
        """With the status "infeasible": the ``limits`` that would have to give (``kind``, ``joint``, ``side``, ``time``,
        ``amount``, ``unit``, ``limit``), a ``final_time`` with which a motion was found, the ``least_time``, and whether
        it is proven (``is_global``).
        """
        found: dict[str, Any] | None = self._figures.get("limits", {}).get("infeasible")
        return found

    @property
    def polish(self) -> dict[str, Any] | None:
        """Whether the motion is that of the direct method or its polished form: ``outcome``, ``cause``, ..."""
        found: dict[str, Any] | None = self._figures.get("polish")
        return found

    @property
    def starts(self) -> list[dict[str, Any]]:
        """``total`` cost and ``status`` of each start."""
        starts: list[dict[str, Any]] = self._figures["starts"]
        return starts

    @property
    def newton_iterations(self) -> int:
        """Newton steps, over all meshes and starts."""
        return int(self._figures["newton_iterations"])

    @cached_property
    def iterations(self) -> list[Iteration]:
        """The Newton steps."""
        return [Iteration._make(step) for step in self._core.iterations()]

    @cached_property
    def errors(self) -> _Array:
        """Estimated errors: of the cost, relative to it; of an extremal of each component of z = (q, p, y_q, y_p)."""
        return _fixed(self._core.errors())

    @property
    def stage_times(self) -> dict[str, float] | None:
        """Seconds of the stages of the direct method, with ``stage_times=True``."""
        found = self._core.stage_times()
        return None if found is None else dict(found)

    @property
    def warnings(self) -> list[str]:
        """Limits of the robot that the motion exceeds because it was not asked to keep them."""
        return self._core.warnings()

    # The motion.

    @cached_property
    def t(self) -> _Array:
        """Times of the nodes (N), s."""
        return _fixed(self._core.array("t"))

    @cached_property
    def q(self) -> _Array:
        """Positions (N, n), rad or m."""
        return _fixed(self._core.array("q"))

    @cached_property
    def v(self) -> _Array:
        """Rates (N, n)."""
        return _fixed(self._core.array("v"))

    @cached_property
    def p(self) -> _Array:
        """Momenta p = M v (N, n)."""
        return _fixed(self._core.array("p"))

    @cached_property
    def u(self) -> _Array:
        """Controls (N, n), before the gain."""
        return _fixed(self._core.array("u"))

    @cached_property
    def tau(self) -> _Array:
        """Torques and forces at the joints (N, n), N m or N."""
        return _fixed(self.u * self._core.gain())

    @cached_property
    def a(self) -> _Array:
        """Accelerations (N, n), of the polynomials of the direct method, else by forward dynamics."""
        return _fixed(self._core.accelerations())

    @cached_property
    def costates(self) -> _Array:
        """Costates y = (y_q, y_p) of (q, p) (N, 2n); y(0) = -dJ/dx(0)."""
        return _fixed(np.hstack([self._core.array("y_q"), self._core.array("y_p")]))

    @cached_property
    def hamiltonian(self) -> _Array:
        """H* at the nodes (N); empty for a motion that was read from a file."""
        return _fixed(self._core.array("hamiltonian"))

    def sample(self, rate: float | None = None, *, times: Any = None) -> Samples:
        """The motion at a fixed rate, or at given times.

        Motions of the direct method are sampled from their polynomials, with torques of inverse dynamics cut to their
        limits; at a switch a sample is that of the arc that begins.

        Parameters
        ----------
        rate : float
            Samples in a second (Hz): at k/rate, and at T, the last one.
        times : array
            Times (s) between 0 and T, instead.

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
        """The gains of the optimal feedback and derivatives by limits, at a rate (Hz) or at the points of the motion.

        The problem is solved once more, on the mesh of the motion or on equal intervals. Jerks, torque rates, given
        accelerations and vias are refused.

        Raises
        ------
        ProblemError
            For a problem that it is not computed for.
        MotionError
            Where the motion is no strict minimum, or something is free at the start.
        """
        return Gains(self._core.gains_json(rate))

    def sensitivities(self) -> dict[str, Sensitivity]:
        """dJ/dtheta for masses, inertias, lengths and all other numbers of the robot, by name; nothing is solved again.

        Raises
        ------
        MotionError
            For a motion that is not optimal, or with jerks, torque rates, given accelerations, vias.
        """
        return {row[0]: Sensitivity._make(row) for row in self._core.sensitivities()}

    # Files, tables, pictures.

    def to_json(self) -> str:
        """The JSON object that ``costate optimize --save`` writes."""
        return self._core.json()

    def to_dict(self) -> dict[str, Any]:
        """The same as dictionaries and lists."""
        return json.loads(self.to_json())  # type: ignore[no-any-return]

    def save(self, path: str | PathLike[str], *, rate: float | None = None) -> None:
        """Write the solution: JSON into ``.json``, a table of samples at a rate (Hz) into ``.csv``.

        ``start_from`` of `Problem.solve` and of a problem file, and `load`, read the JSON.
        """
        end = _Path(path).suffix.lower()
        if end not in (".json", ".csv") or (end == ".csv") != (rate is not None):
            error = ArgumentError(f"{fspath(path)}: give a .json file, or a .csv file and rate=")
            error.argument = "path"
            raise error
        text = self.to_json() if rate is None else self.sample(rate).to_csv()
        _Path(path).write_text(text, encoding="utf-8")

    def to_html(
        self,
        path: str | PathLike[str] | None = None,
        *,
        urdf: str | PathLike[str] | None = None,
        package_path: Sequence[str | PathLike[str]] = (),
    ) -> str:
        """The report: one page with the moving robot in perspective, plots and figures; it needs no network.

        Parameters
        ----------
        path : path, optional
            Where to write it too.
        urdf : path, optional
            A URDF whose visual models are shown in place of capsules: boxes, cylinders, spheres, STL and OBJ meshes.
            What cannot be read is a `UserWarning`.
        package_path : sequence of paths
            Folders in which ``package://`` is looked for.
        """
        page, missing = self._core.html(urdf, list(package_path))
        for text in missing:
            warnings.warn(text, stacklevel=2)
        if path is not None:
            _Path(path).write_text(page, encoding="utf-8")
        return page

    def to_dataframe(self, rate: float | None = None) -> Any:
        """Samples as a data frame of pandas: at a rate (Hz), or about 200 of them."""
        return self._samples(rate).to_dataframe()

    def _samples(self, rate: float | None) -> Samples:
        if rate is not None:
            return self.sample(rate)
        if not len(self.t):
            raise MotionError(f"there is no motion: {self.message}")
        return self.sample(times=np.linspace(float(self.t[0]), float(self.t[-1]), 201))

    def plot(self, rate: float | None = None, axes: Any = None) -> Any:
        """Draw q, v, a and tau over time with matplotlib, with the limits of the robot dotted; the four axes.

        Parameters
        ----------
        rate : float, optional
            Samples in a second (Hz); about 200 samples unless given.
        axes : array of matplotlib axes (4), optional
            Where to draw.
        """
        return _show.plot(self._samples(rate), self._problem.robot, axes)

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

    __hash__ = object.__hash__

    def __reduce__(self) -> tuple[Any, ...]:
        return (Solution._read, (self._problem, self._core.complete(), self.seconds))


def _fixed(array: _Array) -> _Array:
    array.flags.writeable = False
    return array
