"""Robots whose loops are closed by constraints, against the open tree, closed forms and differences."""

import copy
import pickle

import costate
import numpy as np
import pytest
from conftest import assert_close, central_differences, load

CLOSED = np.array([1.0, -0.5917379150, -2.058615394])  # The crank at 1 rad, from the file of the robot.


@pytest.fixture(scope="module")
def four_bar() -> costate.Robot:
    return load("four_bar.toml")


@pytest.fixture(scope="module")
def dynamics(four_bar) -> costate.ConstrainedDynamics:
    return costate.ConstrainedDynamics(four_bar)


@pytest.fixture(scope="module")
def tree(four_bar) -> costate.Dynamics:
    return costate.Dynamics(four_bar.without_constraints())


@pytest.fixture
def state(dynamics, random):
    """Closed, with a velocity that the constraint allows; torques, a costate and a direction."""
    q = dynamics.close(CLOSED + [0.3, 0.1, -0.1], held=["crank"])
    v, _ = dynamics.velocity(q, random.normal(size=3))
    return q, dynamics.momentum(q, v), v, *(random.normal(size=k) for k in (3, 6, 9))


def test_a_loop_is_closed(dynamics, tree):
    q = dynamics.close([1.0, -0.3, -1.5], held=["crank"])
    assert_close(q, CLOSED, 1e-9)
    assert np.abs(dynamics.constraint(q)).max() < 1e-12 and (dynamics.n, dynamics.k) == (3, 2)
    assert_close(tree.frame("rocker_tip").pose(q)[1], [1.3, 0, 0], 1e-12)
    assert_close(dynamics.constraint_jacobian(q), tree.frame("rocker_tip").jacobian(q)[3:5], 1e-13)
    assert dynamics.row_names == ["rocker_pivot"] * 2 and dynamics.counted(q).tolist() == [1.0, 1.0]
    free = dynamics.close([1.0, -0.3, -1.5])
    assert np.abs(dynamics.constraint(free)).max() < 1e-12 and abs(free[0] - 1.0) > 1e-3


def test_the_motion_is_that_of_the_tree_under_the_forces(dynamics, tree, state):
    """M a + C v + g = tau + J'lambda, and no acceleration leaves the loop."""
    q, p, v, tau, *_ = state
    f, a = dynamics.f(q, p, tau), dynamics.acceleration(q, p, tau)
    force, moment = dynamics.forces(q, p, tau)
    jacobian, lambda_ = dynamics.constraint_jacobian(q), dynamics.multipliers(q, p, tau)
    assert_close(f[:3], v, 1e-12)
    assert_close(tree.rnea(q, v, a), tau + lambda_ @ jacobian, 1e-11)
    # Along the motion J v stays zero.
    rate = central_differences(lambda s: dynamics.constraint_rate(q + s * v, v + s * a), np.zeros(1)) @ [1.0]
    assert np.abs(rate).max() < 1e-6 and np.abs(dynamics.constraint_rate(q, v)).max() < 1e-12
    # The same force on the tip of the open tree, in N.
    assert force.shape == moment.shape == (1, 3) and not moment.any()
    assert_close(force[0], [*lambda_, 0.0], 1e-14)
    pushed = tree.frame("rocker_tip").jacobian(q)[3:].T @ force[0]
    assert_close(tree.aba(q, v, tau + pushed), a, 1e-10)
    assert_close(dynamics.energy(q, p)[0], tree.energy(q, v)[0], 1e-12)
    assert_close(dynamics.energy(q, p)[1], tree.energy(q, v)[1], 1e-12)


