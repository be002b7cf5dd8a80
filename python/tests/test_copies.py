"""Pickles, copies and equality of what is not a robot or a problem alone."""

import copy
import math
import pickle

import costate
import numpy as np
import pytest
from conftest import load


@pytest.fixture(scope="module")
def problem():
    limits = {"v_max": [math.inf, 7.0], "from_robot": False}
    return costate.Problem(load("two_link.toml"), start=[0, 0], end=[1.5, 1.0], time=1.0, cost=[1, 1], limits=limits)


@pytest.fixture(scope="module")
def solution(problem):
    return problem.solve()


def again(thing):
    """The same by a pickle, by a copy and by a deep copy."""
    return [pickle.loads(pickle.dumps(thing)), copy.copy(thing), copy.deepcopy(thing)]


def test_samples(solution):
    samples = solution.sample(100)
    for other in again(samples):
        assert other == samples and other is not samples and (other.tau == samples.tau).all()
        assert other.to_csv() == samples.to_csv()
    other = pickle.loads(pickle.dumps(samples))
    other.q[3, 1] += 1e-9
    assert other != samples and samples != solution.sample(50) and samples != 1
    changed = float(other.to_csv().splitlines()[4].split(",")[2])
    assert changed == other.q[3, 1]  # the table has the numbers of the arrays


def sample_of(rate):
    """A task of a sweep."""
    robot = costate.Robot.builder("cart", gravity=[0, 0, 0]).prismatic("rail", axis=[1, 0, 0], mass=2).build()
    problem = costate.Problem(robot, start=[0.0], end=[1.0], time=1.0, cost=[1.0])
    return problem.solve(threads=1).sample(rate)


def test_a_sweep_returns_samples():
    outcomes = costate.sweep(sample_of, [10.0, 20.0], workers=1, chunk=2)
    assert [outcome.error for outcome in outcomes] == [None, None]
    assert [outcome.value for outcome in outcomes] == [sample_of(10.0), sample_of(20.0)]


def test_gains(solution):
    gains = solution.feedback(rate=50)
    for other in again(gains):
        assert other == gains and other is not gains and other.to_json() == gains.to_json()
    other = copy.deepcopy(gains)
    other.gain_q[0, 0, 0] += 1.0
    assert other != gains and gains != solution.feedback(rate=20)


def test_feedback(problem):
    motion = problem.resolve(tolerance=1e-6, nodes=31)
    motion.solve()
    feedback = motion.feedback()
    for other in again(feedback):
        assert other == feedback and (other.states_by_end == feedback.states_by_end).all()
        assert (other.gain([0.1, 0.77]) == feedback.gain([0.1, 0.77])).all()
    motion.set_start([0.1, 0.0], [0.0, 0.0])
    motion.solve()
    assert motion.feedback() != feedback and repr(feedback) == "Feedback(30 points, n=2)"
    with pytest.raises(costate.ArgumentError):
        type(feedback._core).of(2, feedback._core.numbers()[:-1])


def test_what_a_resolve_was_told(problem):
    motion = problem.resolve(tolerance=1e-6, nodes=31)
    motion.set_start([0.1, -0.1], np.zeros(2))
    motion.set_end([1.4, 1.1], [0.0, 0.0])
    motion.set_start_time(0.25)
    expected = motion.solve()
    for other in again(motion):
        assert other != motion and other == other  # each has a motion of its own
        assert math.isnan(other.final_time) and other.problem == problem
        assert other.solve()[:-1] == expected[:-1]  # all but how long it took
        assert (other.torques([0.2, 0.4]) == motion.torques([0.2, 0.4])).all()
    near = costate.Resolve(problem, near=problem.solve(), tolerance=1e-6)
    assert pickle.loads(pickle.dumps(near)).solve()[:-1] == near.solve()[:-1]


def test_a_builder_goes_on_where_it_was():
    builder = costate.Robot.builder("arm", gravity=[0, 0, -1.6]).revolute("a", axis=[0, 1, 0], mass=1, com=[0.5, 0, 0])
    others = again(builder)
    assert all(other == builder and other is not builder for other in others)
    builder.revolute("b", on="a", xyz=[1, 0, 0], mass=0.5, com=[0.2, 0, 0]).frame("tip", "b", xyz=[0.3, 0, 0])
    assert others[0] != builder and others[0].build().joint_names == ["a"]
    others[0].revolute("b", on="a", xyz=[1, 0, 0], mass=0.5, com=[0.2, 0, 0]).frame("tip", "b", xyz=[0.3, 0, 0])
    assert others[0] == builder and others[0].build() == builder.build() and builder == builder
    with pytest.raises(TypeError):
        hash(builder)


def test_solutions_that_are_equal_have_equal_hashes(solution):
    other = pickle.loads(pickle.dumps(solution))
    assert other == solution and hash(other) == hash(solution) and len({other, solution}) == 1


def test_an_interrupt_keeps_what_was_reached(solution):
    plain = pickle.loads(pickle.dumps(costate.Interrupted(solution)))
    assert plain.solution == solution and plain.reached == solution and "best motion" in str(plain)
    other = pickle.loads(pickle.dumps(costate.Interrupted(np.ones(3), "after 3 of 4")))
    assert other.solution is None and (other.reached == 1).all() and str(other) == "after 3 of 4"
