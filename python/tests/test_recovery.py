"""Motions that are solved again after a wrong measurement, and limits that are kept or told of."""

import copy
import math
import pickle
import warnings

import costate
import numpy as np
import pytest


@pytest.fixture(scope="module")
def posed(arm) -> costate.Problem:
    limits = {"torque_max": [40, 40], "from_robot": False}
    return costate.Problem(arm, start=[0, 0], end=[1, 0.5], time=1.0, cost=[1, 1], limits=limits)


@pytest.mark.parametrize("wrong", [([0, 0], [50, 0]), ([5, 0], [0, 0]), ([30, 0], [0, 0]), ([3, 0], [0, 0])])
def test_a_wrong_measurement_is_forgotten(posed, wrong):
    motion = costate.Resolve(posed, nodes=31)
    first = motion.solve()
    assert first.status == "solved"
    motion.set_start(*(np.array(part, float) for part in wrong))
    motion.solve(steps=3)
    motion.set_start([0, 0], [0, 0])
    again = motion.solve()
    assert again.status == "solved" and abs(again.cost / first.cost - 1) < 1e-5


def test_reset_begins_anew(posed):
    motion = costate.Resolve(posed, nodes=31)
    first = motion.solve()
    motion.set_start([2.0, -1.0], [3.0, 0.0])
    motion.solve()
    motion.set_start([0, 0], [0, 0])
    motion.reset()
    assert math.isnan(motion.final_time)
    with pytest.raises(costate.MotionError, match="call solve first"):
        motion.state(0.0)
    again = motion.solve()
    assert again[:2] == first[:2] and abs(again.cost / first.cost - 1) < 1e-9
    assert copy.copy(motion).solve()[:2] == first[:2]


def test_times_and_starts_that_make_no_sense_are_refused(posed):
    motion = costate.Resolve(posed, nodes=31)
    motion.advance(3.0)  # nothing is solved yet
    motion.solve()
    wrong = [(math.nan, "not negative"), (-1.0, "not negative"), (math.inf, "finite"), (1.5, "over after 1 s")]
    for dt, words in wrong:
        with pytest.raises(costate.ArgumentError, match=words) as raised:
            motion.advance(dt)
        assert raised.value.argument == "dt"
    with pytest.raises(costate.ArgumentError, match="t is not finite"):
        motion.feedback().gain(math.nan)
    for wrong, kind in [([True, False], "list"), (np.array([True, False]), "ndarray"), ("no", "str"), (3.0, "float")]:
        with pytest.raises(costate.ArgumentError, match=f"q is a {kind}; give an array or a sequence of 2 numbers"):
            motion.set_start(wrong, [0, 0])
    for steps in (-1, 0, True, 2.5, 2**70):
        with pytest.raises(costate.ArgumentError, match="steps is .*; give a whole number") as raised:
            motion.solve(steps=steps)
        assert raised.value.argument == "steps"


def told(work) -> list[str]:
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        work()
    assert all(issubclass(warning.category, costate.LimitWarning) for warning in found)
    return [str(warning.message) for warning in found]


def test_limits_that_are_left_out_are_told_of(arm):
    # One joint without a limit of its rate: limits of such robots are kept where they are asked for.
    slow = arm.with_limits(arm.joint_names[0], velocity=0.5)
    task = {"start": [0, 0], "end": [1, 0.5], "time": 1.0, "cost": [1, 1]}
    unsaid = costate.Problem(slow, **task)
    [text] = told(unsaid.solve)
    assert "velocity of joint 'shoulder'" in text and "limits=True keeps them" in text and "runs from" not in text
    [text] = told(lambda: costate.Resolve(unsaid))
    assert "the limits of the robot are not kept" in text
    # Both leave them out.
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", costate.LimitWarning)
        costs = unsaid.solve().cost, costate.Resolve(unsaid, nodes=91).solve().cost
    assert abs(costs[0] / costs[1] - 1) < 1e-3
    silent = costate.Problem(slow, **task, limits=False)
    assert told(silent.solve) == told(lambda: costate.Resolve(silent)) == []
    kept = costate.Problem(slow, **task, limits={"a_max": [100, 100]})
    assert told(lambda: costate.Resolve(kept)) == [] and told(kept.solve) == []
    assert kept.solve().status == "infeasible" and abs(silent.solve().cost / costs[0] - 1) < 1e-6
    # Where all joints have limits of rate and effort they are kept, unless that is denied.
    complete = slow.with_limits(arm.joint_names[1], velocity=0.5)
    assert costate.Problem(complete, **task).solve().status == "infeasible"
    assert costate.Problem(complete, **task, limits=False).solve().solved
    # A robot without limits has none to leave out.
    cart = costate.Robot.builder("cart").prismatic("rail", mass=2).build()
    free = costate.Problem(cart, start=[0], end=[1], time=1, cost=[1])
    assert told(free.solve) == told(lambda: costate.Resolve(free)) == []
    assert issubclass(costate.LimitWarning, costate.ProblemWarning) and pickle.loads(pickle.dumps(costate.LimitWarning))


def test_options_have_one_set_of_words(posed, arm):
    plain = costate.Problem(arm, start=[0, 0], end=[1, 0.5], time=1.0, cost=[1, 1], limits=False)
    found = {word: plain.solve(method="collocation", coordinates=word) for word in ("qp", "hamiltonian", "qv")}
    assert found["qp"] == found["hamiltonian"] and found["qv"].cost == pytest.approx(found["qp"].cost, rel=1e-6)
    assert costate.Dynamics(arm, "hamiltonian") == costate.Dynamics(arm, "qp")
    assert costate.Dynamics(arm, "lagrangian").coordinates == "qv"
    task = {"start": [0, 0], "end": [1, 0.5], "time": 1.0, "cost": [1, 1], "limits": False}
    hurried = costate.Problem(arm, **task, solver={"time_limit": 1e-9})
    assert hurried.solve(time_limit=math.inf).solved and not hurried.solve().solved


def test_progress_that_says_stop_is_not_asked_again(posed):
    calls = []
    posed.solve(progress=lambda step: calls.append(step) or True, tolerance=1e-10)
    assert len(calls) == 1


def test_messages_name_what_users_call(posed):
    with pytest.raises(TypeError, match=r"Problem\.solve\(\) got an unexpected keyword"):
        posed.solve(tolerence=1e-3)
    with pytest.raises(TypeError, match=r"Resolve\.set_start\(\)"):
        costate.Resolve(posed).set_start()
    with pytest.raises(costate.ProblemError, match="give a list of numbers, not a list of lists"):
        costate.Problem(posed.robot, start=[[0, 0]], end=[1, 0.5], time=1)


def test_infeasible_motions_have_no_feedback(arm):
    limits = {"torque_max": [1, 1]}
    hurried = costate.Problem(arm, start=[0, 0], end=[3, 0.5], time=0.05, cost=[1, 1], limits=limits).solve()
    assert hurried.status in ("infeasible", "locally_infeasible")
    with pytest.raises(costate.MotionError, match="an infeasible motion has no feedback"):
        hurried.feedback()
