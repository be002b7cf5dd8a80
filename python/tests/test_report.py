"""The report of a solution as a page."""

import json
import pickle
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

import costate
from conftest import load
from costate._svg import ticks

ROBOTS = Path(__file__).parents[2] / "robots"


@pytest.fixture(scope="module")
def solution():
    robot = costate.Robot.from_file(ROBOTS / "ur5.urdf")
    return costate.Problem(robot, start=[0.0] * 6, end=[0.4] * 6, time=1.0, cost=[1.0] * 6, limits=True).solve()


def test_page_is_complete(solution, tmp_path):
    page = solution.to_html(tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text(encoding="utf-8") == page
    assert page.startswith("<!doctype html>") and "shoulder_pan_joint" in page and "http://" not in page.split("<script")[0]


def shapes(solution, robot):
    """What is drawn of the links of a solution for a robot that looks like this."""
    text, missing = solution._core.stage(robot, None, [])
    assert missing == []
    return [body["shape"]["kind"] for body in json.loads(text)["bodies"]]


def test_visual_models_are_read(solution, tmp_path):
    text = (ROBOTS / "ur5.urdf").read_text(encoding="utf-8")
    shown = """<visual><geometry><box size="0.1 0.2 0.3"/></geometry></visual>"""
    mesh = """<visual><geometry><mesh filename="package://nowhere/arm.stl"/></geometry></visual>"""
    first = text.index('<link name="shoulder_link">') + len('<link name="shoulder_link">')
    (tmp_path / "shown.urdf").write_text(text[:first] + shown + mesh + text[first:], encoding="utf-8")
    with pytest.warns(UserWarning, match="nowhere"):
        page = solution.to_html(urdf=tmp_path / "shown.urdf", package_path=[tmp_path])
    assert page != solution.to_html()
    # Without being asked, those of the file that the robot was read from, also after it was changed; a pickle has them too.
    bodies = text.count("<visual>")
    robot = costate.Robot.from_file(ROBOTS / "ur5.urdf")
    asked = costate.Problem.from_file(ROBOTS.parent / "examples" / "problems" / "ur5_limits.toml").robot
    changed = robot.with_armature("elbow_joint", 0.1)
    for of in (robot, changed, pickle.loads(pickle.dumps(robot)), costate.Robot.from_text(text), asked):
        assert shapes(solution, of).count("cylinder") == bodies
    # A robot that was not read from a URDF has capsules.
    assert set(shapes(solution, load("puma560.toml"))) == {"capsule"}
    broken = costate.Robot.from_text(text.replace('radius="0.075"', 'radius="wide"'))
    _, missing = solution._core.stage(broken, None, [])
    assert "visual models are left out" in missing[0]
    with pytest.raises(costate.RobotError):
        solution.to_html(urdf=Path(__file__))
    with pytest.raises(OSError):
        solution.to_html(urdf=tmp_path / "none.urdf")


def test_message_says_what_would_have_to_give():
    robot = costate.Robot.from_file(ROBOTS / "ur5.urdf")
    found = costate.Problem(robot, start=[0.0] * 6, end=[1.0] * 6, time=0.1, cost=[1.0] * 6, limits=True).solve()
    assert found.status == "infeasible" and "shoulder_pan_joint" in found.message


def test_notebooks_show_figures_and_a_picture(solution):
    """The picture is SVG of its own: a curve for each joint in both plots, limits where the motion is near them."""
    shown = solution._repr_html_()
    picture = ElementTree.fromstring(shown[shown.index("<svg") : shown.index("</svg>") + 6])
    kinds = [part.get("class") for part in picture]
    assert kinds.count("curve") == 12 and "<table>" in shown
    words = [part.text for part in picture if part.text]
    assert {"q (rad, m)", "tau (N m, N)", "t (s)"} < set(words) and set(solution.problem.robot.joint_names) < set(words)
    points = [part.get("points").split() for part in picture if part.get("class") == "curve"]
    width, height = float(picture.get("width")), float(picture.get("height"))
    corners = np.array([[float(x) for x in point.split(",")] for row in points for point in row])
    assert (corners > 0).all() and (corners < [width, height]).all()
    # Curves are those of the motion: the middle one starts at q = 0 and rises.
    first = np.array([[float(x) for x in point.split(",")] for point in points[0]])
    q = solution.sample(times=np.linspace(0, solution.final_time, 101)).q[:, 0]
    assert np.corrcoef(-first[:, 1], q)[0, 1] > 0.99999 and (np.diff(first[:, 0]) > 0).all()


def test_limits_are_drawn_where_the_motion_comes_near_them():
    robot = costate.Robot.builder("arm").revolute("hinge", axis=[0, 0, 1], mass=1, com=[1, 0, 0], upper=1.0, effort=4.2).build()
    solution = costate.Problem(robot, start=[0.0], end=[1.0], time=1.0, cost=[1.0], limits=True).solve().check()
    shown = solution._repr_html_()
    assert shown.count('class="limit"') == 3           # q at its upper limit, the torque near both
    joint = robot.builder("<&>").revolute("a<b>&c", axis=[0, 0, 1], mass=1, com=[1, 0, 0]).build()
    shown = costate.Problem(joint, start=[0.0], end=[1.0], time=1.0, cost=[1.0]).solve()._repr_html_()
    assert "a<b>" not in shown and "a&lt;b&gt;&amp;c" in shown and 'class="limit"' not in shown


def test_round_numbers_of_axes():
    assert np.allclose(ticks(-0.1, 1.1, 5), [0, 0.5, 1.0]) and np.allclose(ticks(17, 33, 4), [20, 25, 30])


def test_a_task_without_a_motion_has_no_picture():
    robot = costate.Robot.from_file(ROBOTS / "ur5.urdf")
    found = costate.Problem(robot, start=[0.0] * 6, end=[1.0] * 6, time=0.1, cost=[1.0] * 6, limits=True).solve()
    assert "<svg" in found._repr_html_() or not len(found.t)
