"""Optimal motions: their values are published or follow from other equations."""

import json
import math
import pickle
from html import escape

import costate
import numpy as np
import pytest
from conftest import PROBLEMS, QUARTER, assert_close, load


def arrives(robot: costate.Robot, solution: costate.Solution, steps: int) -> np.ndarray:
    """(q, v) at the end by the classical Runge-Kutta scheme, with the torques that the motion is sampled with."""
    dynamics = costate.Dynamics(robot)
    h = solution.final_time / steps
    tau = solution.sample(times=np.linspace(0.0, solution.final_time, 2 * steps + 1)).tau
    n = robot.n
    x = np.concatenate([solution.q[0], solution.v[0]])
    f = lambda x, tau: dynamics.f(x[:n], x[n:], tau)
    for k in range(steps):
        k1 = f(x, tau[2 * k])
        k2 = f(x + h / 2 * k1, tau[2 * k + 1])
        k3 = f(x + h / 2 * k2, tau[2 * k + 1])
        k4 = f(x + h * k3, tau[2 * k + 2])
        x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return x


def test_the_file_of_the_two_link_arm(arm):
    problem = costate.Problem.from_file(PROBLEMS / "two_link.toml")
    solution = problem.solve()
    assert solution.status == "converged" and solution.converged and solution.solved and solution.check() is solution
    assert abs(solution.cost - 145.13113754) < 1e-6 and solution.final_time == 1.0
    assert solution.certificate == "local_minimum" and solution.conjugate_time is None
    assert solution.verification == "full" and solution.end_defect < 1e-6 and solution.shooting_defect < 1e-6
    # Errors of polished motions are estimated for each component; that of the direct one is told, and not smaller than
    # the real one.
    direct = problem.solve(polish=False)
    assert np.isnan(solution.cost_error) and abs(direct.cost / 145.13113754 - 1) < direct.cost_error < 1e-6
    # H* is constant, and J T^3 is: dJ/dT = -3 J/T = -H*.
    assert abs(solution.hamiltonian_mean - 3 * 145.13113754) < 1e-5 and solution.hamiltonian_drift < 1e-6
    tables = {"start": [0, 0], "end": [QUARTER, QUARTER], "time": 1, "cost": [1.0, 1.0]}
    assert problem == costate.Problem(arm, **tables, solver={"tolerance": 1e-6}) != costate.Problem(arm, **tables)
    assert_close(arrives(arm, solution, 400), [QUARTER, QUARTER, 0, 0], 1e-6)
    # y(0) = -dJ/dx(0), and u = y_p.
    assert_close(solution.costates[:, 2:], solution.tau, 1e-9)
    assert_close(solution.p, costate.Dynamics(arm).momentum(solution.q, solution.v), 1e-9)
    assert_close(solution.a, costate.Dynamics(arm).aba(solution.q, solution.v, solution.tau), 1e-9)


def test_the_swing_up_of_a_pendulum():
    solution = costate.Problem.from_file(PROBLEMS / "pendulum_swing_up.toml").solve(tolerance=1e-9)
    assert abs(solution.cost - 74.06165922) < 1e-7
    assert_close(solution.costates[0], [-13.0359585405, 18.0717345307], 1e-7)


@pytest.mark.parametrize("method", ["collocation", "shooting"])
def test_the_indirect_methods_agree(arm, method):
    problem = costate.Problem(arm, start=[0, 0], end=[QUARTER, QUARTER], time=1.0, cost=[1, 1])
    solution = problem.solve(method=method, tolerance=1e-8)
    assert solution.converged and abs(solution.cost - 145.13113754) < 1e-7


def test_limits_are_kept_and_reported(limited, solved):
    assert solved.converged and abs(solved.cost - 155.74483972) < 2e-5
    assert list(solved.limits) == ["rate"] and solved.infeasible is None
    rate = solved.limits["rate"]
    assert rate["at_points"] < 1e-6 and {(span["joint"], span["side"]) for span in rate["active"]} == {("elbow", "max")}
    assert np.abs(solved.sample(1000).v[:, 1]).max() < 7 * (1 + 1e-4)
    assert solved.polish["outcome"] == "limited" and len(solved.errors) == 1 and solved.errors[0] < 1e-7
    text, page = str(solved), solved._repr_html_()
    assert "converged" in text and "rate limits" in text and "<table>" in page and "two_link" in page
    assert repr(solved).startswith("Solution('converged', cost=155.7448")


