"""Bodies of the robot that keep away from obstacles, from the collision models of a URDF."""

import math
import pickle

import costate
import pytest
from conftest import load

ROD = """<robot name="arm"><link name="base"/>
<link name="rod">
  <inertial><origin xyz="0.5 0 0"/><mass value="1"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
  <collision><origin xyz="0.5 0 0" rpy="0 1.5707963267948966 0"/>
    <geometry><cylinder radius="0.1" length="1"/></geometry></collision>
</link>
<joint name="hinge" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="0 0 1"/></joint>
</robot>"""


def problem(robot: costate.Robot, beside: float, n: int = 1) -> costate.Problem:
    """The rod turns to 1 rad, and a ball of 0.1 m lies ``beside`` it there."""
    out, up = math.cos(1.0), math.sin(1.0)
    ball = {"kind": "sphere", "radius": 0.1, "xyz": [0.5 * out - beside * up, 0.5 * up + beside * out, 0.0]}
    return costate.Problem(
        robot, start=[0] * n, end=[1] * n, time=1.0, cost=[1] * n, obstacle=[ball], collision={"capsules": "urdf"}
    )


def test_bodies_are_the_models_of_the_urdf():
    robot = costate.Robot.from_text(ROD)
    beside = problem(robot, 0.2 + 1e-6)
    assert beside.solve(verify="none").keeps_limits
    assert pickle.loads(pickle.dumps(beside)) == beside
    with pytest.raises(costate.ProblemError, match="clearance of 'rod'") as caught:
        problem(robot, 0.2 - 1e-6)
    assert caught.value.key == "end.q"


def test_a_mesh_and_a_robot_without_a_urdf_are_refused():
    mesh = ROD.replace('<cylinder radius="0.1" length="1"/>', '<mesh filename="rod.stl"/>')
    for robot, words, n in [
        (costate.Robot.from_text(mesh), r"link 'rod'.*mesh rod\.stl", 1),
        (load("two_link.toml"), "not read from a URDF", 2),
    ]:
        with pytest.raises(costate.ProblemError, match=words) as caught:
            problem(robot, 0.3, n)
        assert caught.value.key == "collision.capsules"