def test_forces_have_axes_of_the_second_frame(four_bar, tree, state):
    q, p, v, tau, *_ = state
    known = costate.ConstrainedDynamics(four_bar).forces(q, p, tau)[0][0]
    turned = four_bar.without_constraints().with_constraint(
        "pivot", "rocker", xyz=[0.9, 0, 0], to_xyz=[1.3, 0, 0], to_rpy=[0, 0, 0.7], rows=["x", "y"]
    )
    force, moment = costate.ConstrainedDynamics(turned).forces(q, p, tau)
    turn = np.array([[np.cos(0.7), -np.sin(0.7), 0], [np.sin(0.7), np.cos(0.7), 0], [0, 0, 1]])
    assert_close(turn @ force[0], known, 1e-10)
    # A rod without mass from the tip to a place above the pivot pulls or pushes along itself.
    rod = four_bar.without_constraints().with_constraint(
        "rod", "rocker_tip", to_xyz=[1.3, 0.4, 0], kind="distance", length=0.4
    )
    force, moment = costate.ConstrainedDynamics(rod).forces(q, tree.momentum(q, np.zeros(3)), tau)
    assert abs(force[0, 0]) < 1e-9 * abs(force[0, 1]) and not moment.any()
    joints, constant = {"crank": 1.0, "coupler": 2.0}, q[0] + 2 * q[1]
    geared = four_bar.with_constraint("gear", kind="coupling", joints=joints, constant=constant)
    geared = costate.ConstrainedDynamics(geared)
    force, moment = geared.forces(q, np.zeros(3), tau)
    assert geared.row_names == ["rocker_pivot", "rocker_pivot", "gear"] and force.shape == (2, 3)
    assert np.isfinite(force[0]).all() and np.isnan(force[1]).all() and np.isnan(moment[1]).all()
    assert np.isfinite(geared.multipliers(q, np.zeros(3), tau)).all()


def test_derivatives_are_those_of_differences(dynamics, state):
    q, p, _, tau, y, d = state
    z = np.concatenate([q, p, tau])
    parts = lambda z: (z[:3], z[3:6], z[6:])
    jacobian, hessian = dynamics.jacobian(q, p, tau), dynamics.hessian(q, p, tau, y)
    assert_close(jacobian, central_differences(lambda z: dynamics.f(*parts(z)), z), 1e-7)
    assert_close(hessian, central_differences(lambda z: dynamics.adjoint(*parts(z), y), z), 1e-7)
    assert_close(dynamics.adjoint(q, p, tau, y), y @ jacobian, 1e-12)
    assert_close(dynamics.hvp(q, p, tau, y, d), hessian @ d, 1e-11)
    for found, expected in zip(dynamics.contract(q, p, tau, y), (dynamics.f(q, p, tau), jacobian, hessian), strict=True):
        assert_close(found, expected, 1e-13)
    for found, expected in zip(dynamics.linearise(q, p, tau), (dynamics.f(q, p, tau), jacobian), strict=True):
        assert_close(found, expected, 1e-13)


def test_batches_are_the_states_one_by_one(dynamics, state, random):
    q, p, v, tau, y, d = state
    many = q + 0.1 * random.normal(size=(70, 3))
    cases = {"f": (many, p, tau), "hessian": (many, p, tau, y), "contract": (many, p, tau, y), "hvp": (many, p, tau, y, d)}
    cases |= {"forces": (many, p, tau), "velocity": (many, p), "project": (many, p, q), "close": (many,), "drift": (many, q)}
    cases |= {"momentum": (many, v), "counted": (many,), "constraint_jacobian": (many,), "multipliers": (many, p, tau)}
    for verb, given in cases.items():
        method = getattr(dynamics, verb)
        found = method(*given)
        alone = [method(given[0][k], *given[1:]) for k in (0, 69)]
        for part, *ends in zip(*((each,) if isinstance(each, np.ndarray) else each for each in (found, *alone)), strict=True):
            assert part.shape[0] == 70 and (part[0] == ends[0]).all() and (part[69] == ends[1]).all(), verb
    out = np.empty((70, 6))
    assert dynamics.f(many, p, tau, out=out) is out and (out == dynamics.f(many, p, tau)).all()
    threads = costate.ConstrainedDynamics(dynamics.robot, threads=1)
    assert (threads.f(many, p, tau) == out).all() and threads.threads == 1


def test_momenta_and_impacts(dynamics, tree, state):
    q, p, v, *_ = state
    assert_close(p, tree.momentum(q, v), 1e-13)
    found, mu = dynamics.velocity(q, p)
    assert_close(found, v, 1e-12)
    assert np.abs(mu).max() < 1e-12
    # A velocity that the constraint does not allow: the impulse changes the momentum along J' alone.
    before = np.array([1.0, 0.0, 0.0])
    after, mu = dynamics.velocity(q, tree.momentum(q, before))
    assert np.abs(dynamics.constraint_rate(q, after)).max() < 1e-12
    assert_close(tree.momentum(q, before), tree.momentum(q, after) - dynamics.constraint_jacobian(q).T @ mu, 1e-12)


