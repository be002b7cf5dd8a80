"""Solutions in a browser, by viser."""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING, Any

import numpy as np

from ._costate import Dynamics

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ._costate import Robot
    from ._samples import Samples

_RATE = 60.0  # Pictures in a second.


class Skeleton:
    """Where the joints and tools of a robot are over time: rods between joints, and frames."""

    def __init__(self, robot: Robot, q: NDArray[np.float64]) -> None:
        dynamics = Dynamics(robot)
        joints = robot.all_joint_names
        poses = {name: dynamics.frame(f"joint:{name}").pose(q) for name in joints}
        self.base = np.zeros((len(q), 3))
        self.joints = {name: position for name, (_, position) in poses.items()}
        parents = dict(zip(joints, robot.parents, strict=True))
        self.parents = {name: None if parent is None else self.joints[parent] for name, parent in parents.items()}
        # Frames of tools: what no joint begins at, at the end of a branch.
        self.tools: dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]] = {}
        leaves = [name for name in joints if name not in parents.values()]
        for name in _added(robot) or [f"joint:{leaf}" for leaf in leaves]:
            orientation, position = dynamics.frame(name).pose(q)
            self.tools[name] = orientation, position

    def rods(self, k: int) -> NDArray[np.float64]:
        """Ends of the rods (m, 2, 3) of one picture."""
        ends = [((self.base if start is None else start)[k], self.joints[name][k]) for name, start in self.parents.items()]
        return np.array(ends)


def _added(robot: Robot) -> list[str]:
    """Names that say that a frame is a tool's."""
    words = ("tool", "tcp", "tip", "hand", "ee_", "gripper", "flange")
    names = [name for name in robot.frame_names if name.lower().startswith(words) and not name.endswith("_joint")]
    return list(dict.fromkeys(names))


def quaternion(rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    """The unit quaternion (w, x, y, z) of a rotation matrix (3, 3)."""
    r = rotation
    # 4 q q': the row of the largest entry of its diagonal has no cancellation.
    outer = np.array([
        [1 + r[0, 0] + r[1, 1] + r[2, 2], r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]],
        [r[2, 1] - r[1, 2], 1 + r[0, 0] - r[1, 1] - r[2, 2], r[0, 1] + r[1, 0], r[0, 2] + r[2, 0]],
        [r[0, 2] - r[2, 0], r[0, 1] + r[1, 0], 1 - r[0, 0] + r[1, 1] - r[2, 2], r[1, 2] + r[2, 1]],
        [r[1, 0] - r[0, 1], r[0, 2] + r[2, 0], r[1, 2] + r[2, 1], 1 - r[0, 0] - r[1, 1] + r[2, 2]],
    ])  # fmt: skip
    row = outer[int(np.argmax(outer.diagonal()))]
    result: NDArray[np.float64] = row / np.linalg.norm(row)
    return result


def show(samples: Samples, robot: Robot, server: Any, name: str, loop: bool) -> Any:
    """Adds the robot and its controls to a server of viser; the server."""
    try:
        import viser
    except ImportError as error:
        raise ImportError("Solution.to_viser needs viser: pip install viser") from error
    if server is None:
        server = viser.ViserServer()
    skeleton = Skeleton(robot, np.ascontiguousarray(samples.q))
    last = len(samples) - 1
    reach = max(float(np.abs(skeleton.rods(0)).max()), 1e-3)
    scene = server.scene
    scene.add_grid(f"/{name}/floor", width=4 * reach, height=4 * reach, cell_size=reach / 4, section_size=reach)
    arms = scene.add_line_segments(
        f"/{name}/links", skeleton.rods(0), colors=(40, 90, 160), thickness=0.03 * reach, thickness_units="world"
    )
    balls = {
        joint: scene.add_icosphere(f"/{name}/joints/{joint}", radius=0.03 * reach, color=(220, 120, 30), position=at[0])
        for joint, at in skeleton.joints.items()
    }
    tools = {}
    for tool, (rotations, positions) in skeleton.tools.items():
        where: dict[str, Any] = {"wxyz": quaternion(rotations[0]), "position": positions[0]}
        tools[tool] = scene.add_frame(f"/{name}/tools/{tool}", axes_length=0.12 * reach, axes_radius=0.008 * reach, **where)
        path = np.stack([positions[:-1], positions[1:]], axis=1)
        scene.add_line_segments(f"/{name}/paths/{tool}", path, colors=(200, 60, 60), thickness=0.006 * reach)
    duration = float(samples.t[last])
    time_slider = server.gui.add_slider(f"{name}: t (s)", min=0.0, max=duration, step=duration / max(last, 1), initial_value=0.0)
    playing = server.gui.add_checkbox(f"{name}: play", initial_value=False)

    def draw(_: Any = None) -> None:
        k = min(last, int(np.searchsorted(samples.t, time_slider.value - 1e-9 * duration)))
        with server.atomic():
            arms.points = skeleton.rods(k)
            for joint, ball in balls.items():
                ball.position = skeleton.joints[joint][k]
            for tool, handle in tools.items():
                rotations, positions = skeleton.tools[tool]
                handle.wxyz, handle.position = quaternion(rotations[k]), positions[k]

    time_slider.on_update(draw)

    def play(_: Any = None) -> None:
        if playing.value:
            threading.Thread(target=run, daemon=True).start()

    def run() -> None:
        if time_slider.value >= duration:
            time_slider.value = 0.0
        before = time.perf_counter()
        while playing.value:
            time.sleep(1 / _RATE)
            now = time.perf_counter()
            at, before = time_slider.value + now - before, now
            time_slider.value = at % duration if loop else min(at, duration)
            if at >= duration and not loop:
                playing.value = False

    playing.on_update(play)
    return server
