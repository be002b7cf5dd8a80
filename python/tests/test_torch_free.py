"""Functions of PyTorch of robots with floating and spherical joints: derivatives by the entries of q."""

import pickle

import costate
import numpy as np
import pytest
from conftest import assert_close
from free_joints import EPS, assert_within, drone, slope, solving, state, tree  # noqa: F401

torch = pytest.importorskip("torch")
import costate.torch

pytestmark = pytest.mark.filterwarnings("ignore::costate.RobotWarning")


def of(robot, function):
    return lambda z: function(*z.split([robot.nq, robot.n, robot.n], -1))


def normalised(robot, z):
    """z with the quaternions of q divided by their lengths, by differentiable arithmetic."""
    parts, last = [], 0
    for _, kind, at, _ in robot.free_joints:
        at += 3 if kind == "floating" else 0
        parts += [z[last:at], z[at : at + 4] / z[at : at + 4].norm()]
        last = at + 4
    return torch.cat([*parts, z[last:]])


@pytest.mark.parametrize("name", ["f", "aba", "rnea", "step"])
@pytest.mark.parametrize("coordinates", ["qv", "qp"])
def test_both_modes_and_both_orders(tree, state, random, name, coordinates):
    q, v, tau, *_ = state
    dynamics = costate.Dynamics(tree, coordinates)
    model = costate.torch.Model(dynamics)
    given = {"f": model.f, "aba": model.aba, "rnea": model.rnea, "step": model.step("rk4", 0.01)}[name]
    function = of(tree, given)
    z, direction = torch.tensor(np.concatenate([q, v, tau])), random.normal(size=tree.nq + 2 * tree.n)
    direction = torch.tensor(direction / np.linalg.norm(direction))
    whole = lambda z: function(normalised(tree, z))
    jacobian = torch.func.jacrev(function)(z)
    assert_close(torch.func.jacfwd(function)(z), jacobian, 1e-12)
    noise = solving(dynamics, q) * float(function(z).abs().max())
    expected, bound = slope(lambda s: whole(z + s * direction).numpy(), 1e-3, noise)
    assert bound < 1e-5 * float(jacobian.abs().max())
    assert_within((jacobian @ direction).numpy(), expected, bound)
    y = torch.tensor(random.normal(size=len(jacobian)))
    cost = lambda z: y @ whole(z)
    exact = torch.func.hessian(cost)(z)
    assert_close(exact, exact.T, 1e-10)
    for way in (torch.func.jacrev(torch.func.jacrev(cost)), torch.func.jacrev(torch.func.jacfwd(cost))):
        assert_close(way(z), exact, 1e-10)
    gradient = torch.func.grad(cost)
    expected, bound = slope(lambda s: gradient(z + s * direction).numpy(), 1e-3, noise * float(y.abs().sum()))
    assert bound < 1e-4 * float(exact.abs().max())
    assert_within((exact @ direction).numpy(), expected, bound)


def test_batches_and_pickles(drone, random):
    dynamics = costate.Dynamics(drone)
    model = costate.torch.Model(dynamics)
    q, v = drone.integrate(drone.neutral(), random.normal(size=(4, 6))), random.normal(size=(4, 6))
    tau = torch.tensor(random.normal(size=6))
    q, v = torch.tensor(q), torch.tensor(v)
    assert_close(model.f(q, v, tau), dynamics.f(q.numpy(), v.numpy(), tau.numpy()), 1e-15)
    mapped = torch.func.vmap(torch.func.jacfwd(lambda q, v: model.aba(q, v, tau)))(q, v)
    alone = torch.func.jacrev(lambda q: model.aba(q, v[2], tau))(q[2])
    assert mapped.shape == (4, 6, 7)
    assert_close(mapped[2], alone, 1e-12)
    step = pickle.loads(pickle.dumps(model.step("rk4", 0.05)))
    assert step(q, v, tau).shape == (4, 13)
    with pytest.raises(costate.ArgumentError, match=r"q has the shape \[6\], not \(..., 7\)"):
        model.f(v[0], v[0], tau)
