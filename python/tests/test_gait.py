"""Gaits of walking robots: the steps of RABBIT, of a robot with soles and of one in space."""

import costate
import numpy as np
import pytest
from conftest import PROBLEMS, load

GAIT = {
    "stance": "right_foot",
    "swing": "left_foot",
    "along": "base_x",
    "length": 0.5,
    "friction": 0.6,
    "clearance": 0.02,
    "mirror": [["left_hip", "right_hip"], ["left_knee", "right_knee"]],
}
FREE = float("inf")


def tables() -> dict:
    """Those of examples/problems/rabbit_walk.toml."""
    return {
        "start": [-0.25, 0.72, 0.1, 0.1, 0.3, -0.6, 0.3],
        "time": 0.7,
        "cost": [0, 0, 0, 1, 1, 1, 1],
        "limits": {"q_min": [-FREE, -FREE, -FREE, -FREE, 0, -FREE, 0], "torque_max": [0, 0, 0, 150, 150, 150, 150]},
        "gait": GAIT,
        "solver": {"tolerance": 1e-6},
    }


@pytest.fixture(scope="module")
def walk() -> costate.Solution:
    return costate.Problem(load("rabbit.toml"), **tables()).solve().check()


def test_tables_are_those_of_the_file(walk):
    assert walk.converged and walk.problem == costate.Problem.from_file(PROBLEMS / "rabbit_walk.toml")
    assert abs(walk.cost - 195.3952697) < 2e-5


def test_the_gait_is_told(walk):
    gait = walk.gait
    assert abs(gait["speed"] - 0.5 / 0.7) < 1e-9 and gait["miss"] < 1e-6
    assert gait["cost_of_transport"] == gait["work"] / gait["weight_times_length"]
    assert abs(gait["weight_times_length"] - 40 * 9.81 * 0.5) < 1e-9
    # After a step the robot has its energy again: what motors add is what they and the landing take.
    assert abs(gait["work"] - gait["braking"] - gait["loss"]) < 1e-5 * gait["work"]
    [[x, y, z]] = gait["impulses"]
    assert y == 0 and 0 < abs(x) < 0.6 * z
    for shown in (str(walk), walk._repr_html_()):
        assert "cost of transport" in shown
    # The legs have changed places, a step ahead.
    exchanged = walk.q[-1][[0, 1, 2, 5, 6, 3, 4]] - [0.5, 0, 0, 0, 0, 0, 0]
    assert np.abs(exchanged - walk.q[0]).max() < 1e-9
    again = costate.Solution.from_json(walk.to_json(), walk.problem)
    assert again.gait == gait


def test_soles_are_those_of_the_file():
    file = costate.Problem.from_file(PROBLEMS / "seven_link_walk.toml")
    gait = GAIT | {
        "length": 0.4,
        "sole": [-0.0665, 0.125],
        "mirror": [[f"left_{joint}", f"right_{joint}"] for joint in ("hip", "knee", "ankle")],
    }
    given = {
        "start": [-0.2, 0.84, 0.05, 0.1, 0.6, -0.7, -0.6, 0.6, 0.0],
        "time": 0.6,
        "cost": [0] * 3 + [1] * 6,
        "limits": {
            "q_min": [-FREE, -FREE, -0.3, -1.5, 0.2, -1, -1.5, 0.2, -1],
            "q_max": [FREE, FREE, 0.3, 1, 2, 1, 1, 2, 1],
            "torque_max": [0] * 3 + [200] * 6,
        },
        "solver": {"tolerance": 1e-6, "nodes": 97},
    }
    assert costate.Problem(load("seven_link.toml"), gait=gait, **given) == file
    with pytest.raises(costate.ProblemError, match="heel") as raised:
        costate.Problem(load("seven_link.toml"), gait=gait | {"sole": [0.1, 0.1]}, **given).solve()
    assert raised.value.key == "gait.sole"


