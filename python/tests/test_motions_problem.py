"""Problems: keywords, tables and text; what is refused, with its key."""

import math
import pickle

import costate
import numpy as np
import pytest
from conftest import ROBOTS


def test_problems_as_keywords_tables_and_text(arm):
    tables = {"start": {"q": [0, 0]}, "end": {"q": np.array([1.0, 0.5])}, "time": {"final": 1.0}}
    tables |= {"cost": {"effort": [1.0, 1.0]}}
    problem = costate.Problem(arm, tables)
    assert problem == costate.Problem(arm, start=[0, 0], end=[1, 0.5], time=1.0, cost=[1, 1])
    assert problem == costate.Problem.from_text(problem.text, arm) and hash(problem) == hash(
        pickle.loads(pickle.dumps(problem))
    )
    assert problem != costate.Problem(arm, start=[0, 0], end=[1, 0.5], time=1.1, cost=[1, 1]) and problem != 1
    assert repr(problem) == "Problem('two_link', n=2)" and problem.robot == arm
    assert problem.options["tolerance"] == 1e-4
    assert costate.Problem(arm, tables, solver={"tolerance": 1e-6}).options["tolerance"] == 1e-6
    with pytest.raises(AttributeError):
        problem.text = ""
    there = problem.text.replace("start", 'robot = "robots/two_link.toml"\nstart', 1)
    assert costate.Problem.from_text(there, folder=ROBOTS.parent) == problem


def test_changes_of_the_robot(arm):
    load_on_elbow = {"payload": [{"frame": "elbow", "mass": 1.0}]}
    problem = costate.Problem(arm, {"robot": load_on_elbow}, start=[0, 0], end=[1, 0.5], time=1.0, cost=[1, 1])
    assert problem.robot.mass == arm.mass + 1.0 and problem.robot != arm
    again = pickle.loads(pickle.dumps(problem))
    assert again == problem and again.robot == problem.robot == pickle.loads(pickle.dumps(problem.robot))


def test_one_number_stands_for_all_joints_and_a_free_time_needs_no_guess(arm):
    ends = {"start": [0, 0], "end": [1, 0.5]}
    short = costate.Problem(arm, **ends, time=1.0, cost=1.0, limits={"v_max": 3, "from_robot": False})
    long = costate.Problem(arm, **ends, time=1.0, cost=[1, 1], limits={"v_max": [3, 3], "from_robot": False})
    assert short.solve().cost == long.solve().cost
    free = costate.Problem(arm, **ends, time={"free": True}, cost={"time": 10, "effort": 1.0})
    given = costate.Problem(arm, **ends, time={"free": True, "guess": 1.0}, cost={"time": 10, "effort": 1.0})
    assert free.solve().cost == pytest.approx(given.solve().cost, rel=1e-5)
    with pytest.raises(costate.ProblemError, match="give a list of numbers, not 0"):
        costate.Problem(arm, start=0.0, end=[1, 0.5], time=1.0, cost=1.0)


REFUSED = [
    ({"start": [0]}, {}, "start.q"),
    ({"end": {"q": [0, math.nan]}}, {}, "end.q"),
    ({"time": -1}, {}, "time.final"),
    ({"time": {"free": True}}, {}, "time.free"),
    ({"time": {"final": "1"}}, {}, "time.final"),
    ({"cost": [1, -1]}, {}, "cost.effort"),
    ({"cost": {"efort": [1, 1]}}, {}, "cost.efort"),
    ({"limits": {"v_max": [1.0]}}, {}, "limits.v_max"),
    ({"limits": {"v_max": [-1.0, 1.0]}}, {}, "limits.v_max"),
    ({"limits": {"q_max": [0.9, 0.9]}}, {}, "end.q"),
    ({"bounds": {"u_min": [1, 1], "u_max": [0, 0]}}, {}, "bounds.u_min"),
    ({"keep": [{"kind": "speed", "frame": "hand", "speed": 1.0}]}, {}, "keep.frame"),
    ({"obstacle": [{"kind": "sphere", "xyz": [0, 0]}]}, {}, "obstacle.xyz"),
    ({"via": [{"q": [0]}]}, {}, "via 1, q"),
    ({"cost": {"effort": {1, 2}}}, {}, "cost.effort"),
    ({"solver": {"tolerance": 2.0}}, {}, "solver.tolerance"),
    ({"start_from": {"file": "missing.json"}}, {}, "start_from.file"),
    ({"limits": {"v_max": [7, 7]}}, {"method": "shooting"}, "solver.method"),
    ({}, {"tolerance": 0.0}, "solver.tolerance"),
    ({}, {"starts": 0}, "solver.starts"),
    ({}, {"starts": -1}, "solver.starts"),
    ({}, {"method": "magic"}, "solver.method"),
    ({}, {"time_limit": -1.0}, "solver.time_limit"),
    ({}, {"nodes": 1.5}, "solver.nodes"),
]


@pytest.mark.parametrize(("tables", "options", "key"), REFUSED)
def test_errors_name_the_key(arm, tables, options, key):
    given = {"start": [0, 0], "end": [1, 0.5], "time": 1.0, "cost": [1, 1]} | tables
    with pytest.raises(costate.ProblemError) as caught:
        costate.Problem(arm, **given).solve(**options)
    assert caught.value.key == key and key in str(caught.value)
    copy = pickle.loads(pickle.dumps(caught.value))
    assert str(copy) == str(caught.value) and copy.key == key


def test_errors_of_tables_and_files(arm, tmp_path):
    with pytest.raises(costate.ProblemError, match="given twice") as caught:
        costate.Problem(arm, {"time": {"final": 1}}, time=1.0)
    assert caught.value.key == "time"
    with pytest.raises(costate.ProblemError, match="unknown key") as caught:
        costate.Problem(arm, {"tyme": 1})
    assert caught.value.key == "tyme"
    with pytest.raises(costate.ProblemError) as caught:
        costate.Problem(arm, start=[0, 0], end=[1, 0.5])
    assert caught.value.key == "time"
    (tmp_path / "problem.toml").write_text('robot = "missing.urdf"\n[time]\nfinal = 1\nfinal = 2\n')
    with pytest.raises(costate.ProblemError) as caught:
        costate.Problem.from_file(tmp_path / "problem.toml")
    assert (caught.value.key, caught.value.line) == ("time.final", 4) and caught.value.path.endswith("problem.toml")
    with pytest.raises(FileNotFoundError):
        costate.Problem.from_file(tmp_path / "missing.toml")
    with pytest.raises(costate.ArgumentError) as caught:
        costate.Problem(arm, start=[0, 0], end=[1, 0.5], time=1.0, cost=[1, 1]).solve(on_interrupt="ignore")
    assert caught.value.argument == "on_interrupt"


def test_odd_problems_get_a_warning(arm):
    with pytest.warns(costate.ProblemWarning, match="degrees"):
        problem = costate.Problem(arm, start=[0, 0], end=[90, 0], time=1.0, cost=[1, 1])
    assert len(problem.warnings) == 1 and "degrees" in problem.warnings[0]
