"""The report of a solution as a page."""

from pathlib import Path

import pytest

import costate

ROBOTS = Path(__file__).parents[2] / "robots"


@pytest.fixture(scope="module")
def solution():
    robot = costate.Robot.from_file(ROBOTS / "ur5.urdf")
    return costate.Problem(robot, start=[0.0] * 6, end=[0.4] * 6, time=1.0, cost=[1.0] * 6, limits=True).solve()


def test_page_is_complete(solution, tmp_path):
    page = solution.to_html(tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text(encoding="utf-8") == page
    assert page.startswith("<!doctype html>") and "shoulder_pan_joint" in page and "http://" not in page.split("<script")[0]


def test_visual_models_are_read(solution, tmp_path):
    text = (ROBOTS / "ur5.urdf").read_text(encoding="utf-8")
    shown = """<visual><geometry><box size="0.1 0.2 0.3"/></geometry></visual>"""
    mesh = """<visual><geometry><mesh filename="package://nowhere/arm.stl"/></geometry></visual>"""
    first = text.index('<link name="shoulder_link">') + len('<link name="shoulder_link">')
    (tmp_path / "shown.urdf").write_text(text[:first] + shown + mesh + text[first:], encoding="utf-8")
    with pytest.warns(UserWarning, match="nowhere"):
        page = solution.to_html(urdf=tmp_path / "shown.urdf", package_path=[tmp_path])
    assert page != solution.to_html()
    with pytest.raises(costate.RobotError):
        solution.to_html(urdf=Path(__file__))
    with pytest.raises(OSError):
        solution.to_html(urdf=tmp_path / "none.urdf")


def test_message_says_what_would_have_to_give():
    robot = costate.Robot.from_file(ROBOTS / "ur5.urdf")
    found = costate.Problem(robot, start=[0.0] * 6, end=[1.0] * 6, time=0.1, cost=[1.0] * 6, limits=True).solve()
    assert found.status == "infeasible" and "shoulder_pan_joint" in found.message
