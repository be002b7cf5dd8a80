"""Functions for CasADi: derivatives against costate's own and against CasADi's, calls that are counted, slots."""

import gc
import pickle
import shutil
import subprocess
import sys

import costate
import numpy as np
import pytest
from conftest import ROBOTS, assert_close, load, pendulum

ca = pytest.importorskip("casadi")
import costate.casadi as cc  # noqa: E402

QUIET = {"ipopt.print_level": 0, "print_time": 0, "ipopt.sb": "yes"}


def everything(function, y: np.ndarray):
    """Value, Jacobian, gradient and Hessian of y'f in all arguments, by CasADi; f may have several results."""
    arguments = [ca.MX.sym(function.name_in(k), *function.sparsity_in(k).shape) for k in range(function.n_in())]
    results = function.call(arguments)
    f = ca.vertcat(*[ca.vec(result) for result in results])
    z = ca.vertcat(*[ca.vec(argument) for argument in arguments])
    hessian, gradient = ca.hessian(ca.dot(y, f), z)
    return ca.Function("all", arguments, [f, ca.jacobian(f, z), gradient, ca.densify(hessian)])


def evaluated(function, *arguments):
    return [np.array(result) for result in function(*arguments)]


@pytest.mark.parametrize("file", ["ur5.urdf", "puma560.toml", "panda.urdf", "humanoid32.urdf"])
def test_dynamics_have_the_derivatives_of_dynamics(file, random):
    robot = load(file)
    n, dynamics = robot.n, costate.Dynamics(robot)
    q, v, tau = random.normal(size=(3, n))
    y = random.normal(size=n)
    f, jacobian, hessian = dynamics.contract(q, v, tau, np.concatenate([0 * y, y]))
    found = evaluated(everything(cc.dynamics(robot), y), q, v, tau)
    for part, expected in zip(found, (f[n:, None], jacobian[n:], (y @ jacobian[n:])[:, None], hessian)):
        assert_close(part, expected)
    inverse = everything(cc.inverse_dynamics(robot), y)
    expected = (dynamics.rnea(q, v, tau)[:, None], dynamics.rnea_jacobian(q, v, tau))
    expected += ((y @ expected[1])[:, None], dynamics.rnea_hessian(q, v, tau, y))
    for part, of in zip(evaluated(inverse, q, v, tau), expected):
        assert_close(part, of)


@pytest.mark.parametrize("scheme, letters", [("rk4", "qv"), ("midpoint", "qp"), ("verlet", "qp")])
def test_steps_have_the_derivatives_of_steps(scheme, letters, puma, random):
    dynamics = costate.Dynamics(puma, letters)
    step = costate.Step(dynamics, scheme, 0.01)
    q, v, tau = random.normal(size=(3, 6)) * 0.5
    y = random.normal(size=12)
    after, jacobian, hessian = step.contract(q, v, tau, y)
    found = evaluated(everything(cc.step(dynamics, scheme, 0.01), y), np.concatenate([q, v]), tau)
    for part, expected in zip(found, (after[:, None], jacobian, (y @ jacobian)[:, None], hessian)):
        assert_close(part, expected)


def test_frames_have_the_derivatives_of_a_rotation_written_in_casadi(random):
    """Two hinges and a slide, written again in CasADi's own operations, which differentiates them itself."""
    builder = costate.Robot.builder("arm").revolute("a", axis=[0, 0, 1], mass=1, com=[1, 0, 0])
    builder = builder.revolute("b", on="a", xyz=[1, 0, 0.2], axis=[0, 1, 0], mass=1, com=[1, 0, 0])
    robot = builder.prismatic("c", on="b", xyz=[0, 0.3, 0], axis=[1, 0, 0], mass=1).frame("tip", "c", xyz=[0.5, 0, 0.1])
    q = ca.SX.sym("q", 3)
    cos, sin = ca.cos(q), ca.sin(q)
    about_z = ca.blockcat([[cos[0], -sin[0], 0], [sin[0], cos[0], 0], [0, 0, 1]])
    about_y = ca.blockcat([[cos[1], 0, sin[1]], [0, 1, 0], [-sin[1], 0, cos[1]]])
    R = about_z @ about_y
    x = about_z @ ca.DM([1, 0, 0.2]) + R @ (ca.vertcat(q[2], 0.3, 0) + ca.DM([0.5, 0, 0.1]))
    at, y = random.normal(size=3), random.normal(size=12)
    frame = cc.frame(robot.build(), "tip")
    expected = evaluated(everything(ca.Function("pose", [q], [R, x]), y), at)
    for part, of in zip(evaluated(everything(frame, y), at), expected):
        assert_close(part, of)


