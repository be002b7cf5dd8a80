"""What a solution says about itself: how it ended, and its figures."""

from __future__ import annotations

import json
from functools import cached_property
from typing import TYPE_CHECKING, Any

from ._costate import _Solution
from ._errors import MotionError
from ._remarks import Remark
from ._run import Iteration
from ._samples import fixed

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
    from typing_extensions import Self

    from ._problem import Problem

    _Array = NDArray[np.float64]


class Figures:
    """The part of `Solution` without the motion."""

    _core: _Solution
    _problem: Problem

    # How it ended.

    @property
    def problem(self) -> Problem:
        """The problem."""
        return self._problem

    @property
    def status(self) -> str:
        """How it ended: ``"converged"``, ``"locally_infeasible"``, ``"time_limit"``, ...; `message` says what it means."""
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

    def check(self) -> Self:
        """This solution, if it may be used: it is solved, keeps its hard limits, and repeats when it is integrated again.

        Returns
        -------
        Solution
            Itself.

        Raises
        ------
        MotionError
            With the errors among its `warnings`.
        """
        errors = [remark for remark in self.warnings if remark.severity == "error"]
        if errors:
            raise MotionError(f"{self.status}: {'; '.join(errors)}")
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
    def cost_error(self) -> float:
        """Estimated error of the cost of a direct motion, relative to it; NaN of polished and indirect motions."""
        return self._number("cost_error")

    @property
    def finer_mesh(self) -> float:
        """By how much the cost changes on a mesh with halved intervals, relative to it; NaN where not known."""
        return self._number("finer_mesh")

    @property
    def verified(self) -> dict[str, Any] | None:
        """What a verification found that does not use the points of the solver; None without it.

        ``integrated_cost`` is J by adaptive quadrature, ``quadrature_error`` its error. ``cost``, ``dynamics``, ``limits``,
        ``overshoot`` and ``optimality`` are checks: ``outcome`` is "passed", "failed" or "not_verified", ``value`` is compared with
        ``allowed`` (both relative), ``time`` (s) and ``subject`` say where. ``stationarity`` is the largest relative
        derivative of the Hamiltonian by a torque inside its limits, ``costate_defect`` that of integrated
        costates. Of extremals ``optimality`` is the mismatch of segments integrated again with their costates.
        """
        found: dict[str, Any] | None = self._figures.get("verified")
        return found

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
        """What the second variation shows.

        "local_minimum": a strict one; "not_minimal"; "not_checked". Of the direct method, among the polynomials of the mesh:
        "local_minimum_on_mesh", "saddle_on_mesh".
        """
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
    def gait(self) -> dict[str, Any] | None:
        """Of a problem with a gait: ``speed`` (m/s), ``cost_of_transport``, ``work`` and ``braking`` of the motors (J),
        ``weight_times_length`` (J), ``impulses`` of the landing (N s), its ``loss`` (J), ``miss``; with double support
        its duration ``double_support`` (s) and ``standing_impulses`` (N s) on the feet that stay; None of others.

        The cost of transport is ``work / weight_times_length``: only where motors drive, after Collins et al., Science 307
        (2005) 1082.
        """
        found: dict[str, Any] | None = self._figures.get("gait")
        return found

    @property
    def limits(self) -> dict[str, Any]:
        """How the motion uses its limits, by "position", "rate", "acceleration", "torque", "jerk", "torque_rate", "power",
        "torque_speed", "ground_force", "landing_impulse" and "task", where they are limited.

        Each holds the largest violation ``at_points`` and ``between`` them, the ``worst`` one at the points, and one
        ``worst_between`` them that is more than 1e-4 of the range (``joint``, ``time``, ``excess``, ``unit``,
        ``value``, ``limit``), and the spans ``active`` (``joint``, ``side``, ``from``, ``to``).
        """
        return {kind: use for kind, use in self._figures.get("limits", {}).items() if kind != "infeasible"}

    @property
    def keeps_limits(self) -> bool:
        """Whether all limits are kept: at the points to 1e-7, between them to 1e-4 of the distance between lower and
        upper limit. Torques between the points are cut to their limits.
        """
        return not any("worst" in use or "worst_between" in use for use in self.limits.values())

    @property
    def infeasible(self) -> dict[str, Any] | None:
        """With the status "infeasible" the ``proof`` that no motion keeps all limits, and the ``least_time``; with
        "locally_infeasible" the ``limits`` that are exceeded where the violation has a local minimum (``kind``, ``joint``,
        ``side``, ``time``, ``amount``, ``unit``, ``limit``); with both a ``final_time`` with which the problem was solved,
        and whether it is proven (``is_global``).
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
        """``total`` cost and ``status`` of each start; ``looks``, how many guesses it looked at, and ``guess``, the best one."""
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
        return fixed(self._core.errors())

    @property
    def stage_times(self) -> dict[str, float] | None:
        """Seconds of the stages of the direct method, with ``stage_times=True``."""
        found = self._core.stage_times()
        return None if found is None else dict(found)

    @cached_property
    def warnings(self) -> list[Remark]:
        """What there is to say about the motion, errors first: each a text with a ``key``, ``severity`` and numbers."""
        return [Remark._of(fields) for fields in json.loads(self._core.remarks_json())]
