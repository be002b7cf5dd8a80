"""Motions in a browser: against a server of viser, without a browser."""

import json
import threading
import time

import costate
import numpy as np
import pytest
from costate._stage import Stage, turned
from costate._viser import Poses, quaternion
from conftest import ROBOTS

viser = pytest.importorskip("viser")


@pytest.fixture(scope="module")
def solution(ur5):
    start, end = [0.0, -1.6, 1.8, -1.8, -1.57, 0.0], [0.5, -1.0, 1.2, -1.5, -1.57, 0.5]
    return costate.Problem(ur5, start=start, end=end, time=1.0, cost=1 / ur5.effort_limits**2).solve(verify="none")


@pytest.fixture
def server():
    server = viser.ViserServer(host="127.0.0.1", port=18080, verbose=False)
    yield server
    server.stop()


def handles(server):
    """What is in the scene and among the controls, by name."""
    return server.scene._handle_from_node_name, {handle.label: handle for handle in server.gui._gui_input_handle_from_uuid.values()}


def test_the_slider_moves_the_robot(solution, server):
    assert solution.to_viser(server=server, name="arm") is server
    nodes, controls = handles(server)
    slider = controls["arm: t (s)"]
    tool = costate.Dynamics(solution.problem.robot).frame("tool0")
    times = np.linspace(0, solution.final_time, 201)
    for k in (200, 77, 0):
        slider.value = float(times[k])
        rotation, position = tool.pose(solution.sample(times=times).q[k])
        shown = nodes["/arm/tools/tool0"]
        assert np.allclose(shown.position, position, atol=1e-9)
        assert np.allclose(np.abs(shown.wxyz @ quaternion(rotation)), 1.0, atol=1e-9)
    # Bodies lie below their joints, which are where the library has them; ghosts stay at the ends.
    robot = solution.problem.robot
    bodies = [name for name in nodes if name.startswith("/arm/links/") and "/body_" in name]
    assert len(bodies) == (ROBOTS / "ur5.urdf").read_text().count("<visual>") > 10
    for title, q in [("links", solution.q[0]), ("start", solution.q[0]), ("end", solution.q[-1])]:
        for joint in robot.joint_names:
            rotation, position = costate.Dynamics(robot).frame(f"joint:{joint}").pose(q)
            node = nodes[f"/arm/{title}/{joint}"]
            assert np.allclose(node.position, position, atol=1e-9)
            assert np.allclose(np.abs(node.wxyz @ quaternion(rotation)), 1.0, atol=1e-9)
    controls["arm: start and end"].value = False
    assert not nodes["/arm/start"].visible and not nodes["/arm/end"].visible


def test_play_runs_to_the_end(solution, server):
    solution.to_viser(rate=20.0, server=server, loop=False)
    controls = handles(server)[1]
    controls["robot: play"].value = True
    end = time.monotonic() + 30
    while controls["robot: play"].value and time.monotonic() < end:
        time.sleep(0.02)
    assert controls["robot: t (s)"].value == pytest.approx(solution.final_time) and not controls["robot: play"].value


def players():
    return [thread for thread in threading.enumerate() if thread.name == "robot: play"]


def test_one_thread_plays_until_the_server_stops(solution):
    server = viser.ViserServer(host="127.0.0.1", port=18180, verbose=False)
    solution.to_viser(rate=20.0, server=server)
    play = handles(server)[1]["robot: play"]
    for value in (True, False, True, False, True):  # Within a picture.
        play.value = value
    time.sleep(0.3)
    assert len(players()) == 1
    server.stop()
    end = time.monotonic() + 10
    while players() and time.monotonic() < end:
        time.sleep(0.02)
    assert players() == [] and play.value


def test_quaternions_of_all_rotations(random):
    for given in [*random.normal(size=(50, 4)), *np.eye(4), [0, 1, 1, 0], [1e-9, 1, 0, 0]]:
        w, x, y, z = unit = np.asarray(given) / np.linalg.norm(given)
        turn = np.array([
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ])  # fmt: skip
        assert abs(quaternion(turn) @ unit) == pytest.approx(1.0, abs=1e-12)


def test_obstacles_are_shown(ur5, server):
    table = [
        {"kind": "sphere", "xyz": [2.0, 0, 0], "radius": 0.1},
        {"kind": "box", "xyz": [2.0, 1, 0], "size": [0.1, 0.2, 0.3]},
        {"kind": "capsule", "from": [2.0, 2, 0], "to": [2.0, 2, 1], "radius": 0.1},
        {"kind": "half_space", "xyz": [0, 0, -1.5], "normal": [0, 0, 1]},
    ]
    task = {"start": [0.0] * 6, "end": [0.1] * 6, "time": 1.0, "cost": [1.0] * 6}
    tool = {"capsule": [{"frame": "tool0", "from": [0, 0, -0.05], "to": [0, 0, 0], "radius": 0.04}]}
    solution = costate.Problem(ur5, **task, obstacle=table, collision=tool).solve(verify="none")
    solution.to_viser(server=server)
    nodes = handles(server)[0]
    assert sum(name.startswith("/robot/obstacles/") for name in nodes) == 4
    assert nodes["/robot/obstacles/3"].side == "double" and (nodes["/robot/obstacles/3"].vertices[:, 2] == -1.5).all()
    assert np.allclose(nodes["/robot/obstacles/0"].position, [2, 0, 0])


