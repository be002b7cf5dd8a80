"""Crocoddyl's solver with the exact Hessian: fewer iterations to the same motion."""

import costate
import numpy as np
import pytest
from conftest import assert_close, central_differences, load

crocoddyl = pytest.importorskip("crocoddyl")
import costate.crocoddyl

GOAL = np.array([2.5, -2.0, 0.0, 0.0])


@pytest.fixture
def step():
    return costate.Step(costate.Dynamics(load("two_link.toml")), "semi_implicit_euler", 0.02)


def solve(step, exact, nodes=100):
    models = [costate.crocoddyl.ActionModel(step, GOAL, exact=exact) for _ in range(nodes)]
    problem = crocoddyl.ShootingProblem(np.zeros(4), models, costate.crocoddyl.FinalModel(step, GOAL, 100.0))
    solver = crocoddyl.SolverDDP(problem)
    solver.setCallbacks([costate.crocoddyl.Costates(models)])
    solver.th_stop = 1e-16
    converged = solver.solve([np.zeros(4)] * (nodes + 1), [np.zeros(2)] * nodes, 300, False)
    return solver, converged, models


def test_the_exact_hessian_takes_fewer_iterations(step):
    exact, converged, models = solve(step, True)
    gauss_newton, also, _ = solve(step, False)
    assert converged and also
    # The guide says 10 and 26.
    assert exact.iter <= 12 and gauss_newton.iter >= 22
    assert abs(exact.cost - gauss_newton.cost) < 1e-8 * exact.cost
    assert all(model.costate is not None for model in models)


def test_derivatives_of_a_model(step, random):
    model = costate.crocoddyl.ActionModel(step, GOAL, effort=[1.0, 2.0], deviation=[1.0, 2.0, 3.0, 4.0])
    data = model.createData()
    x, u, y = random.normal(size=4), random.normal(size=2), random.normal(size=4)

    def at(z):
        model.calc(data, z[:4], z[4:])
        return np.concatenate([data.xnext, [data.cost]])

    def slope(z):
        model.costate = None
        model.calc(data, z[:4], z[4:])
        model.calcDiff(data, z[:4], z[4:])
        f = np.concatenate([data.Fx, data.Fu], axis=1)
        return np.concatenate([data.Lx, data.Lu]) + y @ f

    z = np.concatenate([x, u])
    differences = central_differences(at, z)
    model.costate = y
    model.calc(data, x, u)
    model.calcDiff(data, x, u)
    assert_close(np.concatenate([data.Fx, data.Fu], axis=1), differences[:4], 1e-7)
    assert_close(np.concatenate([data.Lx, data.Lu]), differences[4], 1e-7)
    found = np.block([[data.Lxx, data.Lxu], [data.Lxu.T, data.Luu]])
    assert_close(found, central_differences(slope, z), 1e-6)


def test_costate_computes_every_derivative(step):
    calls = []

    class Counted:
        def __getattr__(self, name):
            value = getattr(step, name)
            if callable(value):
                return lambda *arguments: (calls.append(name), value(*arguments))[1]
            return value

    solver, _, models = solve(Counted(), True, nodes=20)
    first, later = calls.count("jacobian"), calls.count("contract")
    # The first iteration has no costates; each later linearisation is one contraction a node.
    assert first == 20 and later % 20 == 0 and later > 0 and set(calls) == {"f", "jacobian", "contract"}


def test_what_does_not_fit_is_refused(step):
    with pytest.raises(costate.ArgumentError, match="goal"):
        costate.crocoddyl.ActionModel(step, np.zeros(3))
    model = costate.crocoddyl.ActionModel(step, GOAL)
    with pytest.raises(costate.ArgumentError, match="twice"):
        costate.crocoddyl.Costates([model, model])


def test_weights_of_the_page():
    """Costs of a moderate ratio: the exact model reaches the cost of Gauss-Newton though both are tiny."""
    step = costate.Step(costate.Dynamics(load("two_link.toml")), "semi_implicit_euler", 0.05)
    goal, costs = np.array([2.5, -2.0, 0.0, 0.0]), []
    for exact in (True, False):
        models = [costate.crocoddyl.ActionModel(step, goal, effort=1e-6, exact=exact) for _ in range(100)]
        final = costate.crocoddyl.FinalModel(step, goal, 1.0)
        solver = crocoddyl.SolverDDP(crocoddyl.ShootingProblem(np.zeros(4), models, final))
        solver.setCallbacks([costate.crocoddyl.Costates(models)])
        solver.th_stop = 1e-20
        assert solver.solve([np.zeros(4)] * 101, [np.zeros(2)] * 100, 200, False)
        costs.append(solver.cost)
    assert_close(costs[0], costs[1], 1e-9)
