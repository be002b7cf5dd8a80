"""Floating and spherical joints: numbers of Pinocchio, laws of motion, derivatives, frames."""

import json
from pathlib import Path

import costate
import numpy as np
import pytest
from conftest import assert_close
from free_joints import (  # noqa: F401
    EPS,
    FIXTURES,
    assert_derivatives_along,
    assert_verbs_agree,
    assert_within,
    drone,
    free,
    rotation,
    slope,
    solving,
    state,
    tree,
)

# Bases without mass, which move.
pytestmark = pytest.mark.filterwarnings("ignore::costate.RobotWarning")
CASES = [json.loads(line) for line in (FIXTURES / "free_joints_pinocchio.jsonl").read_text().splitlines()]


def places(robot: costate.Robot, names: list[str]) -> tuple[list[int], list[int]]:
    """For each entry of q and of v the entry of Pinocchio, whose joints have these names."""
    sizes = {name: (7, 6) if kind == "floating" else (4, 3) for name, kind, *_ in robot.free_joints}
    starts, at = {}, (0, 0)
    for name in names:
        starts[name] = at
        nq, nv = sizes.get(name, (1, 1))
        at = at[0] + nq, at[1] + nv
    parts = {f"{name}_{part}" for name in sizes for part in ("x", "y", "z", "rx", "ry")}
    to_q, to_v = [], []
    for name in (name for name in robot.joint_names if name not in parts):
        (from_q, from_v), (nq, nv) = starts[name], sizes.get(name, (1, 1))
        to_q += range(from_q, from_q + nq)
        to_v += range(from_v, from_v + nv)
    return to_q, to_v


@pytest.mark.parametrize("case", CASES, ids=[Path(case["robot"]).stem for case in CASES])
def test_dynamics_and_their_jacobian_are_those_of_pinocchio(case):
    robot = free(case["robot"])
    to_q, to_v = places(robot, case["names"])
    n = robot.nv
    assert (robot.nq, n) == (len(case["q"]), len(case["v"])) == (len(to_q), len(to_v))
    q = np.array(case["q"])[to_q]
    v, tau, a = (np.array(case[key])[to_v] for key in ("v", "tau", "a"))
    mass, a_q, a_v, a_tau = (np.array(case[key])[np.ix_(to_v, to_v)] for key in ("M", "a_q", "a_v", "a_tau"))
    dynamics = costate.Dynamics(robot)
    solved = solving(dynamics, q)
    assert_close(dynamics.crba(q), mass, 1e-12)
    assert_close(dynamics.aba(q, v, tau), a, 1e-10)
    assert_close(dynamics.f(q, v, tau), np.concatenate([v, a]), 1e-10)
    # M a, which may be much larger than tau, has 1e-10 of the largest entry too.
    assert_within(dynamics.rnea(q, v, a), tau, 1e-10 * np.abs(mass).max() * np.abs(a).max())
    jacobian = dynamics.jacobian(q, v, tau)
    for k, expected in enumerate((a_q, a_v, a_tau)):
        assert_close(jacobian[n:, k * n : (k + 1) * n], expected, max(1e-10, solved))
    assert_close(jacobian[:n], np.eye(n, 3 * n, n), 0)
    kinetic, _ = dynamics.energy(q, v)
    assert kinetic == pytest.approx(v @ mass @ v / 2, rel=1e-12)
    assert_close(dynamics.momentum(q, v), mass @ v, 1e-12)
    assert_close(dynamics.velocity(q, mass @ v), v, solved)
    # tau_z of inverse dynamics is -M a_z, and M by a.
    torques = dynamics.rnea_jacobian(q, v, a)
    for k, by in enumerate((-a_q, -a_v, np.eye(n))):
        size = np.abs(mass).max() * np.abs(by).max()
        assert_within(torques[:, k * n : (k + 1) * n], mass @ by, 1e-10 * size)


def test_the_momenta_of_a_motion_are_those_of_its_velocities(tree, state):
    """In (q, p): v = M^-1 p, and dp/dt is the rate of M v along the motion of Newton's equations, by differences."""
    q, v, tau, *_ = state
    n, velocities, momenta = tree.n, costate.Dynamics(tree), costate.Dynamics(tree, "qp")
    p, a = velocities.momentum(q, v), velocities.aba(q, v, tau)
    f, solved = momenta.f(q, p, tau), solving(velocities, q)
    assert_close(f[:n], v, solved)

    def momentum(s):
        return velocities.momentum(tree.integrate(q, s * v), v + s * a)

    rate, bound = slope(momentum, 1e-4, n * EPS * np.abs(p).max())
    # M a is as far from exact as the solution a.
    force = np.abs(velocities.crba(q) @ a).max()
    assert bound < 1e-7 * force
    assert_within(f[n:], rate, bound + solved * force)
    kinetic, potential = momenta.energy(q, v)
    assert kinetic == pytest.approx(v @ p / 2, rel=1e-12) and potential == velocities.energy(q, v)[1]