def test_a_frame_of_a_real_robot(ur5, random):
    q = random.normal(size=6)
    R, x = evaluated(cc.frame(ur5, "tool0"), q)
    rotation, position = costate.Dynamics(ur5).frame("tool0").pose(q)
    assert_close(R, rotation)
    assert_close(x[:, 0], position)
    with pytest.raises(costate.RobotError, match="tool9"):
        cc.frame(ur5, "tool9")


def reach(step, robot, intervals, start, end):
    """Rest to rest within a second with little effort: a problem, and cubics with their torques as its guess."""
    n = robot.n
    x, tau = ca.MX.sym("x", 2 * n, intervals + 1), ca.MX.sym("tau", n, intervals)
    defects = [x[:, k + 1] - step(x[:, k], tau[:, k]) for k in range(intervals)]
    rest = np.zeros(n)
    ends = [x[:, 0] - np.concatenate([start, rest]), x[:, intervals] - np.concatenate([end, rest])]
    t, way = np.linspace(0, 1, intervals + 1)[:, None], end - start
    q, v, a = start + (3 - 2 * t) * t**2 * way, 6 * t * (1 - t) * way, (6 - 12 * t) * way
    torques = costate.Dynamics(robot).rnea(q, v, a)[:-1]
    guess = np.concatenate([np.hstack([q, v]).ravel(), torques.ravel()])
    cost = ca.sumsqr(tau) / intervals
    return {"x": ca.veccat(x, tau), "f": cost, "g": ca.veccat(*ends, *defects)}, guess


START, END = np.array([0, -1.2, 1.2, -1.5, -1.5, 0]), np.array([1.5, -0.8, 0.8, -1.2, -1.0, 0.7])


def test_a_motion_of_a_ur5_with_its_exact_hessian(ur5):
    """IPOPT finds it, and every derivative is one call for each interval."""
    intervals = 30
    step = cc.step(ur5, "rk4", 1 / intervals)
    problem, guess = reach(step, ur5, intervals, START, END)
    solver = ca.nlpsol("solver", "ipopt", problem, QUIET)
    solution = solver(x0=guess, lbg=0, ubg=0)
    stats, calls = solver.stats(), cc.calls(step)
    assert stats["return_status"] == "Solve_Succeeded"
    assert calls["jac_adj1_f"] == intervals * stats["n_call_nlp_hess_l"] > 0
    assert calls["jac_f"] == intervals * stats["n_call_nlp_jac_g"]
    # Differences would evaluate the step for each of its 18 arguments, or the adjoint for the Hessian.
    values = stats["n_call_nlp_g"] + stats["n_call_nlp_jac_g"] + stats["n_call_nlp_hess_l"]
    assert calls["f"] <= intervals * values and calls["adj1_f"] <= intervals * stats["n_call_nlp_hess_l"]
    x = np.array(solution["x"]).ravel()
    states, tau = x[: 12 * (intervals + 1)].reshape(-1, 12), x[12 * (intervals + 1) :].reshape(-1, 6)
    own = costate.Step(costate.Dynamics(ur5), "rk4", 1 / intervals)
    assert_close(own.f(states[:-1, :6], states[:-1, 6:], tau), states[1:], 1e-7)


