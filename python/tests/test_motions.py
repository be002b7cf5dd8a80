"""Optimal motions: problems, solutions, files. Values are published or follow from other equations."""

import json
import logging
import math
import pickle

import costate
import numpy as np
import pytest
from conftest import ROBOTS, assert_close, load

PROBLEMS = ROBOTS.parent / "examples" / "problems"
QUARTER = math.pi / 2


@pytest.fixture(scope="module")
def arm() -> costate.Robot:
    return load("two_link.toml")


@pytest.fixture(scope="module")
def limited(arm) -> costate.Problem:
    """A quarter turn of both joints in 1 s, with |v_2| <= 7."""
    limits = {"v_max": [math.inf, 7.0], "from_robot": False}
    return costate.Problem(arm, start=[0, 0], end=[QUARTER, QUARTER], time=1.0, cost=[1, 1], limits=limits)


@pytest.fixture(scope="module")
def solved(limited) -> costate.Solution:
    return limited.solve(tolerance=1e-7)


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
    # H* is constant, and J T^3 is: dJ/dT = -3 J/T = -H*.
    assert abs(solution.hamiltonian_mean - 3 * 145.13113754) < 1e-5 and solution.hamiltonian_drift < 1e-6
    assert problem == costate.Problem(arm, start=[0, 0], end=[QUARTER, QUARTER], time=1, cost=[1.0, 1.0])
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
    assert solution.converged and solution.warnings == []
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
    solution = problem.solve()
    assert solution.solved and abs(solution.final_time - 2 * math.sqrt(6)) < 1e-4
    assert abs(solution.cost - solution.final_time) < 1e-9
    # With cost 1 and u^2/2: (6 m^2 d^2) 3/T^4 = 1.
    free = costate.Problem(robot, start=[0], end=[3], time=time, cost={"time": 1.0, "effort": [1.0]}).solve()
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


def test_pickles_lose_nothing(limited, solved):
    again = pickle.loads(pickle.dumps(solved))
    assert again == solved and again.problem == limited and again.iterations == solved.iterations
    for name in ("t", "q", "v", "a", "p", "u", "tau", "costates", "hamiltonian", "errors"):
        assert (getattr(again, name) == getattr(solved, name)).all(), name
    times = np.linspace(0, 1, 77)
    for name in ("q", "v", "a", "tau"):
        assert (getattr(again.sample(times=times), name) == getattr(solved.sample(times=times), name)).all()
    polished = costate.Problem(limited.robot, start=[0, 0], end=[1, 0.5], time=1.0, cost=[1, 1]).solve()
    assert polished.polish["outcome"] == "polished"
    assert (pickle.loads(pickle.dumps(polished)).sample(100).q == polished.sample(100).q).all()
    with pytest.raises(costate.MotionError):
        costate.Solution.from_json(solved.to_json(), costate.Problem.from_file(PROBLEMS / "pendulum_swing_up.toml"))


def test_files_are_those_of_the_command(limited, solved, tmp_path):
    solved.save(tmp_path / "motion.json")
    saved = json.loads((tmp_path / "motion.json").read_text())
    assert saved == solved.to_dict() and saved["format"] == 1 and saved["joints"] == ["shoulder", "elbow"]
    assert saved["cost"] == solved.cost and saved["trajectory"]["q"] == solved.q.tolist()
    read = costate.Solution.load(tmp_path / "motion.json", limited)
    assert read.cost == solved.cost and (read.q == solved.q).all() and math.isnan(read.seconds)
    solved.save(tmp_path / "motion.csv", rate=100)
    lines = (tmp_path / "motion.csv").read_text().splitlines()
    assert lines[0].startswith("t,q_shoulder,q_elbow,v_shoulder") and len(lines) == 102
    table = np.loadtxt(tmp_path / "motion.csv", delimiter=",", skiprows=1)
    assert (table[:, 1:3] == solved.sample(100).q).all()
    for path, rate in (("motion.csv", None), ("motion.json", 10), ("motion.html", None)):
        with pytest.raises(costate.ArgumentError, match="motion"):
            solved.save(tmp_path / path, rate=rate)
    warm = limited.solve(start_from=solved, tolerance=1e-7)
    assert abs(warm.cost - solved.cost) < 1e-5
    assert limited.solve(start_from=tmp_path / "motion.json").solved
    with pytest.raises(costate.ArgumentError, match="missing.json"):
        limited.solve(start_from=tmp_path / "missing.json")
    from_tables = costate.Problem(
        limited.robot,
        start=[0, 0],
        end=[1, 0.5],
        time=1.0,
        cost=[1, 1],
        start_from={"file": "motion.json"},
        folder=tmp_path,
    )
    (tmp_path / "motion.json").unlink()
    again = pickle.loads(pickle.dumps(from_tables))
    assert again == from_tables and again.solve().solved


