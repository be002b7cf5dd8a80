"""Time steps of robots with floating and spherical joints."""

import pickle

import costate
import numpy as np
import pytest
from conftest import assert_close
from free_joints import (  # noqa: F401
    EPS,
    assert_batch_is_single_states,
    assert_derivatives_along,
    assert_verbs_agree,
    assert_within,
    batch,
    drone,
    slope,
    solving,
    state,
    tree,
)

# Bases without mass, which move.
pytestmark = pytest.mark.filterwarnings("ignore::costate.RobotWarning")
KINDS = [(scheme, coordinates) for scheme in ("rk4", "midpoint") for coordinates in ("qv", "qp")] + [("verlet", "qp")]
DT = 0.01


@pytest.mark.parametrize(("scheme", "coordinates"), KINDS)
def test_derivatives_are_those_in_the_tangent_spaces(tree, state, scheme, coordinates):
    """By finite differences between q (+) d and the difference from the next state."""
    q, v, tau, y, d = state
    n, nq = tree.n, tree.nq
    dynamics = costate.Dynamics(tree, coordinates)
    v = v if coordinates == "qv" else dynamics.momentum(q, v)
    step = costate.Step(dynamics, scheme, DT)
    following, jacobian, hessian = step.contract(q, v, tau, y)
    assert following.shape == (nq + n,) and jacobian.shape == (2 * n, 3 * n) and hessian.shape == (3 * n, 3 * n)
    assert_verbs_agree(step, (q, v, tau), y, d, (following, jacobian, hessian), 1e-11)
    assert_close(tree.normalize(following[:nq].copy()), following[:nq], 1e-15)

    d = d / np.linalg.norm(d)

    def along(s, direction=d):
        at = tree.integrate(q, s * direction[:n]), v + s * direction[n : 2 * n], tau + s * direction[2 * n :]
        moved = step.f(*at)
        return np.concatenate([tree.difference(following[:nq], moved[:nq]), moved[nq:] - following[nq:]])

    noise = solving(dynamics, q) * np.abs(following).max()
    assert_derivatives_along(along, y, d, jacobian, hessian, noise, 1e-3)


@pytest.mark.parametrize(("scheme", "coordinates"), KINDS)
def test_batches_are_single_states(tree, batch, scheme, coordinates):
    (q, v, tau, y), dynamics = batch, costate.Dynamics(tree, coordinates)
    step = costate.Step(dynamics, scheme, DT)
    v = v if coordinates == "qv" else dynamics.momentum(q[0, 0, 0], v)
    assert_batch_is_single_states(step, q, v, tau, y, tree.nq + tree.n)
    wrong = q.copy()
    wrong[1, 0, 3, 7:11] *= 1.2
    with pytest.raises(costate.NonUnitQuaternion, match="'hip' in q has the length 1.2") as raised:
        step.f(wrong, v, tau)
    assert raised.value.index[::2] == (1, 3)


@pytest.mark.parametrize(("scheme", "order"), [("rk4", 4), ("midpoint", 2)])
def test_steps_have_their_order_and_keep_what_they_should(drone, random, scheme, order):
    """A body that tumbles and falls: half of the step has 2^-order of the error; the spatial momentum by it."""
    dynamics = costate.Dynamics(drone)
    q, v = drone.integrate(drone.neutral(), random.normal(size=6)), random.normal(size=6)

    def end(scheme, steps):
        step, x = costate.Step(dynamics, scheme, 0.5 / steps), np.concatenate([q, v])
        for _ in range(steps):
            x = step.f(x[:7].copy(), x[7:].copy(), np.zeros(6))
        return x

    exact = end("rk4", 640)
    errors = []
    for steps in (10, 20):
        found = end(scheme, steps)
        off = np.concatenate([drone.difference(exact[:7], found[:7]), found[7:] - exact[7:]])
        errors.append(np.abs(off).max())
    assert abs(np.log2(errors[0] / errors[1]) - order) < 0.4
    before, after = (dynamics.centroidal_momentum(x[:7], x[7:])[0] for x in (np.concatenate([q, v]), exact))
    # Angular momentum stays, the linear one falls.
    assert_close(after - before, np.concatenate([np.zeros(3), 0.5 * drone.mass * drone.gravity]), 1e-8)
    energies = [sum(dynamics.energy(x[:7], x[7:])) for x in (np.concatenate([q, v]), exact)]
    assert energies[1] == pytest.approx(energies[0], rel=1e-8)


