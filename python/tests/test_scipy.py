"""Motions by SciPy's and IPOPT's solvers: every derivative is asked of costate, and is right."""

import costate
import numpy as np
import pytest
from conftest import assert_close, central_differences, load

pytest.importorskip("scipy")
import costate.scipy


class Counted:
    """A step or dynamics that counts its calls and their states."""

    def __init__(self, inner):
        self.inner, self.calls, self.states = inner, {}, {}

    def __getattr__(self, name):
        value = getattr(self.inner, name)
        if not callable(value):
            return value

        def call(*arguments):
            self.calls[name] = self.calls.get(name, 0) + 1
            self.states[name] = self.states.get(name, 0) + int(np.prod(np.shape(arguments[0])[:-1]))
            return value(*arguments)

        return call


@pytest.fixture(scope="module")
def two_link():
    return load("two_link.toml")


@pytest.fixture
def no_differences(monkeypatch):
    """SciPy must not difference anything."""
    from scipy.optimize import _differentiable_functions, _numdiff

    def refuse(*_, **__):
        raise AssertionError("a finite difference")

    for module in (_differentiable_functions, _numdiff):
        monkeypatch.setattr(module, "approx_derivative", refuse)


def transcription(robot, coordinates="qv", intervals=6, **options):
    step = costate.Step(costate.Dynamics(robot, coordinates), "rk4", 0.1)
    goal = [0.4, -0.3, 0.0, 0.0]
    return costate.scipy.Transcription(step, intervals, np.zeros(4), goal, effort=[1.0, 2.0], **options)


@pytest.mark.parametrize("coordinates", ["qv", "qp"])
def test_derivatives_of_the_program(two_link, coordinates, random):
    program = transcription(two_link, coordinates, deviation=[0.1, 0.2, 0.3, 0.4])
    w, y = random.normal(size=program.n_unknowns), random.normal(size=program.n_constraints)
    x, tau = program.split(w)
    assert (program.join(x, tau) == w).all() and x.shape == (7, 4) and tau.shape == (6, 2)
    gradient = central_differences(lambda w: np.array([program.objective(w)]), w)[0]
    assert_close(program.gradient(w), gradient, 1e-7)
    jacobian = np.zeros((program.n_constraints, program.n_unknowns))
    np.add.at(jacobian, program.jacobianstructure(), program.jacobian(w))
    assert_close(jacobian, central_differences(program.constraints, w), 1e-7)

    def slope(w, factor=0.7):
        by_w = np.zeros((program.n_constraints, program.n_unknowns))
        by_w[program.jacobianstructure()] = program.jacobian(w)
        return factor * program.gradient(w) + y @ by_w

    rows, columns = program.hessianstructure()
    assert (rows >= columns).all()
    hessian = np.zeros((program.n_unknowns, program.n_unknowns))
    np.add.at(hessian, (rows, columns), program.hessian(w, y, 0.7))
    whole = hessian + np.tril(hessian, -1).T
    assert_close(whole, central_differences(slope, w), 1e-6)


def test_trust_constr_with_exact_hessians(two_link, no_differences):
    program = transcription(two_link, intervals=10)
    program.step = counted = Counted(program.step)
    result = program.minimize(gtol=1e-8, maxiter=200)
    assert result.status in (1, 2) and result.constr_violation < 1e-8
    x, _ = program.split(result.x)
    assert_close(x[[0, -1]], np.array([np.zeros(4), program.goal]), 1e-7)
    # One batch for each value, Jacobian and Hessian that SciPy counts, and one for the constant Hessian of the cost.
    assert counted.calls["f"] <= result.constr_nfev[0] + 1
    assert counted.calls["jacobian"] <= result.constr_njev[0] + 1
    assert counted.calls["hessian"] <= result.constr_nhev[0] + 2
    assert counted.states == {name: 10 * count for name, count in counted.calls.items()}
    # It is a minimum: no feasible direction has less cost to first order.
    jacobian = np.zeros((program.n_constraints, program.n_unknowns))
    jacobian[program.jacobianstructure()] = program.jacobian(result.x)
    free = program.lower < program.upper
    y = np.linalg.lstsq(jacobian[:, free].T, -program.gradient(result.x)[free], rcond=None)[0]
    assert np.abs(program.gradient(result.x)[free] + y @ jacobian[:, free]).max() < 1e-6


def test_limits_of_the_robot_are_bounds(two_link):
    robot = two_link.with_limits(two_link.joint_names[0], lower=-1, upper=2, velocity=3, effort=4)
    program = transcription(robot, limits=True, reach=False)
    (x_lower, u_lower), (x_upper, u_upper) = program.split(program.lower), program.split(program.upper)
    assert (x_lower[0] == x_upper[0]).all() and (x_upper[-1] == x_upper[1]).all()
    assert (x_lower[1, 0], x_upper[1, 0], x_lower[1, 2], x_upper[1, 2]) == (-1, 2, -3, 3)
    assert (u_lower[0, 0], u_upper[0, 0]) == (-4, 4)


