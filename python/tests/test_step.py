"""Time steps: their order, their invariants, their derivatives."""

import pickle

import costate
import numpy as np
import pytest
from conftest import assert_close, central_differences, pendulum

SCHEMES = [
    ("qv", "rk4", 4),
    ("qp", "rk4", 4),
    ("qv", "midpoint", 2),
    ("qp", "midpoint", 2),
    ("qp", "verlet", 2),
    ("qv", "semi_implicit_euler", 1),
]


@pytest.fixture(params=SCHEMES, ids=lambda of: f"{of[0]}-{of[1]}")
def scheme(request):
    return request.param


def test_steps_have_the_order_of_their_scheme(scheme):
    coordinates, name, order = scheme
    dynamics = costate.Dynamics(pendulum(), coordinates)
    q, v, tau = np.array([0.7]), np.array([0.4]), np.array([0.2])

    def after(steps):
        step, x = costate.Step(dynamics, name, 0.4 / steps), np.concatenate([q, v])
        for _ in range(steps):
            x = step.f(x[:1], x[1:], tau)
        return x

    exact = costate.Step(dynamics, "rk4", 0.4 / 4096)
    x = np.concatenate([q, v])
    for _ in range(4096):
        x = exact.f(x[:1], x[1:], tau)
    coarse, fine = (np.abs(after(steps) - x).max() for steps in (8, 16))
    assert 2 ** (order - 0.4) < coarse / fine < 2 ** (order + 0.6)


def test_derivatives_of_a_step(scheme, puma, random):
    coordinates, name, _ = scheme
    step = costate.Step(costate.Dynamics(puma, coordinates), name, 5e-3)
    q, v, tau = random.normal(size=(3, 6)) * 0.5
    y, d = random.normal(size=12), random.normal(size=18)
    after, jacobian, hessian = step.contract(q, v, tau, y)
    z, split = np.concatenate([q, v, tau]), lambda z: (z[:6], z[6:12], z[12:])
    assert_close(step.f(q, v, tau), after)
    assert_close(jacobian, central_differences(lambda z: step.f(*split(z)), z), 1e-7)
    assert_close(hessian, central_differences(lambda z: step.adjoint(*split(z), y), z), 1e-5)
    assert_close(step.adjoint(q, v, tau, y), y @ jacobian)
    assert_close(step.hvp(q, v, tau, y, d), hessian @ d, 1e-11)
    assert_close(step.jacobian(q, v, tau), jacobian)
    assert_close(step.linearise(q, v, tau)[1], jacobian)
    assert_close(step.hessian(q, v, tau, y), hessian)
    of = lambda dt: costate.Step(step.dynamics, name, 5e-3 + dt[0]).f(q, v, tau)
    assert_close(step.dt_derivative(q, v, tau), central_differences(of, np.zeros(1))[:, 0], 1e-7)


def test_verlet_keeps_the_energy_of_a_pendulum():
    dynamics = costate.Dynamics(pendulum(), "qp")
    step, x, energies = costate.Step(dynamics, "verlet", 0.02), np.array([1.0, 0.0]), []
    for _ in range(5000):
        x = step.f(x[:1], x[1:], [0.0])
        energies.append(sum(dynamics.energy(x[:1], dynamics.velocity(x[:1], x[1:]))))
    assert np.ptp(energies) < 2e-3 * abs(energies[0])
    assert abs(np.mean(energies[:500]) - np.mean(energies[-500:])) < 1e-4 * abs(energies[0])


def test_batches_of_steps(ur5, random):
    step = costate.Step(costate.Dynamics(ur5), "rk4", 1e-3)
    q, v, tau = random.normal(size=(3, 40, 6))
    many = step.linearise(q, v, tau)
    one = step.linearise(q[17], v[17], tau[17])
    for found, expected in zip(many, one):
        assert_close(found[17], expected, 1e-15)


def test_steps_that_cannot_be(ur5):
    velocities, momenta = costate.Dynamics(ur5), costate.Dynamics(ur5, "qp")
    for dynamics, name, dt, words in [
        (velocities, "verlet", 0.01, 'needs Dynamics.robot, "qp"'),
        (momenta, "semi_implicit_euler", 0.01, 'needs Dynamics.robot, "qv"'),
        (velocities, "rk5", 0.01, "'rk4', 'midpoint'"),
        (velocities, "rk4", float("nan"), "finite"),
    ]:
        with pytest.raises(costate.ArgumentError, match=words):
            costate.Step(dynamics, name, dt)
    with pytest.raises(costate.StepNotSolved, match="shorter step"):
        costate.Step(velocities, "midpoint", 1e3).f(np.ones(6), np.ones(6), np.ones(6))


def test_steps_are_pickled_and_compared(ur5):
    step = costate.Step(costate.Dynamics(ur5, "qp"), "verlet", 0.01)
    again = pickle.loads(pickle.dumps(step))
    assert again == step and hash(again) == hash(step)
    assert again != costate.Step(step.dynamics, "verlet", 0.02)
    assert again.scheme == "verlet" and again.dt == 0.01 and again.dynamics == step.dynamics
