"""Motions in a browser: against a server of viser, without a browser."""

import time

import costate
import numpy as np
import pytest
from costate._viser import Skeleton, quaternion

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
    rods = np.asarray(nodes["/arm/links"].points)
    assert rods.shape == (6, 2, 3)
    # One chain: a rod begins where the one before ends.
    assert np.allclose(rods[1:, 0], rods[:-1, 1], atol=1e-6) and np.allclose(rods[0, 0], 0.0)


def test_play_runs_to_the_end(solution, server):
    solution.to_viser(rate=20.0, server=server, loop=False)
    controls = handles(server)[1]
    controls["robot: play"].value = True
    end = time.monotonic() + 30
    while controls["robot: play"].value and time.monotonic() < end:
        time.sleep(0.02)
    assert controls["robot: t (s)"].value == pytest.approx(solution.final_time) and not controls["robot: play"].value


def test_quaternions_of_all_rotations(random):
    for given in [*random.normal(size=(50, 4)), *np.eye(4), [0, 1, 1, 0], [1e-9, 1, 0, 0]]:
        w, x, y, z = unit = np.asarray(given) / np.linalg.norm(given)
        turn = np.array([
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ])  # fmt: skip
        assert abs(quaternion(turn) @ unit) == pytest.approx(1.0, abs=1e-12)


def test_branches_begin_at_their_parents():
    builder = costate.Robot.builder("fork").revolute("trunk", mass=1, com=[1, 0, 0])
    builder.revolute("left", on="trunk", xyz=[1, 1, 0], mass=1, com=[1, 0, 0])
    robot = builder.revolute("right", on="trunk", xyz=[1, -1, 0], mass=1, com=[1, 0, 0]).build()
    assert dict(zip(robot.all_joint_names, robot.parents)) == {"trunk": None, "left": "trunk", "right": "trunk"}
    skeleton = Skeleton(robot, np.zeros((1, 3)))
    assert sorted(skeleton.tools) == ["joint:left", "joint:right"]
    assert np.allclose(sorted(skeleton.rods(0)[:, 1].round(9).tolist()), [(0, 0, 0), (1, -1, 0), (1, 1, 0)])
