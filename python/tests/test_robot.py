"""Robots: reading, building, changing, warnings, errors, pickles."""

import copy
import pickle
import warnings

import costate
import numpy as np
import pytest
from conftest import ROBOTS, assert_close, load, pendulum


def test_files_and_texts_give_the_same_robot(ur5):
    text = (ROBOTS / "ur5.urdf").read_text()
    assert costate.Robot.from_text(text, "urdf") == ur5 == costate.Robot.from_text(text)
    assert (ur5.name, ur5.n, len(ur5.joint_names)) == ("ur5", 6, 6)
    assert ur5.joint_kinds == ["revolute"] * 6 and "tool0" in ur5.frame_names
    assert_close(ur5.gravity, [0, 0, -9.81], 1e-15)
    assert ur5.position_limits.shape == (2, 6) and (ur5.position_limits[0] < ur5.position_limits[1]).all()
    assert (ur5.velocity_limits > 0).all() and (ur5.effort_limits > 0).all()
    assert "n=6" in repr(ur5)


def test_warnings_are_python_warnings():
    with pytest.warns(costate.RobotWarning, match="puma560") as caught:
        robot = costate.Robot.from_file(ROBOTS / "puma560.toml")
    assert len(caught) == len(robot.warnings) == 2
    # A change does not repeat them.
    changed = robot.with_gravity([0, 0, 0])
    assert changed.warnings == robot.warnings
    with pytest.raises(costate.RobotError, match="rigid body"):
        costate.Robot.from_file(ROBOTS / "puma560.toml", strict=True)


def test_errors_say_where(tmp_path):
    file = tmp_path / "broken.urdf"
    file.write_text("<robot name='r'>\n<link name='a'/>\n<joint name='j' type='revolute'>\n</joint>\n</robot>")
    with pytest.raises(costate.RobotError, match="broken.urdf") as raised:
        costate.Robot.from_file(file)
    assert raised.value.path == str(file) and raised.value.line == 3
    with pytest.raises(FileNotFoundError) as raised:
        costate.Robot.from_file(tmp_path / "missing.urdf")
    assert raised.value.filename == str(tmp_path / "missing.urdf")
    with pytest.raises(costate.RobotError, match=r"\.urdf"):
        (tmp_path / "robot.txt").write_text("x")
        costate.Robot.from_file(tmp_path / "robot.txt")
    with pytest.raises(costate.ArgumentError, match="'urdf' or 'toml'"):
        costate.Robot.from_text("<robot/>", "sdf")
    assert issubclass(costate.RobotError, costate.CostateError) and issubclass(costate.CostateError, ValueError)


def test_unknown_joints_are_named(ur5):
    with pytest.raises(costate.RobotError, match="'elbow_joint'") as raised:
        ur5.lock({"elbow_jont": 0.0})
    assert raised.value.culprit == "elbow_jont"
    with pytest.raises(costate.RobotError, match="is -1; it must be 0"):
        ur5.with_armature("elbow_joint", -1.0)
    with pytest.raises(costate.RobotError):
        costate.Robot.builder("loop").revolute("a", on="b", mass=1).revolute("b", on="a", mass=1).build()
    with pytest.raises(costate.ArgumentError, match="xx, yy, zz"):
        ur5.with_payload("tool0", 1.0, inertia=[1.0])


def test_locked_joints_stay_where_they_are(ur5, random):
    q = random.normal(size=6)
    held = {name: q[k] for k, name in enumerate(ur5.joint_names) if k in (1, 4)}
    locked = ur5.lock(held)
    keep = [0, 2, 3, 5]
    assert locked.joint_names == [ur5.joint_names[k] for k in keep]
    assert locked == ur5.reduced_to(locked.joint_names, q.tolist())
    whole, part = costate.Dynamics(ur5), costate.Dynamics(locked)
    assert_close(part.crba(q[keep]), whole.crba(q)[np.ix_(keep, keep)], 1e-13)
    assert_close(part.frame("tool0").pose(q[keep])[1], whole.frame("tool0").pose(q)[1], 1e-13)


def test_a_payload_is_lifted(ur5, random):
    q = random.normal(size=6)
    mass, com = 2.5, [0.02, -0.01, 0.1]
    loaded = ur5.with_payload("tool0", mass, com, [0.01, 0.02, 0.03])
    assert_close(loaded.mass, ur5.mass + mass, 1e-15)
    zero = np.zeros(6)
    more = costate.Dynamics(loaded).rnea(q, zero, zero) - costate.Dynamics(ur5).rnea(q, zero, zero)
    load = costate.Dynamics(ur5.add_frame("load", "tool0", com)).frame("load")
    assert_close(more, mass * 9.81 * load.jacobian(q)[5], 1e-11)