def test_an_impact_and_its_derivatives(dynamics, tree, state, random):
    q = state[0]
    before = np.array([1.0, 0.3, -0.2])
    p, y = tree.momentum(q, before), random.normal(size=3)
    v, p_after, impulse, loss = dynamics.impact(q, p)
    assert_close(p_after, tree.momentum(q, v), 1e-12)
    assert_close(p_after - p, dynamics.constraint_jacobian(q).T @ impulse, 1e-12)
    assert np.abs(dynamics.constraint_rate(q, v)).max() < 1e-12
    assert loss > 0 and abs(tree.energy(q, before)[0] - tree.energy(q, v)[0] - loss) < 1e-12
    x = np.concatenate([q, p])
    for k, jacobian in enumerate(dynamics.impact_jacobian(q, p)):
        assert_close(jacobian, central_differences(lambda x, k=k: dynamics.impact(x[:3], x[3:])[k], x), 1e-7)
    gradient = lambda x: y @ dynamics.impact_jacobian(x[:3], x[3:])[1]
    assert_close(dynamics.impact_hessian(q, p, y), central_differences(gradient, x), 1e-7)


def test_derivatives_of_forces(dynamics, state, random):
    q, p, _, tau, *_ = state
    z, c = np.concatenate([q, p, tau]), random.normal(size=2)
    parts = lambda z: (z[:3], z[3:6], z[6:])
    jacobian = dynamics.multiplier_jacobian(q, p, tau)
    assert_close(jacobian, central_differences(lambda z: dynamics.multipliers(*parts(z)), z), 1e-6)
    gradient = lambda z: c @ dynamics.multiplier_jacobian(*parts(z))
    hessian = dynamics.multiplier_hessian(q, p, tau, c)
    assert_close(hessian, central_differences(gradient, z), 1e-6)
    assert (hessian == hessian.T).all()
    with pytest.raises(costate.ArgumentError, match="row"):
        dynamics.multiplier_hessian(q, p, tau, np.ones(3))


def test_energy_and_drift_along_a_motion(dynamics, state):
    q, p, *_ = state
    tau, x, dt = np.zeros(3), np.concatenate([q, p]), 2e-3
    energy = sum(dynamics.energy(q, p))
    rate = lambda x: dynamics.f(x[:3], x[3:], tau)
    for _ in range(500):
        k1 = rate(x)
        k2 = rate(x + dt / 2 * k1)
        k3 = rate(x + dt / 2 * k2)
        x = x + dt / 6 * (k1 + 2 * k2 + 2 * k3 + rate(x + dt * k3))
    assert abs(sum(dynamics.energy(x[:3], x[3:])) - energy) < 1e-8 * abs(energy)
    assert np.abs(dynamics.drift(x[:3], q)).max() < 1e-8
    # Where the motion has drifted, projecting it brings it back.
    there = x[:3] + [1e-3, -2e-3, 1e-3]
    assert np.abs(dynamics.drift(there, q)).max() > 1e-4
    back, momentum = dynamics.project(there, x[3:], q)
    assert np.abs(dynamics.drift(back, q)).max() < 1e-12
    v, mu = dynamics.velocity(back, momentum)
    assert np.abs(mu).max() < 1e-12
    assert_close(momentum, dynamics.momentum(back, v), 1e-12)