def test_sampled_torques_lead_to_the_end(ur5):
    problem = costate.Problem.from_file(PROBLEMS / "ur5_limits.toml")
    solution = problem.solve()
    # Its file has no rotors; no limit is exceeded.
    assert solution.check() is solution and {remark.key for remark in solution.warnings} == {"sudden_acceleration"}
    end = np.concatenate([[1.5, -1.0, 1.2, -1.5, -1.57, 0.5], np.zeros(6)])
    assert np.abs(arrives(problem.robot, solution, 8000) - end).max() < 3e-3
    samples = solution.sample(1000)
    assert samples.t[0] == 0.0 and samples.t[-1] == 1.0 and len(samples) == 1001 and samples.q.shape == (1001, 6)
    # Jumps of accelerations lie in few intervals; elsewhere the rows belong together.
    tau = costate.Dynamics(problem.robot).rnea(samples.q, samples.v, samples.a)
    assert np.median(np.abs(tau - samples.tau)) < 1e-9
    assert (np.abs(samples.v) <= problem.robot.velocity_limits * (1 + 2e-4)).all()  # 1e-4 of both sides together
    assert (np.abs(samples.tau) <= problem.robot.effort_limits).all()


def test_free_time_and_least_time():
    # A double integrator from rest to rest, |u| <= 1: T = 2 sqrt(d m).
    robot = costate.Robot.builder("cart", gravity=[0, 0, 0]).prismatic("rail", axis=[1, 0, 0], mass=2).build()
    limits = {"torque_max": [1.0]}
    time = {"free": True, "guess": 4.0}
    problem = costate.Problem(robot, start=[0], end=[3], time=time, cost={"time": 1.0}, limits=limits)
    solution = problem.solve(tolerance=1e-6)
    assert solution.solved and abs(solution.final_time - 2 * math.sqrt(6)) < 1e-4
    assert abs(solution.cost - solution.final_time) < 1e-9
    # With cost 1 and u^2/2: (6 m^2 d^2) 3/T^4 = 1.
    free = costate.Problem(robot, start=[0], end=[3], time=time, cost={"time": 1.0, "effort": [1.0]})
    free = free.solve(tolerance=1e-6)
    assert abs(free.final_time - (3 * 6 * 4 * 9) ** 0.25) < 1e-5


def test_vias_tools_obstacles_and_payloads():
    solution = costate.Problem.from_file(PROBLEMS / "ur5_pick_and_place.toml").solve()
    assert solution.solved and solution.keeps_limits and len(solution.via_times) == 3
    samples = solution.sample(500)
    assert set(samples.phase) == {1, 2, 3, 4} and (np.diff(samples.phase) >= 0).all()
    assert "phase" in samples.to_csv().splitlines()[0]
    follow = costate.Problem.from_file(PROBLEMS / "panda_reach.toml")
    solution = follow.solve()
    assert solution.solved and "task" in solution.limits


def test_a_branch_of_solutions():
    problem = costate.Problem.from_file(PROBLEMS / "pendulum_swing_up.toml")
    branch = problem.follow("gravity", 0.0, 1.0, tolerance=1e-9)
    # Without gravity 6 (m d)^2/T^3, with it the value of the file.
    assert branch.reached and branch.parameter[0] == 0.0 and branch.parameter[-1] == 1.0 and len(branch) > 1
    assert abs(branch.cost[0] - 6 * math.pi**2) < 1e-7 and abs(branch.cost[-1] - 74.06165922) < 1e-7
    assert branch.solution.converged and branch.turning_points == [] and branch.solution.problem == problem
    faster = problem.with_parameter("final_time", 0.5)
    assert faster != problem and faster.solve().final_time == 0.5 and pickle.loads(pickle.dumps(faster)) == faster
    free = problem.with_parameter("gravity", 0.0)
    assert (free.robot.gravity == 0).all() and pickle.loads(pickle.dumps(free.robot)) == free.robot
    for wrong in (("bounds", 1.0), ("final_time", -1.0)):
        with pytest.raises(costate.ProblemError):
            problem.with_parameter(*wrong)
    with pytest.raises(costate.ArgumentError, match="armature"):
        problem.follow("mass", 0, 1)
    with pytest.raises(costate.ProblemError):
        problem.follow("gravity", 1, 1)