def test_gravity_armature_and_friction(ur5, random):
    q, v, a = random.normal(size=(3, 6))
    dynamics = costate.Dynamics(ur5)
    floating = costate.Dynamics(ur5.with_gravity([0, 0, 0]))
    assert_close(floating.rnea(q, np.zeros(6), np.zeros(6)) + 1, np.ones(6), 1e-15)
    geared = ur5.with_armature("elbow_joint", 0.7)
    assert_close(costate.Dynamics(geared).crba(q) - dynamics.crba(q) + np.eye(6), np.diag([1, 1, 1.7, 1, 1, 1]), 1e-14)
    assert geared.armature[2, 2] == 0.7
    rough = ur5.with_friction("elbow_joint", viscous=3.0, coulomb=2.0, coulomb_velocity=0.1)
    more = costate.Dynamics(rough).rnea(q, v, a) - dynamics.rnea(q, v, a)
    expected = np.zeros(6)
    expected[2] = 3.0 * v[2] + 2.0 * np.tanh(v[2] / 0.1)
    assert_close(more, expected, 1e-12)
    limited = ur5.with_limits("elbow_joint", upper=1.0)
    assert limited.position_limits[1, 2] == 1.0 and limited.position_limits[0, 2] == ur5.position_limits[0, 2]


def test_built_robots_are_those_of_files():
    robot = costate.Robot.from_text(
        "name = 'arm'\n[[joint]]\nname = 'a'\nmass = 1.0\ncom = [0.5, 0.0, 0.0]\n"
        "[[joint]]\nname = 'b'\nparent = 'a'\nplacement = { xyz = [1.0, 0.0, 0.0] }\nmass = 2.0\ncom = [0.3, 0.0, 0.0]\n"
    )
    builder = costate.Robot.builder("arm")
    builder.revolute("a", mass=1, com=[0.5, 0, 0]).revolute("b", on="a", xyz=[1, 0, 0], mass=2, com=[0.3, 0, 0])
    assert builder.build() == robot != pendulum()
    assert robot.parents == [None, "a"]
    # The builder can go on.
    assert builder.prismatic("c", on="b", mass=1).build().n == 3


def test_pickles_and_copies_are_equal(ur5):
    robots = [
        ur5,
        load("puma560.toml"),
        pendulum().with_friction("hinge", viscous=0.1),
        ur5.lock({"elbow_joint": 0.3}).add_frame("tip", "tool0", [0, 0, 0.1]).with_payload("tip", 1.5)
        .with_gravity([0, 1, -9]).with_armature("wrist_3_joint", 0.01).with_limits("wrist_3_joint", effort=3.0)
        .reduced_to(["wrist_3_joint", "shoulder_pan_joint"], [0.0, 1.0, 0.5, 0.2, 0.1]),
    ]  # fmt: skip
    for robot in robots:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # those of the robot were shown when it was read
            again = pickle.loads(pickle.dumps(robot))
        assert again == robot and again.warnings == robot.warnings and hash(again) == hash(robot)
        assert copy.copy(robot) is not None and copy.deepcopy(robot) == robot == copy.copy(robot)
    assert ur5 != robots[-1] and ur5 != 3
    dynamics = costate.Dynamics(ur5, "qp", on_error="nan", threads=2)
    again = pickle.loads(pickle.dumps(dynamics))
    assert again == dynamics and (again.coordinates, again.on_error, again.threads) == ("qp", "nan", 2)
    frame = pickle.loads(pickle.dumps(dynamics.frame("tool0", "local")))
    assert (frame.name, frame.axes) == ("tool0", "local")


def test_errors_survive_a_pickle(ur5):
    with pytest.raises(costate.NonFiniteState) as raised:
        costate.Dynamics(ur5).f(np.full(6, np.nan), np.zeros(6), np.zeros(6))
    again = pickle.loads(pickle.dumps(raised.value))
    assert str(again) == str(raised.value) and again.joint == raised.value.joint == "shoulder_pan_joint"


def test_notebooks_show_a_table(ur5):
    html = ur5._repr_html_()
    assert html.count("<tr>") == 7 and "elbow_joint" in html
    evil = costate.Robot.builder("<b>&").revolute("<script>", mass=1, com=[1, 0, 0]).build()._repr_html_()
    assert "<script>" not in evil and "&lt;script&gt;" in evil and "<b>&lt;b&gt;&amp;</b>" in evil
