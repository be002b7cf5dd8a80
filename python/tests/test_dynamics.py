"""The dynamics: closed forms, identities between methods, finite differences, both coordinates."""

import costate
import numpy as np
import pytest
from conftest import assert_close, central_differences, load, pendulum

# The biped has branches; others are chains.
FILES = ["ur5.urdf", "puma560.toml", "panda.urdf", "biped.toml"]


@pytest.fixture(params=FILES)
def robot(request):
    return load(request.param)


@pytest.fixture(params=["qv", "qp"])
def dynamics(request, robot):
    return costate.Dynamics(robot, request.param)


def state(random, n):
    """q, v or p, tau, the costate y and a direction d of z."""
    return (*random.normal(size=(3, n)), random.normal(size=2 * n), random.normal(size=3 * n))


def test_a_pendulum_is_as_in_the_textbook():
    m, l, g = 2.0, 0.7, 9.81
    dynamics = costate.Dynamics(pendulum(m, l))
    q, v, tau = 0.3, -1.1, 0.4
    a = (tau - m * g * l * np.sin(q)) / (m * l * l)
    assert_close(dynamics.f([q], [v], [tau]), [v, a], 1e-14)
    jacobian = [[0, 1, 0], [-g / l * np.cos(q), 0, 1 / (m * l * l)]]
    assert_close(dynamics.jacobian([q], [v], [tau]), jacobian, 1e-14)
    hessian = np.zeros((3, 3))
    hessian[0, 0] = 5.0 * g / l * np.sin(q)
    assert_close(dynamics.hessian([q], [v], [tau], [3.0, 5.0]), hessian, 1e-13)
    assert_close(dynamics.crba([q]), [[m * l * l]], 1e-15)
    kinetic, potential = dynamics.energy([q], [v])
    assert_close(kinetic, 0.5 * m * l * l * v * v, 1e-15)
    at_rest = dynamics.energy([0.0], [0.0])[1]
    assert_close(potential - at_rest, m * g * l * (1 - np.cos(q)), 1e-13)
    assert_close(dynamics.momentum([q], [v]), [m * l * l * v], 1e-15)
    assert_close(costate.Dynamics(pendulum(m, l), "qp").f([q], [v], [tau])[1], tau - m * g * l * np.sin(q), 1e-14)


def test_products_are_those_with_the_matrices(dynamics, random):
    q, v, tau, y, d = state(random, dynamics.n)
    f, jacobian, hessian = dynamics.contract(q, v, tau, y)
    assert_close(dynamics.f(q, v, tau), f)
    assert_close(dynamics.jacobian(q, v, tau), jacobian)
    assert_close(dynamics.hessian(q, v, tau, y), hessian)
    assert_close(dynamics.linearise(q, v, tau)[0], f)
    assert_close(dynamics.linearise(q, v, tau)[1], jacobian)
    assert_close(dynamics.adjoint(q, v, tau, y), y @ jacobian)
    assert_close(dynamics.hvp(q, v, tau, y, d), hessian @ d, 1e-11)
    assert_close(hessian, hessian.T, 1e-11)


def test_derivatives_agree_with_finite_differences(dynamics, random):
    n = dynamics.n
    q, v, tau, y, _ = state(random, n)
    z = np.concatenate([q, v, tau])
    split = lambda z: (z[:n], z[n : 2 * n], z[2 * n :])
    assert_close(dynamics.jacobian(q, v, tau), central_differences(lambda z: dynamics.f(*split(z)), z), 1e-6)
    by_adjoint = central_differences(lambda z: dynamics.adjoint(*split(z), y), z)
    assert_close(dynamics.hessian(q, v, tau, y), by_adjoint, 1e-6)


def test_inverse_and_forward_dynamics_are_inverse(robot, random):
    dynamics = costate.Dynamics(robot)
    n = robot.n
    q, v, tau, _, _ = state(random, n)
    a = dynamics.aba(q, v, tau)
    assert_close(dynamics.rnea(q, v, a), tau, 1e-9)
    assert_close(dynamics.f(q, v, tau), np.concatenate([v, a]))
    mass = dynamics.crba(q)
    assert_close(mass, mass.T, 1e-15)
    assert np.linalg.eigvalsh(mass).min() > 0
    at_rest = dynamics.rnea(q, v, np.zeros(n))
    assert_close(dynamics.rnea(q, v, a) - at_rest, mass @ a, 1e-9)
    # M a_z = (0, 0, 1) - (tau_q, tau_v, 0)
    a_z, tau_z = dynamics.jacobian(q, v, tau)[n:], dynamics.rnea_jacobian(q, v, a)
    assert_close(tau_z[:, 2 * n :], mass, 1e-13)
    assert_close(mass @ a_z, np.hstack([-tau_z[:, : 2 * n], np.eye(n)]), 1e-9)