def test_data_frames_and_pictures(solved):
    pandas = pytest.importorskip("pandas")
    frame = solved.to_dataframe(rate=100)
    assert isinstance(frame, pandas.DataFrame) and list(frame.columns[:3]) == ["t", "q_shoulder", "q_elbow"]
    assert (frame["tau_elbow"].to_numpy() == solved.sample(100).tau[:, 1]).all()
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    axes = solved.plot()
    assert len(axes) == 4 and len(axes[0].get_lines()) >= 2


def test_sampling_is_checked(solved):
    assert solved.sample(times=[0.0, 0.5]).q.shape == (2, 2)
    for arguments in ({}, {"rate": 10, "times": [0.1]}, {"rate": -1}, {"times": [2.0]}, {"times": "no"}):
        with pytest.raises(costate.ArgumentError):
            solved.sample(**arguments)
    with pytest.raises(ValueError):
        solved.q[0, 0] = 1.0


def test_feedback_predicts_motions_nearby(arm):
    problem = costate.Problem(arm, start=[0, 0], end=[QUARTER, QUARTER], time=1.0, cost=[1, 1])
    solution = problem.solve(polish=False, tolerance=1e-9)
    gains = solution.feedback(rate=100)
    assert gains.gain_q.shape == gains.gain_v.shape == (101, 2, 2) and "gain_q" in json.loads(gains.to_json())
    # A central difference of motions from states that are off.
    dq, dv = np.array([0.004, -0.003]), np.array([0.02, 0.03])
    start = lambda sign: {"q": sign * dq, "v": sign * dv}
    above, below = (
        costate.Problem(arm, start=start(sign), end=[QUARTER, QUARTER], time=1.0, cost=[1, 1])
        .solve(polish=False, tolerance=1e-9)
        .sample(100)
        for sign in (1, -1)
    )
    for k in (0, 30, 55):
        change = {name: (getattr(above, name)[k] - getattr(below, name)[k]) / 2 for name in ("q", "v", "tau")}
        predicted = gains.gain_q[k] @ change["q"] + gains.gain_v[k] @ change["v"]
        assert np.abs(predicted - change["tau"]).max() < 0.01 * np.abs(change["tau"]).max()
    # dJ/dx of the start is minus the costate; by (q, v) at constant v.
    assert_close(gains.cost_by_start[2:], -costate.Dynamics(arm).crba([0, 0]) @ solution.costates[0, 2:], 1e-3)


def test_sensitivities(arm):
    found = costate.Problem.from_file(PROBLEMS / "two_link.toml").solve().sensitivities()
    # Of docs/optimize.md; `cargo test -p costate-control --test real_time` compares it with solving again.
    assert abs(found["elbow.J_zz"].derivative - 271.71942099) < 1e-4
    # A central difference of motions with another inertia, by an armature of the elbow: J_zz moves the shoulder too.
    cost = {}
    for mass in (-1e-3, 1e-3):
        heavier = {"payload": [{"frame": "elbow", "mass": 0.0, "inertia": {"zz": 1e-3 + mass}}]}
        problem = costate.Problem(arm, {"robot": heavier}, start=[0, 0], end=[QUARTER] * 2, time=1.0, cost=[1, 1])
        cost[mass] = problem.solve(tolerance=1e-9).cost
    difference = (cost[1e-3] - cost[-1e-3]) / 2e-3
    assert abs(found["elbow.J_zz"].derivative - difference) < 2e-3 * difference