@pytest.fixture(scope="module")
def satellite():
    """A body with a hinge and a spherical joint, which tumbles in space."""
    builder = costate.Robot.builder("satellite")
    body = {"mass": 2.0, "com": [0.1, -0.2, 0.1], "inertia": [0.2, 0.3, 0.25, 0.01, -0.02, 0.03]}
    builder = builder.floating("body", **body)
    builder = builder.revolute("hinge", on="body", axis=[0, 0.6, 0.8], xyz=[0.3, 0, 0], mass=0.5, com=[0.2, 0, 0.1])
    builder = builder.spherical("ball", on="body", xyz=[0, 0.3, 0], **(body | {"mass": 0.4}))
    return builder.build().with_gravity([0, 0, 0])


@pytest.mark.parametrize(
    ("scheme", "coordinates", "keeps"),
    [("midpoint", "qp", True), ("verlet", "qp", True), ("midpoint", "qv", False), ("rk4", "qp", False)],
)
def test_symplectic_steps_keep_momentum_and_energy(satellite, random, scheme, coordinates, keeps):
    dynamics = costate.Dynamics(satellite, coordinates)
    step, n, nq = costate.Step(dynamics, scheme, 0.05), satellite.n, satellite.nq
    q, v = satellite.integrate(satellite.neutral(), random.normal(size=n)), random.normal(size=n)
    x = np.concatenate([q, v if coordinates == "qv" else dynamics.momentum(q, v)])

    momenta = costate.Dynamics(satellite, "qp")

    def known(x):
        """The momentum of the whole, linear and about the origin of the world, and the energy."""
        q, w = x[:nq].copy(), x[nq:].copy()
        p, v = (momenta.momentum(q, w), w) if coordinates == "qv" else (w, momenta.velocity(q, w))
        vector, real = q[3:6], q[6]
        linear, angular = (a + 2 * np.cross(vector, np.cross(vector, a) + real * a) for a in (p[:3], p[3:6]))
        return np.concatenate([linear, np.cross(q[:3], linear) + angular]), sum(momenta.energy(q, v))

    (momentum, energy), errors = known(x), []
    for _ in range(3000):
        x = step.f(x[:nq].copy(), x[nq:].copy(), np.zeros(n))
        now = known(x)
        errors.append((np.abs(now[0] - momentum).max() / np.abs(momentum).max(), abs(now[1] / energy - 1)))
    lost, off = np.array(errors).T
    assert (lost.max() < 1e-11) == keeps
    if keeps:
        assert off[-300:].max() < 3 * off[:300].max() < 0.3


def test_the_derivative_by_the_duration_is_the_rate(drone, random):
    dynamics = costate.Dynamics(drone)
    q, v, tau = drone.integrate(drone.neutral(), random.normal(size=6)), random.normal(size=6), random.normal(size=6)
    # At dt = 0 it is f, whatever the scheme.
    for scheme in ("rk4", "midpoint"):
        step = costate.Step(dynamics, scheme, 0.0)
        assert_close(step.dt_derivative(q, v, tau), dynamics.f(q, v, tau), 1e-12)
        assert_close(step.f(q, v, tau), np.concatenate([q, v]), 1e-15)

    def after(dt):
        return costate.Step(dynamics, "rk4", dt).f(q, v, tau)

    middle = after(0.1)

    def along(s):
        moved = after(0.1 + s)
        return np.concatenate([drone.difference(middle[:7], moved[:7]), moved[7:] - middle[7:]])

    expected, bound = slope(along, 1e-3, 16 * EPS * np.abs(middle).max())
    assert bound < 1e-8
    assert_within(costate.Step(dynamics, "rk4", 0.1).dt_derivative(q, v, tau), expected, bound)


def test_steps_are_compared_pickled_and_refused_by_name(drone):
    step = costate.Step(costate.Dynamics(drone), "rk4", DT)
    assert pickle.loads(pickle.dumps(step)) == step
    for scheme, why in (
        ("semi_implicit_euler", "quaternions have more; give 'rk4', 'midpoint' or, for \"qp\", 'verlet'"),
        ("verlet", 'the scheme \'verlet\' needs Dynamics.robot, "qp"'),
    ):
        with pytest.raises(costate.ArgumentError, match=why) as raised:
            costate.Step(costate.Dynamics(drone), scheme, DT)
        assert raised.value.argument == "scheme"
    with pytest.raises(costate.ArgumentError, match=r"not \(..., 7\).*quaternion"):
        step.f(np.zeros(6), np.zeros(6), np.zeros(6))
