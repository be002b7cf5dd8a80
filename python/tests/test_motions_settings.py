"""What is set between two solves: references, obstacles, tools and their orientations, limits."""

import copy
import math
import pickle

import costate
import numpy as np
import pytest
from conftest import QUARTER, assert_close, load


def test_references_obstacles_and_tools_move():
    robot = load("two_link.toml")
    reference = {"times": [0, 0.5, 1], "positions": [[0, 0], [0.4, 0.2], [0, 0]], "weights": [1e3, 1e3]}
    of = lambda reference, **tables: costate.Problem(
        robot, start=[0, 0], end=[0, 0], time=1.0, cost={"effort": [1, 1], "reference": [reference]}, **tables
    )
    motion = of(reference).resolve(tolerance=1e-8)
    motion.solve()
    other = reference | {"positions": np.array([[0, 0], [-0.3, 0.1], [0, 0]])}
    motion.set_reference(0, other)
    assert abs(motion.solve().cost - of(other).resolve(tolerance=1e-8).solve().cost) < 1e-6
    motion.set_start_time(0.0)
    frame = robot.frame_names[-1]
    post = {"kind": "sphere", "xyz": [2.5, 0.0, 0.0], "radius": 0.2}
    body = {"capsule": [{"frame": frame, "radius": 0.05, "from": [1, 0, 0]}]}
    guarded = of(reference, obstacle=[post], collision=body).resolve(tolerance=1e-6)
    guarded.solve()
    guarded.set_obstacle(0, post, xyz=[2.6, 0.1, 0.0])
    assert guarded.solve().keeps_limits
    for call in (
        lambda: guarded.set_obstacle(1, post),
        lambda: guarded.set_obstacle(0, post, radius=0.3),
        lambda: motion.set_reference(3, other),
        lambda: motion.set_end_tool(0, [0, 0, 0]),
        lambda: motion.set_start([0.0], [0.0, 0.0]),
        lambda: motion.set_start([math.nan, 0.0], [0.0, 0.0]),
        lambda: motion.set_start_time(math.inf),
        lambda: motion.solve(seconds=-1.0),
    ):
        with pytest.raises(costate.ArgumentError):
            call()
    with pytest.raises(costate.ProblemError) as caught:
        guarded.set_obstacle(0, kind="sphere", xyz=[0, 0, 0])
    assert caught.value.key == "obstacle.radius"


def test_a_tool_follows_its_goal(ur5):
    q = [0.0, -1.6, 1.8, -1.8, -1.57, 0.0]
    frame = costate.Dynamics(ur5).frame("tool0")
    xyz = frame.pose(q)[1]
    problem = costate.Problem(
        ur5,
        start=q,
        end={"tool": {"frame": "tool0", "xyz": xyz + [0.1, 0.0, 0.0]}},
        time=1.0,
        cost=[1e-3] * 6,
        limits=True,
    )
    motion = problem.resolve(machine_code="at_once", tolerance=1e-4)
    assert motion.solve().status == "solved"
    for goal in (xyz + [0.12, 0.05, 0.0], xyz + [0.1, 0.0, 0.05]):
        motion.set_end_tool(0, goal)
        assert motion.solve().keeps_limits
        assert np.abs(frame.pose(motion.state(1.0)[0])[1] - goal).max() < 1e-6
    near = costate.Resolve(problem, near=problem.solve())
    assert near.solve().status == "solved"


def test_a_start_and_a_cost_of_tools_move(ur5):
    q, end = [0.0, -1.6, 1.8, -1.8, -1.57, 0.0], [0.3, -1.5, 1.7, -1.8, -1.57, 0.0]
    frame = costate.Dynamics(ur5).frame("tool0")
    xyz = frame.pose(q)[1]
    drawn = {"frame": "tool0", "xyz": xyz + [0.0, 0.1, 0.0], "position_weight": 10.0}
    start = {"q": q, "tool": {"frame": "tool0", "xyz": xyz}}
    of = lambda start, drawn: costate.Problem(
        ur5, start=start, end=end, time=1.0, cost={"effort": [1e-3] * 6, "tool": [drawn]}, limits=True
    ).resolve(machine_code="at_once", tolerance=1e-5)
    motion = of(start, drawn)
    first = motion.solve().cost
    other = xyz + [0.02, 0.0, 0.03]
    motion.set_start_tool(0, other)
    assert motion.solve().status == "solved" and np.abs(frame.pose(motion.state(0.0)[0])[1] - other).max() < 1e-9
    motion.set_tool_cost(0, xyz + [0.0, 0.3, 0.0])
    again = motion.solve()
    anew = of(start | {"tool": start["tool"] | {"xyz": other}}, drawn | {"xyz": xyz + [0.0, 0.3, 0.0]}).solve()
    assert again.status == anew.status == "solved" and abs(again.cost - anew.cost) < 1e-4 * anew.cost
    assert again.cost > 1.5 * first
    with pytest.raises(costate.ArgumentError):
        motion.set_start_tool(1, xyz)
    with pytest.raises(costate.ArgumentError):
        motion.set_tool_cost(1, xyz)