@pytest.mark.parametrize("coordinates", ["qv", "qp"])
def test_derivatives_are_those_along_q_plus_d(tree, state, coordinates):
    """A check by finite differences; the library compares with hyper-dual numbers."""
    q, v, tau, y, d = state
    n, dynamics = tree.n, costate.Dynamics(tree, coordinates)
    f, jacobian, hessian = dynamics.contract(q, v, tau, y)
    assert_verbs_agree(dynamics, (q, v, tau), y, d, (f, jacobian, hessian), 1e-12)

    # Along a direction of length 1.
    d = d / np.linalg.norm(d)

    def along(s):
        return dynamics.f(tree.integrate(q, s * d[:n]), v + s * d[n : 2 * n], tau + s * d[2 * n :])

    noise = solving(dynamics, q) * np.abs(f).max()
    assert_derivatives_along(along, y, d, jacobian, hessian, noise, 1e-5)


def test_second_derivatives_of_inverse_dynamics(tree, state):
    """M a_zz + tau_zz(.., a_z, a_z) = 0, contracted: by the Hessian of forward dynamics at w = M^-1 y."""
    q, v, tau, y, d = state
    n, dynamics = tree.n, costate.Dynamics(tree)
    w = y[:n]
    mass = dynamics.crba(q)
    f, jacobian, hessian = dynamics.contract(q, v, tau, np.concatenate([np.zeros(n), mass @ w]))
    to_z = np.vstack([np.eye(2 * n, 3 * n), jacobian[n:]])
    pulled = to_z.T @ dynamics.rnea_hessian(q, v, f[n:], w) @ to_z
    assert_close(pulled, -hessian, 1e-9)


def test_a_free_robot_keeps_its_angular_momentum_and_falls(tree, random):
    """dh/dt = (0, m g) of all links, whatever the joints do, along the motion by differences."""
    n, dynamics = tree.n, costate.Dynamics(tree)
    q, v = tree.integrate(tree.neutral(), random.normal(size=n)), random.normal(size=n)
    tau = np.concatenate([np.zeros(6), random.normal(size=n - 6)])
    a = dynamics.aba(q, v, tau)
    total, matrix = dynamics.centroidal_momentum(q, v)

    def momentum(s):
        return dynamics.centroidal_momentum(tree.integrate(q, s * v), v + s * a)[0]

    rate, bound = slope(momentum, 1e-4, n * EPS * np.abs(matrix).max() * np.abs(v).max())
    expected = np.concatenate([np.zeros(3), tree.mass * tree.gravity])
    force = np.abs(matrix @ a).max()
    assert bound < 1e-7 * force
    assert_within(rate, expected, bound + solving(dynamics, q) * force)
    assert_close(matrix @ v, total, 1e-12)


def test_frames_of_a_body(drone, random):
    """A point and the axes of one body, in closed form."""
    robot = drone.add_frame("tip", "body", [0.5, 0.2, -0.1])
    dynamics = costate.Dynamics(robot)
    q = robot.integrate(robot.neutral(), random.normal(size=6))
    v, a, arm = random.normal(size=6), random.normal(size=6), np.array([0.5, 0.2, -0.1])
    turn, (linear, angular) = rotation(q[3:]), v.reshape(2, 3)
    tip = dynamics.frame("tip")
    orientation, position = tip.pose(q)
    assert_close(orientation, turn, 1e-14)
    assert_close(position, q[:3] + turn @ arm, 1e-14)
    velocity = turn @ (linear + np.cross(angular, arm))
    assert_close(tip.twist(q, v), np.concatenate([turn @ angular, velocity]), 1e-14)
    assert_close(tip.jacobian(q) @ v, tip.twist(q, v), 1e-14)
    assert_close(dynamics.frame("tip", "local").twist(q, v)[:3], angular, 1e-14)
    # x = r + R s: x'' = R (v' + w x v + w' x s + w x (w x s)).
    (rise, spin), carried = a.reshape(2, 3), np.cross(angular, arm)
    acceleration = turn @ (rise + np.cross(angular, linear) + np.cross(spin, arm) + np.cross(angular, carried))
    assert_close(tip.acceleration(q, v, a)[3:], acceleration, 1e-13)
    assert_close(tip.jacobian(q) @ a + tip.jacobian_rate(q, v) @ v, tip.acceleration(q, v, a), 1e-13)
    assert_close(dynamics.centre_of_mass(q), q[:3] + turn @ [0.1, -0.2, 0.3], 1e-14)
    # w.x at q (+) d is w.(R (d_l + d_w x s + (d_w x d_l + d_w x (d_w x s)) / 2)) to second order.
    d, w = random.normal(size=6), random.normal(size=3)
    (along, about) = d.reshape(2, 3)
    bend = turn @ (np.cross(about, along) + np.cross(about, np.cross(about, arm)))
    assert d @ tip.position_hessian(q, w) @ d == pytest.approx(w @ bend, rel=1e-12)