def test_both_feet_stand_for_a_part_of_the_step():
    """The landing is without an impulse, and forces of both feet stay within their cones until one is released."""
    given = tables() | {"gait": GAIT | {"double_support": 0.2}}
    both = costate.Problem(load("rabbit.toml"), **given)
    assert both == costate.Problem.from_file(PROBLEMS / "rabbit_double_support.toml")
    solution = both.solve().check()
    gait = solution.gait
    assert gait["double_support"] == pytest.approx(0.2 * 0.7, rel=1e-9)
    assert np.abs(gait["impulses"]).max() < 1e-6 and np.abs(gait["standing_impulses"]).max() < 1e-6
    assert gait["loss"] == pytest.approx(0, abs=1e-6) and gait["work"] == pytest.approx(gait["braking"], rel=1e-4)
    assert solution.via_times == [pytest.approx(gait["double_support"], rel=1e-9)]
    assert "ground_force" in solution.limits and solution.keeps_limits
    again = costate.Solution.from_json(solution.to_json(), both)
    assert again.gait == gait
    for part in (-0.1, 1.0, "long"):
        with pytest.raises(costate.ProblemError) as raised:
            costate.Problem(load("rabbit.toml"), **tables() | {"gait": GAIT | {"double_support": part}})
        assert raised.value.key == "gait.double_support"


def walker() -> tuple[costate.Robot, dict]:
    """The robot and the tables of examples/problems/biped_walk.toml."""
    names = ("hip_pitch", "hip_roll", "hip_yaw", "knee", "ankle_pitch", "ankle_roll")
    robot = load("biped_walker.toml")
    for side in ("left", "right"):
        for name in names:
            robot = robot.with_armature(f"{side}_{name}", 0.1)
    signs = [f"{side}_{name}" for side in ("left", "right") for name in ("hip_roll", "hip_yaw", "ankle_roll")]
    gait = {"stance": "right_foot", "swing": "left_foot", "along": "base_x", "length": 0.3, "width": 0.167}
    gait |= {"friction": 0.6, "clearance": 0.02, "sole": [-0.0488, 0.1371], "sole_width": 0.0958}
    gait |= {"mirror": [[f"left_{name}", f"right_{name}"] for name in names]}
    gait |= {"flipped": ["base_y", "base_yaw", "base_roll", *signs]}
    left, right = [0.1, 0.0, 0.0, 0.6, -0.7, 0.0], [-0.6, 0.0, 0.0, 0.6, 0.0, 0.0]
    least, most = [-1.5, -0.7, -0.7, 0.2, -1.0, -0.6], [1.0, 0.7, 0.7, 2.0, 1.0, 0.6]
    return robot, {
        "start": [-0.2, 0.0, 0.83, 0.0, 0.0, 0.05, *left, *right],
        "time": 0.7,
        "cost": [0.0] * 6 + [1.0] * 12,
        "limits": {
            "q_min": [-FREE] * 3 + [-0.5, -0.5, -0.3, *least, *least],
            "q_max": [FREE] * 3 + [0.5, 0.5, 0.3, *most, *most],
            "torque_max": [0.0] * 6 + [200.0] * 12,
        },
        "gait": gait,
        "solver": {"tolerance": 1e-6, "nodes": 145},
    }


@pytest.mark.filterwarnings("ignore::costate.RobotWarning")
def test_a_robot_in_space_has_the_tables_of_its_file():
    """`control/tests/control/space_walk.rs` walks with them."""
    robot, given = walker()
    problem, file = costate.Problem(robot, **given), costate.Problem.from_file(PROBLEMS / "biped_walk.toml")
    assert problem == file and problem.robot == file.robot

    def key_of(change: dict) -> str | None:
        with pytest.raises(costate.ProblemError) as raised:
            costate.Problem(robot, **given | {"gait": given["gait"] | change})
        return raised.value.key

    gait = given["gait"]
    assert key_of({"flipped": [*gait["flipped"], "base_y"]}) == "gait.flipped"
    assert key_of({"flipped": [*gait["flipped"], "base_w"]}) == "gait.flipped"
    assert key_of({"width": -0.1}) == "gait.width"
    assert key_of({"sole_width": None}) == "gait.sole_width"
    assert key_of({"sole_width": 0.0}) == "gait.sole_width"


def test_what_is_no_gait_is_refused_by_name():
    with pytest.raises(costate.ProblemError, match="right_foot") as raised:
        costate.Problem(load("rabbit.toml"), **tables() | {"gait": GAIT | {"stance": "right_fot"}}).solve()
    assert raised.value.key == "gait.stance"
    with pytest.raises(costate.ProblemError, match="remove"):
        costate.Problem(load("rabbit.toml"), end=[0.0] * 7, **tables())


def test_motions_without_a_gait_tell_none(arm):
    assert costate.Problem(arm, start=[0, 0], end=[1, 1], time=1, cost=[1, 1]).solve().gait is None
