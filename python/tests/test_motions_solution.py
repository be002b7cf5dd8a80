"""What a solution of a problem is good for: pickles, files, tables, samples, feedback, sensitivities, records."""

import json
import logging
import math
import pickle

import costate
import numpy as np
import pytest
from conftest import PROBLEMS, QUARTER, assert_close


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
    of_another = solved.to_json().replace('"robot":"two_link"', '"robot":"other"')
    with pytest.raises(costate.MotionError, match="is one of robot 'other'; the robot of the problem is 'two_link'"):
        costate.Solution.from_json(of_another, limited)


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
    assert gains.active == gains.undecided == [[]] * 101 and np.allclose(gains.held, [[0.98, 1.0]])
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
