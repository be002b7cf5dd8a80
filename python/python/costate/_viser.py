"""Solutions in a browser, by viser."""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING, Any

import numpy as np

from ._costate import Dynamics
from ._stage import Body, Stage

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ._costate import Robot
    from ._samples import Samples

_RATE = 60.0  # Pictures in a second.
_LINK, _OBSTACLE = (90, 130, 190), (200, 120, 70)
_GHOSTS = {"start": (110, 170, 120), "end": (190, 140, 90)}


class Poses:
    """Where the joints and tools of a robot are over time."""

    def __init__(self, robot: Robot, q: NDArray[np.float64]) -> None:
        dynamics = Dynamics(robot)
        names = moved(robot)
        self.joints = {name: dynamics.frame(f"joint:{name}").pose(q) for name in names}
        # Tools: frames with such names, or else the ends of all branches.
        leaves = [name for name in names if name not in robot.parents]
        tools = _added(robot) or [f"joint:{leaf}" for leaf in leaves]
        self.tools = {name: dynamics.frame(name).pose(q) for name in tools}
        places = [position for _, position in [*self.joints.values(), *self.tools.values()]]
        self.reach = max(float(np.abs(np.stack(places)).max()), 1e-3) if places else 1.0


def _added(robot: Robot) -> list[str]:
    """Names that say that a frame is a tool's."""
    words = ("tool", "tcp", "tip", "hand", "ee_", "gripper", "flange")
    names = [name for name in robot.frame_names if name.lower().startswith(words) and not name.endswith("_joint")]
    return list(dict.fromkeys(names))


def moved(robot: Robot) -> list[str]:
    """The joints that have frames: all but those between the two ends of a floating or spherical joint."""
    between = {f"{name}_{part}" for name, *_ in robot.free_joints for part in ("x", "y", "z", "rx", "ry")}
    return [name for name in robot.all_joint_names if name not in between]


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


def _place(rotation: NDArray[np.float64], position: NDArray[np.float64]) -> dict[str, Any]:
    return {"wxyz": quaternion(rotation), "position": position}


def _draw(
    scene: Any, path: str, body: Body, stage: Stage, colour: tuple[int, int, int], opacity: float | None, reach: float = 1.0
) -> None:
    """Adds a body below a node of the scene; half-spaces end at the reach (m)."""
    if body.colour is not None and opacity is None:
        red, green, blue, own = body.colour
        colour = (round(255 * red), round(255 * green), round(255 * blue))
        opacity = own if own < 1 else None
    look: dict[str, Any] = {"color": colour, "opacity": opacity, **_place(body.rotation, body.position)}
    shape = body.shape
    if shape["kind"] == "box":
        scene.add_box(path, dimensions=tuple(shape["size"]), **look)
    elif shape["kind"] == "sphere":
        scene.add_icosphere(path, radius=shape["radius"], **look)
    elif (found := stage.triangles(shape, reach)) is not None:
        # Sharp edges have no smooth light: meshes of files, the rims of cylinders. A plane is seen from both sides.
        look["side"] = "double" if shape["kind"] == "plane" else "front"
        scene.add_mesh_simple(path, *found, flat_shading=shape["kind"] in ("mesh", "cylinder", "plane"), **look)


class _Figure:
    """A robot whose joints are nodes of the scene, its bodies below them."""

    def __init__(self, scene: Any, path: str, robot: Robot, stage: Stage) -> None:
        self.names = robot.all_joint_names
        self.scene, self.path, self.stage = scene, path, stage
        self.root = scene.add_frame(path, show_axes=False)
        self.nodes = {name: scene.add_frame(f"{path}/{name}", show_axes=False) for name in moved(robot)}

    def draw(self, colour: tuple[int, int, int], opacity: float | None) -> None:
        for k, body in enumerate(self.stage.bodies):
            if body.joint is None and opacity is not None:
                continue  # The base stands once.
            on = "base" if body.joint is None else self.names[body.joint]
            _draw(self.scene, f"{self.path}/{on}/body_{k}", body, self.stage, colour, opacity)

    def move(self, poses: Poses, k: int) -> None:
        for name, node in self.nodes.items():
            rotations, positions = poses.joints[name]
            node.wxyz, node.position = quaternion(rotations[k]), positions[k]


