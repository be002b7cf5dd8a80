"""Solutions as text, tables and pictures."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _svg

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ._costate import Robot
    from ._samples import Samples
    from ._solution import Solution


def _rows(solution: Solution) -> list[tuple[str, str]]:
    rows = [("status", solution.status.replace("_", " "))]
    if len(solution.t):
        rows += [("cost", f"{solution.cost:.12g}"), ("final time", f"{solution.final_time:.10g} s")]
    if len(solution.errors) == 1:
        rows.append(("error of the cost", f"{solution.errors[0]:.1e} relative, estimated"))
    if np.isfinite(solution.finer_mesh):
        rows.append(("finer mesh", f"changes the cost by {solution.finer_mesh:.1e} relative"))
    for name, check in (solution.verified or {}).items():
        if isinstance(check, dict) and (check["outcome"] == "failed" or name == "optimality"):
            value = f" {check['value']:.1e} of {check['allowed']:.1e}" if check["value"] is not None else ""
            where = f", {check['subject']}" if check.get("subject") else ""
            where += f" at {check['time']:.4g} s" if check.get("time") is not None else ""
            rows.append((f"verified {name}", check["outcome"].replace("_", " ") + value + where))
    if np.isfinite(solution.end_defect):
        rows.append(("end defect", f"{solution.end_defect:.1e}"))
    if solution.gait:
        rows.append(("speed", f"{solution.gait['speed']:.4g} m/s"))
        rows.append(("cost of transport", f"{solution.gait['cost_of_transport']:.4g}"))
    for kind, use in solution.limits.items():
        worst = use.get("worst")
        where = f", {worst['joint']} at {worst['time']:.4g} s" if worst else ""
        active = len({(span["joint"], span["side"]) for span in use["active"]})
        # Torques between the points are cut to their limits.
        between = 0.0 if kind == "torque" else use["between"]
        text = f"exceeded by {use['at_points']:.1e}{where}"
        if between > use["at_points"]:
            worst = use.get("worst_between")
            where = f", {worst['joint']} at {worst['time']:.4g} s" if worst else ""
            text += f", between the points by {between:.1e}{where}"
        text += f"; {active} active"
        rows.append((kind.replace("_", " ") + " limits", text))
    return [*rows, ("Newton iterations", str(solution.newton_iterations))]


def text(solution: Solution) -> str:
    """Figures line by line, and what there is to say."""
    lines = [f"{name:<20}{value}" for name, value in _rows(solution)]
    return "\n".join([*lines, *(f"{remark.severity}: {remark}" for remark in solution.warnings)])


def html(solution: Solution) -> str:
    """The same as a table, and the motion as a picture."""
    rows = "".join(f"<tr><th>{escape(name)}</th><td>{escape(value)}</td></tr>" for name, value in _rows(solution))
    note = "".join(f"<p>{remark.severity}: {escape(remark)}</p>" for remark in solution.warnings)
    picture = ""
    if len(solution.t) > 1:
        times = np.linspace(float(solution.t[0]), float(solution.t[-1]), 101)
        samples = solution.sample(times=times)
        picture = _svg.motion(samples, position_limits(samples, solution.problem.robot), solution.problem.robot)
    return f"<div><b>{escape(solution.problem.robot.name)}</b><table>{rows}</table>{note}{picture}</div>"


def position_limits(samples: Samples, robot: Robot) -> NDArray[np.float64]:
    """Those of the columns of q, two rows; floating and spherical joints have none."""
    of_joint = dict(zip(robot.joint_names, robot.position_limits.T, strict=True))
    columns = [of_joint.get(name, (-np.inf, np.inf)) for name in samples.position_names]
    return np.array(columns, float).reshape(-1, 2).T


def plot(samples: Samples, robot: Robot, axes: Any) -> Any:
    """q, v, a and tau over time on four axes."""
    import matplotlib.pyplot as plt  # type: ignore[import-untyped,import-not-found,unused-ignore]

    if axes is None:
        _, grid = plt.subplots(2, 2, sharex=True, figsize=(10, 6), layout="constrained")
        axes = grid.ravel()
    limits = {
        "q": position_limits(samples, robot),
        "v": robot.velocity_limits * [[-1], [1]],
        "tau": robot.effort_limits * [[-1], [1]],
    }
    titles = {"q": "q (rad, m)", "v": "v (rad/s, m/s)", "a": "a (rad/s², m/s²)", "tau": "tau (N m, N)"}
    for ax, (name, title) in zip(axes, titles.items(), strict=True):
        rows = getattr(samples, name)
        for k, joint in enumerate(samples.position_names if name == "q" else samples.joint_names):
            (line,) = ax.plot(samples.t, rows[:, k], label=joint)
            near = np.ptp(rows) if len(rows) else 0.0
            for limit in limits.get(name, np.empty((0, rows.shape[1])))[:, k]:
                if np.isfinite(limit) and np.abs(rows[:, k] - limit).min() < 0.3 * near:
                    ax.axhline(limit, color=line.get_color(), linestyle=":", linewidth=1)
        ax.set_title(title, loc="left", fontsize="medium")
    axes[0].legend(fontsize="small")
    if samples.position_names != samples.joint_names:
        axes[1].legend(fontsize="small")
    for ax in axes[2:]:
        ax.set_xlabel("t (s)")
    return axes