def stage(bodies=(), meshes=()):
    return Stage(json.dumps({"bodies": list(bodies), "obstacles": [], "meshes": list(meshes)}))


def volume(vertices, faces):
    """Of what the triangles enclose, positive where they are seen from outside."""
    corners = vertices[faces]
    return np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6


def test_triangles_enclose_their_shapes():
    """Volumes against closed forms; a circle of 28 sides is a little smaller."""
    shapes = {
        "box": ({"kind": "box", "size": [1, 2, 3]}, 6.0),
        "sphere": ({"kind": "sphere", "radius": 2.0}, 4 / 3 * np.pi * 8),
        "cylinder": ({"kind": "cylinder", "radius": 0.5, "length": 3}, np.pi * 0.25 * 3),
        "capsule": ({"kind": "capsule", "from": [1, 2, 3], "to": [1, 4, 3], "radius": 1}, np.pi * 2 + 4 / 3 * np.pi),
    }
    for name, (shape, expected) in shapes.items():
        assert volume(*stage().triangles(shape)) == pytest.approx(expected, rel=1e-12 if name == "box" else 0.04), name
    vertices, _ = stage().triangles(shapes["capsule"][0])
    assert np.allclose([vertices.min(axis=0), vertices.max(axis=0)], [[0, 1, 2], [2, 5, 4]], atol=0.02)
    # A plane: its distance from the origin, its normal, and a square of four times the reach.
    through, normal = np.array([0.3, -1.0, 0.5]), np.array([1.0, 2.0, -2.0])
    vertices, faces = stage().triangles({"kind": "plane", "through": through.tolist(), "normal": normal.tolist()}, reach=1.5)
    assert np.allclose((vertices - through) @ normal, 0) and np.allclose(np.cross(vertices.mean(axis=0), normal), 0)
    edges = vertices[faces][:, 1:] - vertices[faces][:, :1]
    areas = np.cross(edges[:, 0], edges[:, 1])
    assert np.allclose(areas / np.linalg.norm(areas, axis=1)[:, None], normal / 3) and np.allclose(np.linalg.norm(areas, axis=1), 36)
    assert volume(*turned([(0, 0), (1, 0), (0, 3)])) == pytest.approx(np.pi, rel=0.02)


def test_meshes_of_files_are_shown(tmp_path, ur5):
    """A tetrahedron, twice as large along y, and mirrored."""
    (tmp_path / "part.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    visual = '<visual><geometry><mesh filename="part.obj" scale="{}"/></geometry></visual>'
    for scale, expected in [("1 2 1", 1 / 3), ("-1 1 1", 1 / 6)]:
        text = (ROBOTS / "ur5.urdf").read_text().replace('<link name="tool0"/>', f'<link name="tool0">{visual.format(scale)}</link>')
        (tmp_path / "arm.urdf").write_text(text)
        robot = costate.Robot.from_file(tmp_path / "arm.urdf")
        solution = costate.Problem(robot, start=[0.0] * 6, end=[0.1] * 6, time=1.0, cost=[1.0] * 6).solve(verify="none")
        found, missing = solution._core.stage(robot, None, [])
        (shape,) = [body.shape for body in Stage(found).bodies if body.shape["kind"] == "mesh"]
        assert volume(*Stage(found).triangles(shape)) == pytest.approx(expected, rel=1e-3) and missing == []


def test_tools_are_the_ends_of_branches():
    builder = costate.Robot.builder("fork").revolute("trunk", mass=1, com=[1, 0, 0])
    builder.revolute("left", on="trunk", xyz=[1, 1, 0], mass=1, com=[1, 0, 0])
    robot = builder.revolute("right", on="trunk", xyz=[1, -1, 0], mass=1, com=[1, 0, 0]).build()
    assert dict(zip(robot.all_joint_names, robot.parents)) == {"trunk": None, "left": "trunk", "right": "trunk"}
    poses = Poses(robot, np.zeros((1, 3)))
    assert sorted(poses.tools) == ["joint:left", "joint:right"]
    places = [position[0].round(9).tolist() for _, position in poses.joints.values()]
    assert places == [[0, 0, 0], [1, 1, 0], [1, -1, 0]]


def test_a_robot_that_flies_is_shown(server):
    """Joints between the ends of a floating one have no nodes; its own has its pose, and bodies lie below it."""
    problem = costate.Problem.from_file(ROBOTS.parent / "examples" / "problems" / "satellite_arm.toml")
    solution = problem.solve(verify="none")
    solution.to_viser(server=server, name="satellite")
    nodes, controls = handles(server)
    slider = controls["satellite: t (s)"]
    slider.value = solution.final_time
    last = solution.q[-1]
    base = nodes["/satellite/links/base"]
    assert np.allclose(base.position, last[:3], atol=1e-9)
    assert np.allclose(np.abs(base.wxyz @ last[[6, 3, 4, 5]]), 1.0, atol=1e-9)
    assert not any("base_" in name for name in nodes)
    of_base = [name for name in nodes if name.startswith("/satellite/links/") and "/body_" in name]
    assert of_base and {name.split("/")[3] for name in of_base} <= {"base", "shoulder", "elbow"}
