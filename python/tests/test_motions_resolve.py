"""Solving again: agreement with solving anew, feedback, memory, threads."""

import math
import mmap
import sys
import threading

import costate
import numpy as np
import pytest
from conftest import QUARTER, assert_close


def problem_of(arm, start, end, **tables) -> costate.Problem:
    tables = {"cost": [1, 1], "limits": {"v_max": [math.inf, 7.0], "from_robot": False}} | tables
    return costate.Problem(arm, start=start, end=end, time=1.0, **tables)


def test_solving_again_agrees_with_solving_anew(arm):
    motion = problem_of(arm, [0, 0], [QUARTER, QUARTER]).resolve(tolerance=1e-8, nodes=121)
    first = motion.solve()
    assert first.status == "solved" and first.keeps_limits and abs(first.cost - 155.74483972) < 2e-2
    rng = np.random.default_rng(3)
    for _ in range(5):
        q, v = 0.05 * rng.normal(size=2), 0.1 * rng.normal(size=2)
        end = np.array([QUARTER, QUARTER]) + 0.05 * rng.normal(size=2)
        motion.set_start(q, v)
        motion.set_end(end, [0.0, 0.0])
        again = motion.solve(steps=60, seconds=30)
        anew = costate.Resolve(problem_of(arm, {"q": q, "v": v}, end), tolerance=1e-8, nodes=121)
        assert again.status == "solved" and again.keeps_limits
        assert abs(again.cost - anew.solve().cost) < 1e-6 * again.cost
        times = np.linspace(0, 1, 50)
        for ours, theirs in zip(motion.state(times)[:2], anew.state(times)[:2], strict=True):
            assert_close(ours, theirs, 1e-3)  # the root of the tolerance, ten times
        solution = problem_of(arm, {"q": q, "v": v}, end).solve()
        assert abs(again.cost - solution.cost) < 1e-3 * again.cost
        assert_close(motion.state(0.0)[0], q, 1e-12)
        assert_close(motion.state(motion.final_time)[0], end, 1e-12)
    assert motion.torques(0.3).shape == (2,) and motion.torques(times).shape == (50, 2)


def test_feedback_is_the_derivative_by_the_start(arm):
    problem = problem_of(arm, [0, 0], [QUARTER, QUARTER], limits=False)
    motion = costate.Resolve(problem, tolerance=1e-9, nodes=61)
    for early in (motion.feedback, lambda: motion.state(0.0), lambda: motion.derivative_by("q_max", 0)):
        with pytest.raises(costate.MotionError, match="call solve first"):
            early()
    motion.solve()
    feedback = motion.feedback()
    points = len(feedback.t)
    assert feedback.states_by_start.shape == (points, 4, 4) and feedback.torques_by_end.shape == (points, 2, 4)
    assert feedback.gain(0.1).shape == (2, 4) and feedback.gain([0.1, 0.2]).shape == (2, 2, 4)
    # Central differences of motions that are solved again.
    step, base = 1e-4, np.zeros(4)
    columns = []
    for k in range(4):
        both = []
        for sign in (1, -1):
            x = base + sign * step * np.eye(4)[k]
            motion.set_start(x[:2], x[2:])
            assert motion.solve().status == "solved"
            both.append((motion.torques(feedback.t), motion.solve().cost))
        columns.append([(both[0][i] - both[1][i]) / (2 * step) for i in range(2)])
    torques = np.stack([column[0] for column in columns], axis=-1)
    assert_close(feedback.torques_by_start, torques, 1e-3)
    assert_close(feedback.cost_gradient, [column[1] for column in columns], 1e-5)
    assert_close(feedback.cost_hessian, feedback.cost_hessian.T, 1e-9)
    assert_close(feedback.final_time_by_start, np.zeros(4))


def test_derivatives_by_a_limit(arm):
    cost = {}
    for limit in (7.0, 7.001, 6.999):
        limits = {"v_max": [math.inf, limit], "from_robot": False}
        motion = problem_of(arm, [0, 0], [QUARTER, QUARTER], limits=limits).resolve(tolerance=1e-9, nodes=121)
        cost[limit] = motion.solve().cost
        if limit == 7.0:
            found = motion.derivative_by("v_max", "elbow")
            assert motion.derivative_by("v_max", 1).cost == found.cost
            for wrong in (("v_max", "wrist"), ("speed", 0), ("q_min", 0)):
                with pytest.raises(costate.ArgumentError):
                    motion.derivative_by(*wrong)
            heavier = motion.derivative_by_mass("elbow", 1.0, [1.0, 0.0, 0.0])
            assert heavier.cost > 0 and heavier.torques.shape == (120, 2) and heavier.states.shape == (120, 4)
    assert abs(found.cost - (cost[7.001] - cost[6.999]) / 2e-3) < 1e-2 * abs(found.cost)