def test_the_hessian_of_inverse_dynamics(robot, random):
    dynamics = costate.Dynamics(robot)
    n = robot.n
    q, v, a, y, _ = state(random, n)
    w, z = y[:n], np.concatenate([q, v, a])
    product = lambda z: w @ dynamics.rnea_jacobian(z[:n], z[n : 2 * n], z[2 * n :])
    assert_close(dynamics.rnea_hessian(q, v, a, w), central_differences(product, z), 1e-6)


def test_both_coordinates_describe_the_same_motion(robot, random):
    velocities, momenta = costate.Dynamics(robot, "qv"), costate.Dynamics(robot, "qp")
    n = robot.n
    q, v, tau, _, _ = state(random, n)
    p = velocities.momentum(q, v)
    assert_close(p, velocities.crba(q) @ v)
    assert_close(velocities.velocity(q, p), v, 1e-9)
    rate = momenta.f(q, p, tau)
    assert_close(rate[:n], v, 1e-9)
    # dp/dt = M a + dM/dt v, the second term by finite differences along the motion
    along = central_differences(lambda t: velocities.crba(q + t[0] * v) @ v, np.zeros(1))[:, 0]
    a = velocities.aba(q, v, tau)
    assert_close(rate[n:], velocities.crba(q) @ a + along, 1e-6)


def test_energy_is_conserved_without_torques(robot, random):
    dynamics = costate.Dynamics(robot)
    n = robot.n
    q, v = random.normal(size=(2, n))
    f = dynamics.f(q, v, np.zeros(n))
    total = lambda t: np.sum(dynamics.energy(q + t[0] * f[:n], v + t[0] * f[n:]))
    power = central_differences(lambda t: np.array([total(t)]), np.zeros(1))[0, 0]
    # Of the size of the powers that cancel each other.
    size = np.abs(v) @ (np.abs(dynamics.crba(q)) @ np.abs(f[n:]) + np.abs(dynamics.rnea(q, v, np.zeros(n))))
    assert abs(power) < 1e-6 * size


def test_a_robot_with_mimic_joints_has_fewer_coordinates(random):
    builder = costate.Robot.builder("gripper", gravity=[0, 0, 0])
    builder.prismatic("left", axis=[0, 1, 0], mass=0.1)
    builder.prismatic("right", axis=[0, -1, 0], mass=0.3, mimic=("left", 2.0, 0.0))
    robot = builder.build()
    assert robot.n == 1 and robot.all_joint_names == ["left", "right"] and robot.joint_names == ["left"]
    assert_close(costate.Dynamics(robot).crba([0.2]), [[0.1 + 4 * 0.3]], 1e-15)


def test_backends_say_how_they_compute(ur5):
    assert costate.Dynamics(ur5).backend("f").startswith(("machine code: ", "generic code: "))
    with pytest.raises(costate.ArgumentError, match="rnea_jacobian"):
        costate.Dynamics(ur5).backend("rhea")


def test_a_long_chain_needs_no_machine_code(random):
    builder = costate.Robot.builder("chain")
    for k in range(40):
        on = f"joint{k - 1}" if k else None
        axis = random.normal(size=3).tolist()
        inertia = [0.01, 0.02, 0.025]
        builder.revolute(
            f"joint{k}", on=on, xyz=[0.1, 0, 0.02], axis=axis, mass=1, com=[0.05, 0, 0], inertia=inertia, armature=0.1
        )
    dynamics = costate.Dynamics(builder.build())
    assert dynamics.backend("hessian").startswith("generic code: ")
    n = dynamics.n
    q, v, tau, y = random.normal(size=(20, n)), random.normal(size=n), random.normal(size=n), random.normal(size=2 * n)
    many = dynamics.contract(q, v, tau, y)
    for found, expected in zip(many, dynamics.contract(q[13], v, tau, y)):
        assert_close(found[13], expected)
    f, jacobian, _ = many
    assert_close(dynamics.adjoint(q, v, tau, y)[3], y @ jacobian[3], 1e-11)
    assert_close(dynamics.rnea(q, v, f[:, n:])[7], tau, 1e-7)
