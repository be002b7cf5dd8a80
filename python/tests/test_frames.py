"""Frames, the centre of mass and momenta."""

import costate
import numpy as np
import pytest
from conftest import assert_close, central_differences


@pytest.fixture
def moving(ur5, random):
    """The UR5, a state, and the name of a frame."""
    q, v, a = random.normal(size=(3, 6))
    return costate.Dynamics(ur5), "tool0", q, v, a


def test_the_jacobian_is_the_derivative_of_the_pose(moving):
    dynamics, name, q, v, _ = moving
    frame = dynamics.frame(name)
    rotation, position = frame.pose(q)
    assert_close(rotation @ rotation.T, np.eye(3), 1e-15)
    jacobian = frame.jacobian(q)
    assert_close(jacobian[3:], central_differences(lambda q: frame.pose(q)[1], q), 1e-8)
    turning = central_differences(lambda q: frame.pose(q)[0] @ rotation.T, q)
    assert_close(jacobian[:3], np.stack([turning[2, 1], turning[0, 2], turning[1, 0]]), 1e-8)
    assert_close(frame.twist(q, v), jacobian @ v, 1e-14)


def test_the_three_conventions_belong_together(moving):
    dynamics, name, q, v, _ = moving
    aligned, local, world = (dynamics.frame(name, axes) for axes in ("local_world_aligned", "local", "world"))
    rotation, x = aligned.pose(q)
    angular, linear = aligned.twist(q, v)[:3], aligned.twist(q, v)[3:]
    assert_close(local.twist(q, v), np.concatenate([rotation.T @ angular, rotation.T @ linear]), 1e-14)
    assert_close(world.twist(q, v), np.concatenate([angular, linear - np.cross(angular, x)]), 1e-14)


def test_rates_and_second_derivatives(moving):
    dynamics, name, q, v, a = moving
    for axes in ("local_world_aligned", "local", "world"):
        frame = dynamics.frame(name, axes)
        along = central_differences(lambda t: frame.jacobian(q + t[0] * v).ravel(), np.zeros(1))
        assert_close(frame.jacobian_rate(q, v), along.reshape(6, 6), 1e-7)
        expected = frame.jacobian(q) @ a + frame.jacobian_rate(q, v) @ v
        assert_close(frame.acceleration(q, v, a), expected, 1e-13)
    frame, w = dynamics.frame(name), np.array([0.3, -0.8, 0.5])
    assert_close(frame.position_hessian(q, w), central_differences(lambda q: w @ frame.jacobian(q)[3:], q), 1e-7)


def test_momentum_of_the_whole_robot(ur5, random):
    dynamics = costate.Dynamics(ur5)
    q, v = random.normal(size=(2, 6))
    momentum, matrix = dynamics.centroidal_momentum(q, v)
    assert_close(matrix @ v, momentum, 1e-13)
    velocity = central_differences(lambda t: dynamics.centre_of_mass(q + t[0] * v), np.zeros(1))[:, 0]
    assert_close(momentum[3:], ur5.mass * velocity, 1e-8)


def test_frames_take_batches(moving):
    dynamics, name, q, v, _ = moving
    frame = dynamics.frame(name)
    many = np.stack([q, q + 0.1, q - 0.2])
    rotation, position = frame.pose(many)
    assert rotation.shape == (3, 3, 3) and position.shape == (3, 3)
    assert_close(position[2], frame.pose(q - 0.2)[1], 1e-15)
    assert frame.jacobian(many[:, None]).shape == (3, 1, 6, 6)


def test_added_frames_and_wrong_names(ur5):
    tip = ur5.add_frame("tip", "tool0", [0, 0, 0.12])
    dynamics = costate.Dynamics(tip)
    assert dynamics.frame("tip").dynamics is dynamics and dynamics.frame("tip") == costate.Frame(dynamics, "tip")
    rotation, tool = dynamics.frame("tool0").pose(np.zeros(6))
    assert_close(dynamics.frame("tip").pose(np.zeros(6))[1], tool + 0.12 * rotation[:, 2], 1e-15)
    with pytest.raises(costate.RobotError, match="'tool0'") as raised:
        dynamics.frame("tol0")
    assert raised.value.culprit == "tol0"
    with pytest.raises(costate.ArgumentError, match="'local', 'world', 'local_world_aligned'"):
        dynamics.frame("tip", "body")