def newton(program, w, iterations=30):
    """A solver for equality constraints that knows a program only by the protocol of cyipopt."""
    free = program.lower < program.upper
    w = np.where(free, w, program.lower)
    y = np.zeros(program.n_constraints)
    for _ in range(iterations):
        jacobian = np.zeros((program.n_constraints, program.n_unknowns))
        jacobian[program.jacobianstructure()] = program.jacobian(w)
        lower = np.zeros((program.n_unknowns,) * 2)
        lower[program.hessianstructure()] = program.hessian(w, y, 1.0)
        h, j = (lower + np.tril(lower, -1).T)[np.ix_(free, free)], jacobian[:, free]
        kkt = np.block([[h, j.T], [j, np.zeros((len(y), len(y)))]])
        residual = np.concatenate([(program.gradient(w) + y @ jacobian)[free], program.constraints(w)])
        change = np.linalg.solve(kkt, -residual)
        w[free] += change[: free.sum()]
        y = y + change[free.sum() :]
        if np.abs(residual).max() < 1e-11:
            return w
    raise AssertionError(f"Newton's method stopped at {np.abs(residual).max()}")


def test_the_protocol_of_cyipopt_is_enough_to_solve(two_link):
    program = transcription(two_link, intervals=10)
    expected = program.minimize(gtol=1e-6, maxiter=300)
    found = newton(program, expected.x)
    assert_close(found, expected.x, 1e-4)
    assert abs(program.objective(found) - expected.fun) < 1e-7 * expected.fun


def test_ipopt_solves_it(two_link):
    pytest.importorskip("cyipopt")
    program = transcription(two_link, intervals=10)
    expected = newton(program, program.minimize(gtol=1e-6, maxiter=300).x)
    w, report = program.ipopt(expected, print_level=0)
    assert report["status"] == 0
    assert_close(w, expected, 1e-6)


@pytest.mark.parametrize("coordinates", ["qv", "qp"])
def test_the_maximum_principle_by_solve_bvp(two_link, coordinates, random, no_differences):
    dynamics = Counted(costate.Dynamics(two_link, coordinates))
    goal = [0.4, -0.3, 0.0, 0.0]
    extremal = costate.scipy.Extremal(dynamics, np.zeros(4), goal, effort=[1.0, 2.0])
    z = random.normal(size=(8, 3))
    jacobian = extremal.fun_jac(None, z)
    for k in range(3):
        differences = central_differences(lambda z: extremal.fun(None, z[:, None])[:, 0], z[:, k])
        assert_close(jacobian[..., k], differences, 1e-6)
    dynamics.calls.clear()
    solution = extremal.solve(1.0, tol=1e-6)
    assert solution.status == 0 and solution.rms_residuals.max() < 1e-6
    # The Hamiltonian is constant along a motion of the maximum principle.
    tau = extremal.torques(solution.y)
    rates = extremal.fun(None, solution.y)[:4]
    energy = (solution.y[4:] * rates).sum(axis=0) - 0.5 * (np.array([[1.0], [2.0]]) * tau**2).sum(axis=0)
    assert np.ptp(energy) < 1e-4 * np.abs(energy).max()
    assert dynamics.calls["contract"] >= solution.niter
    # The same motion in small steps costs as much, up to their length.
    fine = costate.scipy.Transcription(
        costate.Step(costate.Dynamics(two_link), "rk4", 0.02), 50, np.zeros(4), goal, effort=[1.0, 2.0]
    )
    least = fine.objective(newton(fine, fine.guess()))
    times = np.linspace(0, 1, 2001)
    integrand = 0.5 * (np.array([[1.0], [2.0]]) * extremal.torques(solution.sol(times)) ** 2).sum(axis=0)
    assert abs(np.trapezoid(integrand, times) - least) < 2e-3 * least


def test_what_does_not_fit_is_refused(two_link):
    step = costate.Step(costate.Dynamics(two_link), "rk4", 0.1)
    for arguments, name in [
        ((step, 0, np.zeros(4), np.zeros(4)), "intervals"),
        ((step, 3, np.zeros(3), np.zeros(4)), "start"),
        ((step, 3, np.zeros(4), [0, 0, np.nan, 0]), "goal"),
    ]:
        with pytest.raises(costate.ArgumentError, match=name) as raised:
            costate.scipy.Transcription(*arguments)
        assert raised.value.argument == name
    with pytest.raises(costate.ArgumentError, match="effort"):
        costate.scipy.Extremal(step.dynamics, np.zeros(4), np.zeros(4), effort=0.0)
    with pytest.raises(costate.ArgumentError, match="w has the shape"):
        costate.scipy.Transcription(step, 3, np.zeros(4), np.zeros(4)).objective(np.zeros(3))