def test_opti_and_a_chain_of_stages_find_the_same_motion():
    robot = pendulum()
    a, h = cc.dynamics(robot), 0.05

    def chain(x, tau):
        def rate(x):
            return ca.vertcat(x[1], a(x[0], x[1], tau))

        k1 = rate(x)
        k2 = rate(x + h / 2 * k1)
        k3 = rate(x + h / 2 * k2)
        return x + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(x + h * k3))

    costs = []
    for step in (chain, cc.step(robot, "rk4", h)):
        opti = ca.Opti()
        x, tau = opti.variable(2, 21), opti.variable(1, 20)
        opti.minimize(ca.sumsqr(tau))
        opti.subject_to(x[:, 0] == 0)
        opti.subject_to(x[:, 20] == ca.DM([3.0, 0.0]))
        for k in range(20):
            opti.subject_to(x[:, k + 1] == step(x[:, k], tau[:, k]))
        opti.solver("ipopt", QUIET)
        costs.append(opti.solve().value(opti.f))
    assert_close(costs[1], costs[0], 1e-10)
    stages = cc.calls(a)
    assert stages["jac_adj1_f"] > 0 and stages["jac_adj1_f"] % 80 == 0


@pytest.mark.parametrize("kind", ["serial", "thread"])
def test_functions_are_mapped(kind, ur5, random):
    states = 64
    a, q, v, tau = cc.dynamics(ur5), *random.normal(size=(3, 6, states))
    many = a.map(states, kind, 2) if kind == "thread" else a.map(states)
    for _ in range(5):
        found = np.array(many(q, v, tau))
        assert_close(found.T, costate.Dynamics(ur5).aba(q.T.copy(), v.T.copy(), tau.T.copy()), 1e-13)


def test_states_that_are_refused_are_errors_of_casadi(ur5):
    a = cc.dynamics(ur5)
    with pytest.raises(RuntimeError):
        a(np.full(6, np.nan), 0, 0)
    assert np.isfinite(np.array(a(0, 0, 0))).all()
    massless = load("two_link.toml")
    assert np.array(cc.inverse_dynamics(massless)([0, 0], [0, 0], [0, 0])).shape == (2, 1)


def test_a_slot_lives_as_long_as_anything_refers_to_it(ur5):
    gc.collect()
    before = cc.slots()[0]
    a = cc.dynamics(ur5)
    again = cc.dynamics(costate.Robot.from_file(ROBOTS / "ur5.urdf"))
    assert again.name() == a.name() and cc.slots()[0] == before + 1
    adjoint = a.reverse(1)
    del a, again
    assert cc.slots()[0] == before + 1
    z = [np.zeros(6), np.zeros(6), np.zeros(6), 0, np.ones(6)]
    assert_close(np.array(adjoint(*z)[2]).ravel(), np.linalg.solve(costate.Dynamics(ur5).crba(np.zeros(6)), np.ones(6)))
    with pytest.raises(costate.ArgumentError, match="no function"):
        cc.calls(ca.Function("f", [], []))
    del adjoint
    assert cc.slots()[0] == before


def test_all_slots_in_use_is_an_error_that_says_what_to_do():
    gc.collect()
    used, most = cc.slots()
    robot = pendulum()
    kept = [cc.step(robot, "rk4", 1e-3 * (1 + k)) for k in range(most - used)]
    assert len({function.name() for function in kept}) == len(kept)
    with pytest.raises(costate.CostateError, match="64 functions"):
        cc.dynamics(robot)
    results = [float(function([1, 0], 0)[1]) for function in kept]
    assert_close(results, [costate.Step(costate.Dynamics(robot), "rk4", 1e-3 * (1 + k)).f([1], [0], [0])[1]
                           for k in range(len(kept))])  # fmt: skip
    del kept
    assert cc.slots()[0] == used
    assert cc.dynamics(robot).n_in() == 3