def test_derivatives_by_the_radius_of_an_obstacle(arm):
    body = {"margin": 0.0, "capsule": [{"frame": arm.frame_names[-1], "radius": 0.0, "from": [1, 0, 0]}]}
    disc = {"kind": "sphere", "xyz": [0.34, 0.59, 0], "radius": 0.25}
    problem = problem_of(arm, [0, 0], [QUARTER, QUARTER], limits=False, obstacle=[disc], collision=body)
    motion = problem.resolve(tolerance=1e-9, nodes=121)
    assert motion.solve(steps=300).keeps_limits
    # A larger disc, a thicker tip and a margin are the same.
    found, margin = motion.derivative_by_task("obstacle", 0), motion.derivative_by_task("margin")
    assert found.cost > 0 and abs(found.cost - margin.cost) < 1e-6 * found.cost
    for wrong in (("keep", 0), ("obstacle", 1), ("disc", 0)):
        with pytest.raises(costate.ArgumentError):
            motion.derivative_by_task(*wrong)


def test_the_rest_of_an_optimal_motion_is_optimal(arm):
    problem = costate.Problem(
        arm, start=[0, 0], end=[1.5, 1.0], time={"free": True, "guess": 2.0}, cost={"time": 20.0, "effort": [1, 1]},
        limits={"torque_max": [12.0, 5.0], "from_robot": False},
    )  # fmt: skip
    motion = problem.resolve(tolerance=1e-6, nodes=73)
    motion.solve()
    whole = motion.final_time
    q, v, _ = motion.state(0.1)
    motion.advance(0.1)
    motion.set_start(q, v)
    again = motion.solve(steps=20)
    assert again.status == "solved" and abs(motion.final_time - (whole - 0.1)) < 1e-3
    assert motion.problem == problem


def test_jerks_and_vias(arm):
    problem = problem_of(arm, [0, 0], [1, 1], limits={"jerk_max": [100.0, 100.0], "from_robot": False})
    motion = problem.resolve(nodes=33)
    assert motion.solve().status == "solved"
    feedback = motion.feedback()
    assert feedback.states_by_start.shape[1:] == (6, 6) and feedback.gain(0.3) is None
    assert motion.derivative_by("jerk_max", 0).states.shape[1:] == (6,)
    with pytest.raises(costate.ArgumentError, match="free"):
        motion.set_start_acceleration([0.0, 0.0])
    rest = {"a": [0.0, 0.0]}
    smooth = problem_of(arm, {"q": [0, 0]} | rest, {"q": [1, 1]} | rest, limits={"jerk_max": [300.0] * 2, "from_robot": False})
    motion = smooth.resolve(nodes=49)
    assert motion.solve().status == "solved"
    motion.set_start_acceleration([0.5, -0.2])
    motion.set_end_acceleration([-0.3, 0.1])
    assert motion.solve().status == "solved"
    assert np.allclose(motion.state(0.0)[2], [0.5, -0.2]) and np.allclose(motion.state(1.0)[2], [-0.3, 0.1])
    motion = problem_of(arm, [0, 0], [1, 1], via=[{"q": [0.3, 0.6]}]).resolve(nodes=37)
    assert motion.solve().status == "solved"
    motion.set_via(0, [0.35, 0.6], [0.0, 0.0])
    assert motion.solve().status == "solved"
    with pytest.raises(costate.ArgumentError):
        motion.set_via(1, [0.35, 0.6], [0.0, 0.0])


def test_what_cannot_be_solved_again(arm):
    with pytest.raises(costate.ProblemError) as caught:
        problem_of(arm, [0, 0], [1, 1]).resolve(nodes=1)
    assert caught.value.key == "solver.nodes"
    motion = problem_of(arm, [0, 0], [1, 1]).resolve()
    with pytest.raises(costate.MotionError, match="solve"):
        motion.state(0.0)
    assert np.isnan(motion.final_time) and "Resolve(Problem('two_link'" in repr(motion)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
def test_memory_stays_flat_in_ten_thousand_solves(arm):
    def pages() -> int:
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1])

    motion = problem_of(arm, [0, 0], [QUARTER, QUARTER]).resolve(tolerance=1e-2, nodes=31)
    motion.solve()

    def rounds(count: int) -> None:
        for k in range(count):
            motion.set_start([0.05 * math.sin(k), 0.05 * math.cos(k)], [0.0, 0.0])
            motion.solve(steps=3)
            motion.torques([0.0, 0.01])
            motion.feedback()

    rounds(500)
    before = pages()
    rounds(10_000)
    assert (pages() - before) * mmap.PAGESIZE < 2 << 20


def test_threads_wait_for_each_other(arm):
    motion = problem_of(arm, [0, 0], [QUARTER, QUARTER]).resolve(tolerance=1e-4, nodes=31)
    motion.solve()
    found, failed = [], []

    def work(sign: float) -> None:
        try:
            for _ in range(200):
                motion.set_start([0.05 * sign, 0.0], [0.0, 0.0])
                found.append(motion.solve(steps=20))
                assert motion.torques(0.5).shape == (2,)
        except BaseException as error:  # noqa: BLE001
            failed.append(error)

    threads = [threading.Thread(target=work, args=(sign,)) for sign in (-1.0, 1.0, 0.5)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failed and len(found) == 600
    # Each solve is that of one of the three starts.
    alone = []
    for sign in (-1.0, 1.0, 0.5):
        anew = problem_of(arm, [0.05 * sign, 0.0], [QUARTER, QUARTER]).resolve(tolerance=1e-4, nodes=31)
        alone.append(anew.solve().cost)
    costs = np.array([resolved.cost for resolved in found if resolved.status == "solved"])
    assert len(costs) > 590 and np.abs(costs[:, None] / alone - 1).min(axis=1).max() < 1e-3
