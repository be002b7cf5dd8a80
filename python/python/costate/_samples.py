"""Motions at many times: samples, feedback, and derivatives of the cost."""

from __future__ import annotations

import json
from os import PathLike
from pathlib import Path as _Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ._costate import _Samples

if TYPE_CHECKING:
    from numpy.typing import NDArray

    _Array = NDArray[np.float64]


def same(a: Any, b: Any) -> bool:
    """Whether two objects hold the same numbers: arrays, and dictionaries and lists of them; not-a-number is equal."""
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        return np.array_equal(a, b, equal_nan=True)
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(same(value, b[key]) for key, value in a.items())
    if isinstance(a, list) and isinstance(b, list):
        return len(a) == len(b) and all(map(same, a, b))
    return bool(a == b)


def fixed(array: _Array) -> _Array:
    """The array, which cannot be written to any more."""
    array.flags.writeable = False
    return array


class Sensitivity(NamedTuple):
    """How the least cost changes with a parameter of the robot.

    Attributes
    ----------
    name : str
        The parameter, such as ``"elbow.mass"``.
    value : float
        Its value in the model.
    derivative : float
        dJ/dtheta.
    """

    name: str
    value: float
    derivative: float


class Samples:
    """A motion at many times: rows are times, columns joints. Samples with equal numbers and joints are equal.

    Attributes
    ----------
    t : array (N)
        Times (s).
    q, v, a : array (N, n)
        Positions, rates and accelerations; with floating and spherical joints q has ``robot.nq`` columns.
    tau : array (N, n)
        Torques and forces at the joints (N m, N), cut to their limits.
    u : array (N, n)
        Controls, before the gain.
    phase : array of int (N)
        The phase of each time, from 1; empty without vias.
    joint_names : list of str
        The joints, the columns of all but q.
    position_names : list of str
        The columns of q: the joints, or of a floating joint ``NAME_x`` to ``NAME_qw``.
    """

    def __init__(self, core: _Samples, joint_names: list[str]) -> None:
        self.joint_names = joint_names
        self.position_names = core.positions()
        self.t: _Array = core.array("t")
        self.q: _Array = core.array("q")
        self.v: _Array = core.array("v")
        self.a: _Array = core.array("a")
        self.tau: _Array = core.array("tau")
        self.u: _Array = core.array("u")
        self.phase: NDArray[np.int64] = core.array("phase")

    def to_csv(self, path: str | PathLike[str] | None = None) -> str:
        """The table that ``costate optimize --sample-to`` writes.

        Parameters
        ----------
        path : path, optional
            Where to write it too.

        Returns
        -------
        str
            Columns are ``t``, then ``q_JOINT``, ``v_JOINT``, ``a_JOINT``, ``tau_JOINT``, ``u_JOINT`` for all joints; those
            of q have ``position_names``.
        """
        rows = [array.tolist() for array in (self.q, self.v, self.a, self.tau, self.u)]
        names = self.position_names, self.joint_names
        text = _Samples.of(self.t.tolist(), rows, self.phase.tolist(), *names).csv()
        if path is not None:
            _Path(path).write_text(text, encoding="utf-8")
        return text

    def to_dataframe(self) -> Any:
        """The same as a data frame of pandas, which must be installed.

        Returns
        -------
        pandas.DataFrame
            With the columns of `to_csv`, and ``phase`` where there are vias.
        """
        import pandas as pd  # type: ignore[import-untyped,import-not-found,unused-ignore]

        columns: dict[str, Any] = {"t": self.t}
        for name in ("q", "v", "a", "tau", "u"):
            rows = getattr(self, name)
            joints = self.position_names if name == "q" else self.joint_names
            columns.update({f"{name}_{joint}": rows[:, k] for k, joint in enumerate(joints)})
        if len(self.phase):
            columns["phase"] = self.phase
        return pd.DataFrame(columns)

    def __eq__(self, other: object) -> bool:
        return same(vars(self), vars(other)) if isinstance(other, Samples) else NotImplemented

    def __len__(self) -> int:
        return len(self.t)

    def __repr__(self) -> str:
        ends = f", {self.t[0]:.6g} to {self.t[-1]:.6g} s" if len(self.t) else ""
        return f"Samples({len(self.t)} times{ends}, n={len(self.joint_names)})"


class Gains:
    """The optimal feedback of a motion over time, and its derivatives by limits.

    A state that is off by (dq, dv) at the time ``t[k]`` is led to the end at the least cost by
    ``tau[k] + gain_q[k] @ dq + gain_v[k] @ dv``, as long as the same limits are active. Feedbacks with equal numbers are
    equal.

    Attributes
    ----------
    t : array (N)
        Times (s).
    q, v, tau : array (N, n)
        The motion there.
    gain_q, gain_v : array (N, n, n)
        dtau/dq and dtau/dv; with continuous accelerations those of the jerk.
    gain_a : array (N, n, n) or None
        With continuous accelerations djerk/da.
    active : list of list of str
        Names of the limits that are active at ``t``, such as ``rate elbow max``. Rows of torques at a limit are zero;
        gains are zero along the gradient of an active limit of the state and along that of its derivative in time.
    undecided : list of list of str
        At ``t`` the names of the limits, now or later, that the motion only touches: gains to either side differ by more
        than 1 % of the largest one, and those here lie between them. Or a position, a tool or a clearance is at its limit
        for longer than an instant and less than four intervals of the mesh: gains before that are not known.
    held : array (phases, 2)
        For each phase the time from which on its gains are held, and its end (s): they grow without bound towards a
        given end.
    cost_by_start, final_time_by_start : array (m)
        dJ/dx and dT/dx, x = (q, v) at the start, m = 2n; with continuous accelerations x = (q, v, a), m = 3n.
    final_time : float
        T (s).
    derivatives : dict
        ``t``, and ``parameters``: for each limit of joints, tools and bodies ``name``, ``joint``, ``cost``, ``final_time``, and
        ``q``, ``v``, ``tau`` (arrays) at ``t``, at the same part of the time.
    """

    def __init__(self, text: str) -> None:
        self._text = text
        found = json.loads(text)
        n = len(found["joints"])
        self.final_time: float = found["final_time"]
        self.t: _Array = np.array(found["t"])
        self.q, self.v, self.tau = (np.array(found[name]).reshape(-1, n) for name in ("q", "v", "tau"))
        self.gain_q, self.gain_v = (np.array(found[name]).reshape(-1, n, n) for name in ("gain_q", "gain_v"))
        self.gain_a: _Array | None = np.array(found["gain_a"]) if "gain_a" in found else None
        self.active: list[list[str]] = found["active"]
        self.undecided: list[list[str]] = found["undecided"]
        self.held: _Array = np.array(found["held"]).reshape(-1, 2)
        self.cost_by_start, self.final_time_by_start = (
            np.array(found[name]) for name in ("cost_by_start", "final_time_by_start")
        )
        self.derivatives: dict[str, Any] = found["derivatives"]
        self.derivatives["t"] = np.array(self.derivatives["t"])
        for parameter in self.derivatives["parameters"]:
            parameter.update({name: np.array(parameter[name]) for name in ("q", "v", "tau")})

    def to_json(self) -> str:
        """The JSON object that ``costate optimize --feedback`` writes.

        Returns
        -------
        str
            Its text.
        """
        return self._text

    def __eq__(self, other: object) -> bool:
        return same(vars(self), vars(other)) if isinstance(other, Gains) else NotImplemented

    def __repr__(self) -> str:
        return f"Gains({len(self.t)} times, n={self.q.shape[1]})"