def test_functions_are_pickled_for_another_process(ur5, random, tmp_path):
    q = ca.MX.sym("q", 6)
    a = cc.dynamics(ur5)
    function = ca.Function("slope", [q], [ca.jacobian(a(q, 0, 0), q)])
    at = random.normal(size=6)
    file = tmp_path / "slope.pickle"
    file.write_bytes(pickle.dumps(function))
    assert_close(np.array(pickle.loads(file.read_bytes())(at)), np.array(function(at)), 0)
    code = f"import pickle; f = pickle.load(open({str(file)!r}, 'rb')); print(f({at.tolist()}).full().tolist())"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert_close(eval(done.stdout), np.array(function(at)), 1e-14)


def test_a_slot_is_not_taken_for_another_robot(ur5):
    """What was stored for a slot that now holds something else is refused, and what holds it stays."""
    gc.collect()
    before = cc.slots()[0]
    a = cc.dynamics(ur5)
    stored, name = pickle.dumps(a), a.name()
    del a
    robot, kept = pendulum(), []
    while not any(function.name() == name for function in kept):
        kept.append(cc.step(robot, "rk4", 1e-3 * (1 + len(kept))))
    with pytest.raises(RuntimeError):
        pickle.loads(stored)
    with pytest.raises(RuntimeError):
        pickle.loads(stored)
    [taken] = [function for function in kept if function.name() == name]
    kept = None
    assert np.isfinite(np.array(taken([1, 0], 0))).all()
    with pytest.raises(RuntimeError):
        pickle.loads(stored)
    del taken
    # CasADi before 3.8 does not release what it was refused: slots stay in use.
    if not ca.__version__.startswith(("3.6.", "3.7.")):
        assert cc.slots()[0] == before


def test_compiled_source_computes_the_same(ur5, random, tmp_path):
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("no C compiler")
    (tmp_path / "ur5.c").write_text(cc.source(ur5, "semi_implicit_euler", 0.01))
    library = tmp_path / "ur5.so"
    subprocess.run([compiler, "-O0", "-shared", "-fPIC", tmp_path / "ur5.c", "-o", library, "-lm"], check=True)
    q, v, tau, y = random.normal(size=(4, 6))
    x, costate_of_x = np.concatenate([q, v]), random.normal(size=12)
    for name, ours, at, weights in [
        ("ur5_fd", cc.dynamics(ur5), (q, v, tau), y),
        ("ur5_id", cc.inverse_dynamics(ur5), (q, v, tau), y),
        ("ur5_step", cc.step(ur5, "semi_implicit_euler", 0.01), (x, tau), costate_of_x),
    ]:
        theirs = ca.external(name, str(library))
        assert theirs.name_in() == ours.name_in() and theirs.name_out() == ours.name_out()
        for part in (lambda f: f, lambda f: f.jacobian(), lambda f: f.reverse(1), lambda f: f.reverse(1).jacobian()):
            a, b = part(theirs), part(ours)
            assert [a.sparsity_in(k) for k in range(a.n_in())] == [b.sparsity_in(k) for k in range(b.n_in())]
            assert [a.sparsity_out(k) for k in range(a.n_out())] == [b.sparsity_out(k) for k in range(b.n_out())]
            assert a.name_in() == b.name_in() and a.name_out() == b.name_out()
        found = evaluated(everything(theirs, weights), *at)
        for part, expected in zip(found, evaluated(everything(ours, weights), *at)):
            assert_close(part, expected, 1e-10)
    with pytest.raises(costate.CodegenError, match="limit"):
        cc.source(ur5, limit=100)


def test_wrong_arguments(ur5):
    for call, words in [
        (lambda: cc.step(ur5, "rk5", 0.1), "unknown scheme"),
        (lambda: cc.step(ur5, "verlet", 0.1), "needs Dynamics"),
        (lambda: cc.step(ur5, "rk4", float("inf")), "finite"),
    ]:
        with pytest.raises(costate.ArgumentError, match=words):
            call()
    with pytest.raises(costate.ArgumentError, match="costate.Robot"):
        cc.dynamics("ur5")


def test_examples_of_docstrings():
    import doctest

    results = doctest.testmod(cc, extraglobs={})
    assert results.attempted > 20 and results.failed == 0