def test_continuous_accelerations_have_feedback_and_sensitivities(arm):
    task = {"end": [1, 0.5], "time": 1.0, "limits": False}
    cost = {"effort": [1, 1], "jerk": [1e-2] * 2}
    smooth = costate.Problem(arm, start=[0, 0], cost=cost, **task).solve()
    assert smooth.sensitivities()["elbow.mass"].derivative > 0
    gains = smooth.feedback(rate=10)
    assert gains.gain_a.shape == gains.gain_q.shape == (11, 2, 2) and gains.cost_by_start.shape == (6,)
    limits = {"jerk_max": [150, 200], "from_robot": False}
    limited = costate.Problem(arm, start=[0, 0], end=[1, 0.5], time=1.0, cost=[1, 1], limits=limits).solve()
    with pytest.raises(costate.MotionError, match="joint 'shoulder' costs"):
        limited.feedback()


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
    assert solution.status == "infeasible" and not solution.solved
    assert {limit["kind"] for limit in solution.infeasible["limits"]} == {"torque"}
    longer = solution.infeasible["final_time"]
    again = costate.Problem(arm, start=[0, 0], end=[QUARTER, QUARTER], time=longer, cost=[1, 1], limits=limits)
    assert longer > 1.0 and again.solve().solved
    with pytest.raises(costate.MotionError, match="infeasible"):
        solution.check()
    assert "torque of elbow (max) by" in str(solution) or "torque of shoulder" in str(solution)
    assert solution.message in str(solution) and solution.message[:20] in solution._repr_html_()


def test_progress_and_records(limited, caplog, capsys):
    seen = []
    with caplog.at_level(logging.DEBUG, "costate"):
        solution = limited.solve(progress=seen.append)
    assert seen and all(isinstance(step, costate.Iteration) for step in seen) and seen[0].phase == "direct"
    assert solution.iterations == seen and solution.newton_iterations >= len(seen)
    levels = [record.levelno for record in caplog.records if record.name == "costate"]
    assert levels.count(logging.DEBUG) == len(seen) and levels.count(logging.INFO) == 1
    limited.solve(progress=True)
    assert capsys.readouterr().err
    stopped = limited.solve(progress=lambda step: True, tolerance=1e-13)
    assert stopped.status in ("cancelled", "mesh_limit", "converged")
    with pytest.raises(ZeroDivisionError):
        limited.solve(progress=lambda step: 1 / 0)
    with pytest.raises(costate.ArgumentError, match="progress"):
        limited.solve(progress=3)
    times = limited.solve(stage_times=True).stage_times
    assert set(times) >= {"points", "equations"} and sum(times.values()) > 0
    assert limited.solve().stage_times is None


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
    solution = costate.Problem.from_file(ROBOTS.parent / "examples/problems/double_integrator_min_time.toml").solve()
    assert abs(solution.final_time - 2) < 1e-6 and np.abs(np.array(solution.switches) - 1).max() < 1e-6
    assert len(solution.switches) == 1 and solution.penalty_cost == 0
    arm = load("two_link.toml")
    penalty = {"weight": 1.0, "v_max": [2.0, 2.0]}
    tables = {"start": [0, 0], "end": [1.5, 1.0], "time": 1.0, "cost": [1, 1], "limits": False}
    direct, indirect = (
        costate.Problem(arm, **tables, penalty=penalty).solve(method=method) for method in ("direct", "collocation")
    )
    assert direct.penalty_cost > 1 and abs(direct.penalty_cost - indirect.penalty_cost) < 1e-4 * direct.penalty_cost
    assert costate.Problem(arm, **tables).solve().cost < direct.cost
