"""The nonlinear program of a motion."""

import pickle

import costate
import numpy as np
import pytest


@pytest.fixture
def problem():
    builder = costate.Robot.builder("arm")
    builder = builder.revolute("shoulder", axis=[0, 1, 0], mass=2.0, com=[0.2, 0, 0])
    builder = builder.revolute("elbow", on="shoulder", axis=[0, 1, 0], xyz=[0.4, 0, 0], mass=1.0, com=[0.1, 0, 0])
    limits = {"torque_max": [14.0, 3.0], "v_max": 2.0}
    return costate.Problem(builder.build(), start=[0.0, 0.3], end=[0.8, -0.2], time=0.9, cost=1.0, limits=limits)


def dense(shape, structure, values):
    matrix = np.zeros(shape)
    np.add.at(matrix, structure, values)
    return matrix


def test_entries_are_the_derivatives(problem):
    program = problem.nlp(nodes=13)
    assert program.x0.shape == (program.n,)
    assert program.cl.shape == program.cu.shape == (program.m,) == (len(program.rows),)
    rng = np.random.default_rng(3)
    x = program.x0 + 0.1 * rng.normal(size=program.n)
    multipliers, factor, step = rng.normal(size=program.m), 0.7, 1e-6
    jacobian = lambda x: dense((program.m, program.n), program.jacobianstructure(), program.jacobian(x))
    slope = lambda x: factor * program.gradient(x) + multipliers @ jacobian(x)
    lower = dense((program.n, program.n), program.hessianstructure(), program.hessian(x, multipliers, factor))
    hessian = np.tril(lower) + np.tril(lower, -1).T
    assert np.array_equal(lower, np.tril(lower))
    moves = step * np.eye(program.n)
    difference = lambda f: np.array([(f(x + move) - f(x - move)) / (2 * step) for move in moves]).T
    np.testing.assert_allclose(program.gradient(x), difference(program.objective), rtol=1e-6, atol=1e-5)
    np.testing.assert_allclose(jacobian(x), difference(program.constraints), rtol=1e-6, atol=1e-5)
    np.testing.assert_allclose(hessian, difference(slope), rtol=1e-5, atol=1e-3)


def test_the_solution_is_a_minimum_within_limits(problem):
    program = problem.nlp(nodes=61)
    found = program.solve()
    assert found.status == "solved" and found.certificate in ("local_minimum", "undecided")
    assert found.cost == pytest.approx(problem.solve(tolerance=1e-6).cost, rel=1e-3)
    samples = program.sample(found.x)
    assert samples.q.shape == samples.tau.shape == (60, 2)
    assert np.all(np.abs(samples.v) <= 2.0 + 1e-6)
    assert np.all(np.abs(samples.tau) <= np.array([14.0, 3.0]) + 1e-5)
    values = program.constraints(found.x)
    held = np.abs(found.multipliers) > 1e-3
    at_bound = np.minimum(np.abs(values - program.cl), np.abs(program.cu - values))
    assert held.any()
    assert np.all(at_bound[held] < 1e-4)
    assert {row.kind for row in program.rows} == {"torque", "rate"}
    row = program.rows[0]
    assert isinstance(row, costate.ProgramRow) and row.name in ("shoulder", "elbow") and 0 <= row.place <= 1
    assert row.unit in ("N m", "rad/s") and program.problem is problem
    assert isinstance(found, costate.ProgramSolution) and found.error < 1e-8 and found.iterations < 100
    assert isinstance(samples, costate.ProgramSamples) and isinstance(program, costate.Program)
    assert samples.t[0] > 0 and samples.t[-1] < 0.9 and samples.a.shape == (60, 2)
    # The gradient of the Lagrange function vanishes.
    jacobian = dense((program.m, program.n), program.jacobianstructure(), program.jacobian(found.x))
    left = program.gradient(found.x) + found.multipliers @ jacobian
    assert np.abs(left).max() < 1e-5 * np.abs(program.gradient(found.x)).max()


def test_times_that_are_not_positive_have_no_values(problem):
    tables = {"start": [0.0, 0.3], "end": [0.8, -0.2], "time": {"free": True, "guess": 0.9}, "cost": {"time": 1.0}}
    free = costate.Problem(problem.robot, **tables, limits={"torque_max": [14.0, 3.0]})
    program = free.nlp(nodes=13)
    x = program.x0.copy()
    before = program.constraints(x), program.gradient(x), program.jacobian(x)
    assert all(np.isfinite(values).all() for values in before)
    x[-1] = -1.0
    assert np.isnan(program.objective(x)) and np.isnan(program.constraints(x)).all()
    assert np.isnan(program.gradient(x)).any()
    with pytest.raises(costate.StateError, match="a time is not positive"):
        program.sample(x)
    after = program.constraints(program.x0), program.gradient(program.x0), program.jacobian(program.x0)
    assert all(np.array_equal(a, b) for a, b in zip(before, after, strict=True))
    # Whatever was asked for in between.
    program.hessian(program.x0, np.ones(program.m), 1e-9)
    np.testing.assert_allclose(program.gradient(program.x0), before[1], rtol=1e-6, atol=1e-6)
    assert program.solve().status == "solved"


def test_copies_and_refusals(problem):
    program = problem.nlp(nodes=13)
    with pytest.raises(ValueError, match="read-only"):
        program.x0[0] = 1.0
    copy = pickle.loads(pickle.dumps(program))
    assert copy.problem == problem
    assert np.array_equal(copy.x0, program.x0)
    with pytest.raises(costate.ArgumentError, match="x has 3 entries"):
        program.objective([1.0, 2.0, 3.0])
    with pytest.raises(ValueError, match="the setting tolerance is -1"):
        program.solve(tolerance=-1.0)
    assert program.solve(iterations=1).status == "iteration_limit"
    assert program.solve(time_limit=0.0).status == "time_limit"
    for wrong in (-1.0, float("nan")):
        with pytest.raises(ValueError, match="time_limit"):
            program.solve(time_limit=wrong)