def show(samples: Samples, robot: Robot, stage: Stage, server: Any, name: str, loop: bool) -> Any:
    """Adds the robot and its controls to a server of viser; the server."""
    try:
        import viser
    except ImportError as error:
        raise ImportError("Solution.to_viser needs viser: pip install viser") from error
    if server is None:
        server = viser.ViserServer()
    poses = Poses(robot, np.ascontiguousarray(samples.q))
    last, reach, scene = len(samples) - 1, poses.reach, server.scene
    scene.add_grid(f"/{name}/floor", width=4 * reach, height=4 * reach, cell_size=reach / 4, section_size=reach)
    figure = _Figure(scene, f"/{name}/links", robot, stage)
    figure.draw(_LINK, None)
    ghosts = []
    for (title, colour), k in zip(_GHOSTS.items(), (0, last), strict=True):
        ghost = _Figure(scene, f"/{name}/{title}", robot, stage)
        ghost.draw(colour, 0.25)
        ghost.move(poses, k)
        ghosts.append(ghost)
    for k, obstacle in enumerate(stage.obstacles):
        _draw(scene, f"/{name}/obstacles/{k}", obstacle, stage, _OBSTACLE, 0.8, reach)
    tools = {}
    for tool, (rotations, positions) in poses.tools.items():
        axes: dict[str, Any] = {"axes_length": 0.12 * reach, "axes_radius": 0.008 * reach}
        tools[tool] = scene.add_frame(f"/{name}/tools/{tool}", **axes, **_place(rotations[0], positions[0]))
        path = np.stack([positions[:-1], positions[1:]], axis=1)
        scene.add_line_segments(f"/{name}/paths/{tool}", path, colors=(200, 60, 60), thickness=0.006 * reach)
    duration = float(samples.t[last])
    time_slider = server.gui.add_slider(f"{name}: t (s)", min=0.0, max=duration, step=duration / max(last, 1), initial_value=0.0)
    playing = server.gui.add_checkbox(f"{name}: play", initial_value=False)
    shown = server.gui.add_checkbox(f"{name}: start and end", initial_value=True)

    def draw(_: Any = None) -> None:
        k = min(last, int(np.searchsorted(samples.t, time_slider.value - 1e-9 * duration)))
        with server.atomic():
            figure.move(poses, k)
            for tool, handle in tools.items():
                rotations, positions = poses.tools[tool]
                handle.wxyz, handle.position = quaternion(rotations[k]), positions[k]

    def show_ghosts(_: Any = None) -> None:
        for ghost in ghosts:
            ghost.root.visible = shown.value

    latest = [0]  # The number of the thread that moves the slider: others end.
    served = getattr(getattr(server, "_websock_server", None), "_server_thread", None)

    def play(_: Any = None) -> None:
        latest[0] += 1
        if playing.value:
            threading.Thread(target=run, args=(latest[0],), daemon=True, name=f"{name}: play").start()

    def run(number: int) -> None:
        if time_slider.value >= duration:
            time_slider.value = 0.0
        before = time.perf_counter()
        while playing.value and number == latest[0]:
            time.sleep(1 / _RATE)
            if number != latest[0] or (served is not None and not served.is_alive()):
                return
            now = time.perf_counter()
            at, before = time_slider.value + now - before, now
            time_slider.value = at % duration if loop else min(at, duration)
            if at >= duration and not loop:
                playing.value = False

    draw()
    time_slider.on_update(draw)
    playing.on_update(play)
    shown.on_update(show_ghosts)
    return server
