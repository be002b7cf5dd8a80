"""Functions of JAX of robots with floating and spherical joints: derivatives by the entries of q."""

import pickle

import costate
import numpy as np
import pytest
from conftest import assert_close
from free_joints import EPS, assert_within, drone, slope, solving, state, tree  # noqa: F401

jax = pytest.importorskip("jax")
import costate.jax
import jax.numpy as jnp

jax.config.update("jax_enable_x64", True)
pytestmark = pytest.mark.filterwarnings("ignore::costate.RobotWarning")


def functions(dynamics, order="any"):
    model = costate.jax.Model(dynamics, order)
    return {"f": model.f, "aba": model.aba, "rnea": model.rnea, "step": model.step("rk4", 0.01)}


def of(robot, function):
    return lambda z: function(z[: robot.nq], z[robot.nq : robot.nq + robot.n], z[robot.nq + robot.n :])


def normalised(robot, z):
    """z with the quaternions of q divided by their lengths, by differentiable arithmetic."""
    for _, kind, at, _ in robot.free_joints:
        at += 3 if kind == "floating" else 0
        z = z.at[at : at + 4].set(z[at : at + 4] / jnp.linalg.norm(z[at : at + 4]))
    return z


@pytest.mark.parametrize("name", ["f", "aba", "rnea", "step"])
@pytest.mark.parametrize("coordinates", ["qv", "qp"])
def test_both_modes_and_both_orders(tree, state, random, name, coordinates):
    """Against differences along directions of the entries of q, quaternions normalised, and against each other."""
    q, v, tau, *_ = state
    dynamics = costate.Dynamics(tree, coordinates)
    z, direction = np.concatenate([q, v, tau]), random.normal(size=tree.nq + 2 * tree.n)
    direction /= np.linalg.norm(direction)
    function = of(tree, functions(dynamics)[name])

    def along(s):
        return np.asarray(function(normalised(tree, jnp.asarray(z + s * direction))))

    forward, reverse = jax.jacfwd(function)(z), jax.jit(jax.jacrev(function))(z)
    assert_close(reverse, forward, 1e-12)
    values = np.abs(function(z)).max()
    noise = solving(dynamics, q) * values
    expected, bound = slope(along, 1e-3, noise)
    assert bound < 1e-5 * np.abs(forward).max()
    assert_within(forward @ direction, expected, bound)
    # No change with the length of a quaternion.
    radial = np.zeros_like(z)
    radial[7:11] = q[7:11]
    assert np.abs(forward @ radial).max() <= 64 * EPS * np.abs(forward).max()

    y = random.normal(size=len(forward))
    cost = lambda z: y @ function(z)
    once = of(tree, functions(dynamics, "reverse")[name])
    exact = jax.jit(jax.hessian(cost))(z)
    assert_close(exact, exact.T, 1e-10)
    ways = [jax.jacfwd(jax.grad(cost)), jax.jacrev(jax.jacfwd(cost)), jax.jacfwd(jax.grad(lambda z: y @ once(z)))]
    for hessian in ways:
        assert_close(jax.jit(hessian)(z), exact, 1e-10)
    gradient = jax.jit(jax.grad(lambda z: cost(normalised(tree, z))))
    expected, bound = slope(lambda s: np.asarray(gradient(jnp.asarray(z + s * direction))), 1e-3, noise * np.abs(y).sum())
    whole = jax.jit(jax.hessian(lambda z: cost(normalised(tree, z))))(z)
    assert bound < 1e-4 * np.abs(whole).max()
    assert_within(whole @ direction, expected, bound)


def test_gradients_in_the_tangent_space_are_those_of_dynamics(drone, random):
    """By d in q (+) d, with `Robot.integrate` to first order; and batches, vmap and steps in a loop."""
    dynamics = costate.Dynamics(drone)
    model = costate.jax.Model(dynamics)
    q, v, tau = drone.integrate(drone.neutral(), random.normal(size=(4, 6))), random.normal(size=(4, 6)), random.normal(size=6)
    assert_close(model.f(q, v, tau), dynamics.f(q, v, tau), 1e-15)
    by_q = jax.vmap(jax.jacfwd(lambda q, v: model.aba(q, v, tau)))(q, v)
    assert by_q.shape == (4, 6, 7)
    h = 1e-6
    unit = np.eye(6)
    moved = np.stack([(drone.integrate(q, h * e) - drone.integrate(q, -h * e)) / (2 * h) for e in unit], -1)
    assert_close(by_q @ moved, dynamics.jacobian(q, v, tau)[:, 6:, :6], 1e-8)

    step = model.step("rk4", 0.05)
    assert pickle.loads(pickle.dumps(step))(q[0], v[0], tau).shape == (13,)

    def end(tau):
        """The place after ten steps, in a loop that is compiled."""
        x, _ = jax.lax.scan(lambda x, _: (step(x[:7], x[7:], tau), None), jnp.concatenate([q[0], v[0]]), None, length=10)
        return x

    tau = jnp.asarray(tau)
    slopes = jax.jit(jax.jacfwd(end))(tau)
    for k in range(6):
        expected, bound = slope(lambda s, k=k: np.asarray(end(tau.at[k].add(s))), 1e-3, 256 * EPS * float(np.abs(end(tau)).max()))
        assert_within(slopes[:, k], expected, bound)
    with pytest.raises(costate.ArgumentError, match=r"q has the shape \[6\], not \(..., 7\)"):
        model.f(v[0], v[0], tau)