def test_a_body_held_at_a_point_is_a_spherical_pendulum(random):
    """A floating body whose point is pinned to the world moves as one on a spherical joint there."""
    body = {"mass": 2.0, "com": [0.1, -0.2, 0.3], "inertia": [0.2, 0.3, 0.25, 0.01, -0.02, 0.03]}
    held = costate.Robot.builder("held").floating("body", **body).build().with_constraint("pin", "body", kind="pinned")
    ball = costate.Robot.builder("ball").spherical("body", **body).build()
    constrained, pendulum = costate.ConstrainedDynamics(held), costate.Dynamics(ball, "qp")
    turn = ball.integrate(ball.neutral(), random.normal(size=3))
    v, y = random.normal(size=3), random.normal(size=6)
    q = np.concatenate([np.zeros(3), turn])
    p = constrained.momentum(q, np.concatenate([np.zeros(3), v]))
    f, jacobian, _ = constrained.contract(q, p, np.zeros(6), np.concatenate([np.zeros(9), y[:3]]))
    expected = pendulum.f(turn, costate.Dynamics(ball).momentum(turn, v), np.zeros(3))
    assert_close(f[3:6], v, 1e-12)
    assert_close(f[9:], expected[3:], 1e-11)
    a = costate.Dynamics(ball).aba(turn, v, np.zeros(3))
    assert_close(constrained.acceleration(q, p, np.zeros(6))[3:], a, 1e-11)
    assert jacobian.shape == (12, 18)
    assert_close(constrained.velocity(q, p)[0][3:], v, 1e-12)
    # Away from its pin it is moved there, turned or not, unless all of it is held.
    away = np.concatenate([[0.1, -0.2, 0.3], turn])
    assert np.abs(constrained.constraint(constrained.close(away))).max() < 1e-12
    with pytest.raises(costate.ConstraintError):
        constrained.close(away, held=["body"])


def test_forces_and_landings_of_a_body_have_derivatives(random):
    """A check by finite differences along q (+) d; the library compares with hyper-dual numbers."""
    body = {"mass": 2.0, "com": [0.1, -0.2, 0.3], "inertia": [0.2, 0.3, 0.25, 0.01, -0.02, 0.03]}
    robot = costate.Robot.builder("stander").floating("body", **body).build()
    robot = robot.with_constraint("foot", "body", rows=["x", "y", "z", "turn_x"])
    dynamics, n = costate.ConstrainedDynamics(robot), robot.n
    q = robot.integrate(robot.neutral(), 0.4 * random.normal(size=n))
    v, tau, y, c, d = (random.normal(size=size) for size in (n, n, n, 4, 3 * n))
    p, d = dynamics.momentum(q, v), d / np.linalg.norm(d)

    def forces(s):
        moved = robot.integrate(q, s * d[:n]), p + s * d[n : 2 * n], tau + s * d[2 * n :]
        return dynamics.multipliers(*moved)

    derivatives = dynamics.multiplier_jacobian(q, p, tau), dynamics.multiplier_hessian(q, p, tau, c)
    noise = 1e-13 * np.abs(forces(0.0)).max()
    assert_derivatives_along(forces, c, d, *derivatives, noise, 1e-5)

    e = d[: 2 * n] / np.linalg.norm(d[: 2 * n])
    _, jacobian, _ = dynamics.impact_jacobian(q, p)
    hessian = dynamics.impact_hessian(q, p, y)
    landed = lambda s: dynamics.impact(robot.integrate(q, s * e[:n]), p + s * e[n:])
    noise = 1e-13 * np.abs(p).max()
    assert_derivatives_along(lambda s: landed(s)[1], y, e, jacobian, hessian, noise, 1e-5)
    assert (hessian == hessian.T).all()
    # v+ is in the axes of the body: J v+ = 0, and p+ = M v+.
    v_plus, p_plus, impulse, _ = dynamics.impact(q, p)
    assert np.abs(dynamics.constraint_rate(q, v_plus)).max() < 1e-12
    assert_close(dynamics.momentum(q, v_plus), p_plus, 1e-12)
    assert_close(p_plus - p, dynamics.constraint_jacobian(q).T @ impulse, 1e-11)
