"""Second derivatives in CasADi that go through Jacobians, twists, the centre of mass, and reasons of refusals."""

import costate
import numpy as np
import pytest
from conftest import assert_close, load

ca = pytest.importorskip("casadi")
import costate.casadi as cc  # noqa: E402

QUIET = {"ipopt.print_level": 0, "print_time": 0, "ipopt.sb": "yes"}


def arm_with_tip():
    return load("two_link.toml").add_frame("tip", "elbow", xyz=[0.7, 0.1, 0])


FUNCTIONS = {
    "dynamics": lambda robot: cc.dynamics(robot),
    "inverse_dynamics": lambda robot: cc.inverse_dynamics(robot),
    "step": lambda robot: cc.step(robot, "rk4", 0.1),
    "frame": lambda robot: cc.frame(robot, "tip"),
    "twist": lambda robot: cc.twist(robot, "tip"),
    "centre_of_mass": lambda robot: cc.centre_of_mass(robot),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_all_second_derivatives_are_those_that_are_contracted(name, random):
    """The Jacobian of the Jacobian, row by row, is the Hessian of each result, which has its own function."""
    function = FUNCTIONS[name](arm_with_tip())
    arguments = [ca.MX.sym(function.name_in(k), *function.sparsity_in(k).shape) for k in range(function.n_in())]
    f = ca.vertcat(*[ca.vec(result) for result in function.call(arguments)])
    z = ca.veccat(*arguments)
    # The function jac_f itself: of `ca.jacobian(f, z)` CasADi may make adjoints.
    blocks = function.jacobian().call([*arguments, *(ca.MX() for _ in range(function.n_out()))])
    width = len(arguments)
    slope = ca.vertcat(*[ca.horzcat(*blocks[k : k + width]) for k in range(0, len(blocks), width)])
    bend = ca.Function("bend", arguments, [ca.densify(ca.jacobian(ca.vec(slope), z))])
    at = [random.normal(size=argument.shape) for argument in arguments]
    before = cc.calls(function)
    found = np.array(bend(*at))
    after = cc.calls(function)
    assert after["jac_jac_f"] == before["jac_jac_f"] + 1 and after["f"] == before["f"] and after["jac_f"] == before["jac_f"]
    m, count = f.numel(), z.numel()
    for k in range(m):
        hessian = ca.Function("h", arguments, [ca.densify(ca.hessian(f[k], z)[0])])
        assert_close(found.reshape(count, m, count)[:, k], np.array(hessian(*at)), 1e-11)


def test_what_is_made_of_a_jacobian_can_be_differentiated(random):
    robot = arm_with_tip()
    pose, dynamics = cc.frame(robot, "tip"), costate.Dynamics(robot)
    q, v = ca.MX.sym("q", 2), ca.MX.sym("v", 2)
    x = pose(q)[1]
    at, along = random.normal(size=(2, 2))
    tip = dynamics.frame("tip")
    # The acceleration at constant rates, and the gradient of a measure of manipulability.
    bias = ca.Function("bias", [q, v], [ca.jtimes(ca.jtimes(x, q, v), q, v)])(at, along)
    assert_close(np.array(bias).ravel(), tip.acceleration(at, along, np.zeros(2))[3:], 1e-11)
    slope = ca.Function("slope", [q], [ca.gradient(ca.sumsqr(ca.jacobian(x, q)), q)])(at)
    J = tip.jacobian(at)[3:]
    expected = sum(2 * J[i] @ tip.position_hessian(at, np.eye(3)[i]) for i in range(3))
    assert_close(np.array(slope).ravel(), expected, 1e-11)


def test_twists_and_centres_of_mass_are_those_of_frames(ur5, random):
    q, v = random.normal(size=(2, 6))
    dynamics = costate.Dynamics(ur5)
    twist = np.concatenate([np.array(part).ravel() for part in cc.twist(ur5, "tool0")(q, v)])
    assert_close(twist, dynamics.frame("tool0").twist(q, v))
    assert_close(np.array(cc.centre_of_mass(ur5)(q)).ravel(), dynamics.centre_of_mass(q))
    symbols = ca.MX.sym("q", 6), ca.MX.sym("v", 6)
    slope = ca.Function("slope", symbols, [ca.jacobian(ca.vertcat(*cc.twist(ur5, "tool0")(*symbols)), symbols[1])])
    assert_close(np.array(slope(q, v)), dynamics.frame("tool0").jacobian(q))
    with pytest.raises(costate.RobotError, match="tool9"):
        cc.twist(ur5, "tool9")


def test_a_velocity_of_a_tool_is_demanded_with_the_exact_hessian():
    robot = arm_with_tip()
    twist = cc.twist(robot, "tip")
    opti = ca.Opti()
    q, v = opti.variable(2), opti.variable(2)
    opti.minimize(ca.sumsqr(q) + ca.sumsqr(v))
    opti.subject_to(twist(q, v)[1][:2] == ca.DM([0.1, 0.2]))
    opti.set_initial(q, [0.3, 0.4])
    opti.solver("ipopt", QUIET)
    solution = opti.solve()
    assert cc.calls(twist)["jac_adj1_f"] == solution.stats()["n_call_nlp_hess_l"] > 0
    found = costate.Dynamics(robot).frame("tip").twist(solution.value(q), solution.value(v))
    assert_close(found[3:5], np.array([0.1, 0.2]), 1e-7)


@pytest.mark.parametrize("kind", ["rk", "collocation", "cvodes", "idas"])
def test_integrators_of_casadi_have_sensitivities(kind, random):
    """Forward and adjoint ones, against central differences of the integrator itself."""
    a = cc.dynamics(load("two_link.toml"))
    x, tau = ca.MX.sym("x", 4), ca.MX.sym("tau", 2)
    options = {"abstol": 1e-12, "reltol": 1e-12} if kind in ("cvodes", "idas") else {}
    dae = {"x": x, "p": tau, "ode": ca.vertcat(x[2:], a(x[:2], x[2:], tau))}
    end = ca.integrator("end", kind, dae, 0, 0.1, options)(x0=x, p=tau)["xf"]
    value = ca.Function("value", [x, tau], [end])
    at, given, y = random.normal(size=4), random.normal(size=2), random.normal(size=4)
    forward = ca.Function("forward", [x, tau], [ca.jacobian(end, tau)])(at, given)
    adjoint = ca.Function("adjoint", [x, tau], [ca.gradient(ca.dot(ca.DM(y), end), tau)])(at, given)
    step = 1e-5
    columns = [value(at, given + step * d) - value(at, given - step * d) for d in np.eye(2)]
    expected = np.hstack([np.array(column) / (2 * step) for column in columns])
    assert_close(np.array(forward), expected, 1e-6)
    assert_close(np.array(adjoint).ravel(), y @ expected, 1e-5)


@pytest.mark.parametrize("kind", ["rk", "collocation", "cvodes", "idas"])
def test_a_hessian_through_an_integrator(kind, random):
    a = cc.dynamics(load("two_link.toml"))
    x, tau = ca.MX.sym("x", 4), ca.MX.sym("tau", 2)
    dae = {"x": x, "p": tau, "ode": ca.vertcat(x[2:], a(x[:2], x[2:], tau))}
    options = {"abstol": 1e-12, "reltol": 1e-12} if kind in ("cvodes", "idas") else {}
    end = ca.sum1(ca.integrator("end", kind, dae, 0, 0.1, options)(x0=x, p=tau)["xf"])
    at, given = random.normal(size=4), random.normal(size=2)
    hessian = np.array(ca.Function("h", [x, tau], [ca.hessian(end, tau)[0]])(at, given))
    slope = ca.Function("g", [x, tau], [ca.gradient(end, tau)])
    step = 1e-4
    columns = [slope(at, given + step * d) - slope(at, given - step * d) for d in np.eye(2)]
    expected = np.hstack([np.array(column) / (2 * step) for column in columns])
    assert np.abs(hessian - expected).max() < 1e-5 * np.abs(np.array(slope(at, given))).max()


def test_third_derivatives_are_errors():
    x = ca.MX.sym("q", 2)
    bend = ca.jacobian(ca.jacobian(cc.frame(arm_with_tip(), "tip")(x)[1], x), x)
    with pytest.raises(RuntimeError, match="Derivatives cannot be calculated"):
        ca.Function("third", [x], [ca.jacobian(bend, x)])


def test_a_refusal_says_why(ur5):
    a = cc.dynamics(ur5)
    assert cc.refusal(a) is None
    with pytest.raises(RuntimeError):
        a(0, [0, 0, np.nan, 0, 0, 0], 0)
    assert "elbow" in cc.refusal(a) and "not finite" in cc.refusal(a)
    with pytest.raises(costate.ArgumentError, match="no function of costate.casadi"):
        cc.refusal(ca.Function("f", [], []))