def test_orientations_of_tools_turn(ur5):
    """At the ends and in a cost, all axes or one, in all ways of saying it."""
    q = [0.0, -1.6, 1.8, -1.8, -1.57, 0.0]
    frame = costate.Dynamics(ur5).frame("tool0")
    rotation, xyz = frame.pose(q)
    turn = lambda angle: np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    of = lambda start, end, cost: costate.Problem(
        ur5, start={"q": q, "q_free": list(range(6)), "tool": {"frame": "tool0", "xyz": xyz} | start},
        end={"tool": {"frame": "tool0", "xyz": xyz + [0.05, 0.0, 0.0]} | end}, time=1.0, limits=True,
        cost={"effort": [1e-3] * 6, "tool": [{"frame": "tool0", "orientation_weight": 5.0} | cost]},
    ).resolve(machine_code="at_once", tolerance=1e-5)  # fmt: skip
    down, level = {"axis": [0, 0, 1], "along": rotation[:, 2]}, {"rotation": rotation}
    motion = of({"rotation": rotation}, down, level)
    first = motion.solve()
    assert first.status == "solved"
    start, along, cost = turn(0.2) @ rotation, turn(0.3) @ rotation[:, 2] + [0.05, 0.1, 0.0], turn(0.4) @ rotation
    motion.set_start_orientation(0, rotation=start)
    motion.set_end_orientation(0, {"axis": [0, 0, 1]}, along=along)
    motion.set_tool_cost_orientation(0, rotation=cost)
    again = motion.solve()
    assert again.status == "solved" and again.cost > first.cost
    assert_close(frame.pose(motion.state(0.0)[0])[0], start, 1e-7)
    there = frame.pose(motion.state(motion.final_time)[0])[0][:, 2]
    assert_close(there, along / np.linalg.norm(along), 1e-7)
    anew = of({"rotation": start}, {"axis": [0, 0, 1], "along": along}, {"rotation": cost}).solve()
    assert anew.status == "solved" and abs(again.cost - anew.cost) < 1e-3 * anew.cost
    copied = pickle.loads(pickle.dumps(motion))
    assert abs(copied.solve().cost - again.cost) < 1e-3 * again.cost
    for call in (
        lambda: motion.set_start_orientation(1, rotation=start),
        lambda: motion.set_start_orientation(0, along=[0, 0, 1]),
        lambda: motion.set_end_orientation(0, rpy=[0, 0, 0]),
        lambda: motion.set_tool_cost_orientation(1, rpy=[0, 0, 0]),
    ):
        with pytest.raises(costate.ArgumentError, match="tool"):
            call()
    for keys, wrong in (({"rpy": [0, 0]}, "rpy"), ({"angle": 1.0}, "angle"), ({}, "rpy"), ({"axis": [0, 0, 1]}, "axis")):
        with pytest.raises(costate.ProblemError) as caught:
            motion.set_start_orientation(0, keys)
        assert caught.value.key == f"tool.{wrong}"


def test_limits_move(arm):
    """Solving again under other limits agrees with a problem that has them."""
    of = lambda v, power: costate.Problem(
        arm, start=[0, 0], end=[QUARTER, QUARTER], time=1.0, cost=[1, 1],
        limits={"v_max": [math.inf, v], "total_power_max": power, "from_robot": False},
    ).resolve(tolerance=1e-8, nodes=121)  # fmt: skip
    motion = of(7.0, 400.0)
    first = motion.solve()
    motion.set_limit("v_max", 6.0, "elbow")
    motion.set_limit("total_power_max", 350.0)
    again, anew = motion.solve(), of(6.0, 350.0).solve()
    assert again.status == anew.status == "solved" and again.keeps_limits and again.clearance_violation == 0.0
    assert abs(again.cost - anew.cost) < 1e-5 * anew.cost and again.cost > first.cost
    assert np.abs(motion.state(np.linspace(0, 1, 301))[1][:, 1]).max() < 6.0 + 1e-3
    assert motion.derivative_by("total_power_max") is not None
    assert abs(copy.deepcopy(motion).solve().cost - again.cost) < 1e-5 * again.cost
    for wrong in (("v_max", -1.0, "elbow"), ("v_max", 5.0, "wrist"), ("v_max", 5.0, 0), ("speed", 5.0, 0), ("v_max", 5.0),
                  ("total_power_max", 5.0, 0), ("v_max", math.nan, 1)):  # fmt: skip
        with pytest.raises(costate.ArgumentError):
            motion.set_limit(*wrong)
    assert motion.solve().status == "solved"