def test_infeasible_problems_say_what_has_to_give(arm):
    limits = {"torque_max": [2.0, 2.0], "from_robot": False}
    problem = costate.Problem(arm, start=[0, 0], end=[QUARTER, QUARTER], time=1.0, cost=[1, 1], limits=limits)
    solution = problem.solve()
    assert solution.status == "locally_infeasible" and not solution.solved
    assert {limit["kind"] for limit in solution.infeasible["limits"]} == {"torque"}
    longer = solution.infeasible["final_time"]
    again = costate.Problem(arm, start=[0, 0], end=[QUARTER, QUARTER], time=longer, cost=[1, 1], limits=limits)
    assert longer > 1.0 and again.solve().solved
    with pytest.raises(costate.MotionError, match="infeasible"):
        solution.check()
    assert "beyond its limit" in solution.message and not solution.infeasible["is_global"]
    assert solution.message in str(solution) and solution.message[:20] in solution._repr_html_()


def test_everything_that_is_said_is_one_list(arm):
    limits = {"v_max": [0.5, 0.5], "from_robot": False}
    slow = costate.Problem(arm, start=[0, 0], end=[QUARTER, QUARTER], time=1.0, cost=[1, 1], limits=limits).solve()
    [remark] = slow.warnings
    assert remark == slow.message and (remark.key, remark.severity) == ("not_solved", "error")
    # Both joints need as long: the proof names the first one, and so do the numbers.
    assert (remark.joint, remark.kind, remark.unit) == ("shoulder", "rate", "rad/s") and remark.limit == 0.5
    assert "joint 'shoulder' needs" in remark
    with pytest.raises(costate.MotionError) as raised:
        slow.check()
    assert remark in str(raised.value) and remark in str(slow) and escape(remark) in slow._repr_html_()
    [saved] = json.loads(slow.to_json())["warnings"]
    assert saved["text"] == remark and saved["key"] == remark.key and pickle.loads(pickle.dumps(remark)).key == remark.key
    good = costate.Problem(arm, start=[0, 0], end=[QUARTER, QUARTER], time=1.0, cost=[1, 1], limits=False).solve()
    assert good.warnings == [] and good.check() is good and json.loads(good.to_json())["warnings"] == []


def test_starts_do_not_depend_on_threads(arm):
    problem = costate.Problem(arm, start=[0, 0], end=[QUARTER, QUARTER], time=1.0, cost=[1, 1])
    one, two = (problem.solve(starts=3, threads=threads) for threads in (1, 2))
    assert one.cost == two.cost and one.starts == two.starts and len(one.starts) == 3
    assert (one.q == two.q).all() and (one.costates == two.costates).all()


def test_a_time_limit_keeps_the_best_motion(ur5):
    problem = costate.Problem.from_file(PROBLEMS / "ur5_reach.toml")
    solution = problem.solve(time_limit=1e-3)
    assert solution.status == "time_limit" and not solution.solved


def test_switches_and_penalties_are_told():
    # A mass of 1 kg by 1 m with at most 1 N: T = 2 s, and the force turns round at half time.
    solution = costate.Problem.from_file(PROBLEMS / "double_integrator_min_time.toml").solve()
    assert abs(solution.final_time - 2) < 1e-6 and np.abs(np.array(solution.switches) - 1).max() < 1e-6
    assert len(solution.switches) == 1 and solution.penalty_cost == 0
    arm = load("two_link.toml")
    penalty = {"weight": 1.0, "v_max": [2.0, 2.0]}
    tables = {"start": [0, 0], "end": [1.5, 1.0], "time": 1.0, "cost": [1, 1], "limits": False}
    direct, indirect = (
        costate.Problem(arm, **tables, penalty=penalty).solve(method=method, tolerance=1e-6) for method in ("direct", "collocation")
    )
    assert direct.penalty_cost > 1 and abs(direct.penalty_cost - indirect.penalty_cost) < 1e-4 * direct.penalty_cost
    assert costate.Problem(arm, **tables).solve().cost < direct.cost