def test_what_cannot_be_closed_is_told(four_bar, dynamics):
    tree = four_bar.without_constraints()
    far = costate.ConstrainedDynamics(tree.with_constraint("far", "rocker_tip", to_xyz=[5.0, 0, 0], rows=["x", "y"]))
    with pytest.raises(costate.ConstraintError, match="far") as caught:
        far.close([0.1, 0.2, 0.3])
    assert caught.value.constraint == "far" and 2.4 < caught.value.miss < 2.5 and caught.value.index == ()
    with pytest.raises(costate.StateError) as caught:
        far.close(np.zeros((3, 3)) + [0.1, 0.2, 0.3])
    assert caught.value.index == (0,)
    quiet = costate.ConstrainedDynamics(far.robot, on_error="nan")
    with pytest.warns(costate.StateWarning):
        assert np.isnan(quiet.close([0.1, 0.2, 0.3])).all()
    other = four_bar.with_constraint("other", "rocker_tip", to_xyz=[1.4, 0, 0], rows=["x"])
    with pytest.raises(costate.ConstraintError, match="contradicts") as caught:
        costate.ConstrainedDynamics(other).close(CLOSED)
    assert caught.value.constraint == "other" and abs(caught.value.miss - 0.1) < 1e-6
    same = costate.ConstrainedDynamics(four_bar.with_constraint("same", "rocker_tip", "pivot", rows=["x"]))
    assert same.counted(CLOSED).tolist() == [1.0, 1.0, 0.0]
    with pytest.raises(costate.NonFiniteState, match="q.1."):
        dynamics.f([0.0, np.nan, 0.0], np.zeros(3), np.zeros(3))
    with pytest.raises(costate.ArgumentError, match="wrist"):
        dynamics.close(CLOSED, held=["wrist"])
    with pytest.raises(costate.ArgumentError):
        costate.ConstrainedDynamics(four_bar, on_error="ignore")


def test_constraints_are_part_of_a_robot(four_bar):
    tree = four_bar.without_constraints()
    assert four_bar.constraint_names == ["rocker_pivot"] and tree.constraint_names == [] and tree != four_bar
    again = tree.with_constraint("rocker_pivot", "rocker_tip", "pivot", rows=["x", "y"])
    assert again == four_bar
    joints = {"crank": 1.0, "rocker": -0.5}
    geared = tree.with_constraint("gear", kind="coupling", joints=joints, constant=0.2)
    joints["crank"] = 7.0
    for robot in (again, geared, tree.with_constraint("weld", "rocker_tip", kind="rigid")):
        assert pickle.loads(pickle.dumps(robot)) == copy.copy(robot) == robot
    assert costate.ConstrainedDynamics(tree.with_constraint("ball", "rocker_tip", kind="pinned")).k == 3
    dynamics = costate.ConstrainedDynamics(geared, threads=2)
    other = pickle.loads(pickle.dumps(dynamics))
    assert other == dynamics and hash(other) == hash(dynamics) and other.threads == 2 and other.on_error == "raise"
    assert dynamics != costate.ConstrainedDynamics(four_bar, threads=2)
    assert repr(dynamics) == 'ConstrainedDynamics("four_bar", n=3, k=1)' and dynamics.robot == geared
    assert costate.ConstrainedDynamics(tree).constraint(CLOSED).shape == (0,)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"kind": "glued"}, "kind"),
        ({"frame": "rocker_tip"}, "rows"),
        ({"rows": ["x"]}, "frame"),
        ({"frame": "rocker_tip", "rows": ["w"]}, "turn_z"),
        ({"frame": "rocker_tip", "kind": "pinned", "rows": ["x"]}, "rows"),
        ({"frame": "rocker_tip", "kind": "distance"}, "length"),
        ({"frame": "rocker_tip", "kind": "rigid", "constant": 1.0}, "constant"),
        ({"to": "pivot", "kind": "pinned"}, "frame"),
        ({"kind": "coupling"}, "joints"),
        ({"kind": "coupling", "joints": {"crank": 1.0}, "xyz": [1, 0, 0]}, "frames"),
    ],
)
def test_arguments_of_a_constraint(four_bar, given, words):
    with pytest.raises(costate.ArgumentError, match=words):
        four_bar.with_constraint("more", **given)


def test_what_would_ignore_a_constraint_refuses_it(four_bar):
    task = {"start": CLOSED, "end": CLOSED, "time": 1.0, "cost": [1.0] * 3}
    for call, error in (
        (lambda: costate.Dynamics(four_bar), costate.RobotError),
        (lambda: costate.check(four_bar, 1), costate.RobotError),
        (lambda: costate.codegen(four_bar, "f"), costate.RobotError),
        (lambda: costate.Problem(four_bar, **task).resolve(), costate.ProblemError),
        (lambda: four_bar.with_constraint("more", "nowhere", rows=["x"]), costate.RobotError),
        (lambda: four_bar.with_constraint("rocker_pivot", "crank", rows=["x"]), costate.RobotError),
    ):
        with pytest.raises(error, match="rocker_pivot|nowhere"):
            call()
    with pytest.raises(costate.RobotError) as caught:
        costate.Dynamics(four_bar)
    assert caught.value.culprit == "rocker_pivot"
