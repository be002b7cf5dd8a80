"""Robots with floating and spherical joints, and differences with bounds of their errors, for the tests of free joints."""

import costate
import numpy as np
import pytest
from conftest import ROBOTS, assert_close

EPS = float(np.finfo(float).eps)
FIXTURES = ROBOTS.parent / "tests" / "fixtures"
PAYLOAD = {"mass": 5.0, "com": [0.1, -0.05, 0.2], "inertia": [0.3, 0.4, 0.35, 0, 0, 0]}


def free(name: str) -> costate.Robot:
    """A robot of the fixtures: a URDF floats and carries a payload."""
    path = ROBOTS.parent / name
    if path.suffix == ".toml":
        return costate.Robot.from_file(path)
    return costate.Robot.from_file(path, floating_base=True).with_payload("root_joint", **PAYLOAD)


@pytest.fixture(scope="module")
def tree() -> costate.Robot:
    """Five joints, three of them free."""
    return free("tests/fixtures/free_tree.toml")


@pytest.fixture(scope="module")
def drone() -> costate.Robot:
    body = {"mass": 2.0, "com": [0.1, -0.2, 0.3], "inertia": [0.2, 0.3, 0.25, 0.01, -0.02, 0.03]}
    return costate.Robot.builder("drone").floating("body", **body).build()


@pytest.fixture
def state(tree, random):
    """q, v, tau, y (2n) and d (3n)."""
    n = tree.n
    q = tree.integrate(tree.neutral(), random.normal(size=n))
    return q, *(random.normal(size=k * n) for k in (1, 1, 2, 3))


@pytest.fixture
def batch(tree, random):
    """q, v, tau and y of several states, whose leading axes go together as (3, 5, 7)."""
    n = tree.n
    q = tree.integrate(tree.neutral(), random.normal(size=(3, 1, 7, n)))
    return q, random.normal(size=(5, 1, n)), random.normal(size=n), random.normal(size=2 * n)


def slope(function, h: float, noise: float):
    """The derivative at 0 by differences of order four, and a bound of its error.

    ``noise`` is the error of one value; the weights of the four add up to 1.5 / h. The error of truncation is
    proportional to h^4: a fifteenth of what twice the step changes, of which the bound takes a seventh.
    """

    def by(h):
        return (8 * (function(h) - function(-h)) - (function(2 * h) - function(-2 * h))) / (12 * h)

    found = by(h)
    return found, 1.5 * noise / h + np.abs(by(2 * h) - found).max() / 7


def curvature(function, h: float, noise: float):
    """The same of the second derivative; the weights add up to 64 / (12 h^2)."""

    def by(h):
        near, far = function(h) + function(-h), function(2 * h) + function(-2 * h)
        return (16 * near - far - 30 * function(0.0)) / (12 * h * h)

    found = by(h)
    return found, 64 / 12 * noise / h**2 + np.abs(by(2 * h) - found).max() / 7


def assert_within(found, expected, bound: float) -> None:
    assert np.abs(np.asarray(found) - expected).max() <= bound


def assert_verbs_agree(model, z, y, d, results, relative: float) -> None:
    """All verbs of dynamics or of a step at z = (q, v, tau) have the results of ``contract``.

    Products with y and d add rounding: ten times as much may differ. The Hessian is symmetric to a tenth.
    """
    f, jacobian, hessian = results
    assert_close(model.f(*z), f, relative)
    assert_close(model.jacobian(*z), jacobian, relative)
    assert_close(model.hessian(*z, y), hessian, relative)
    for found, expected in zip(model.linearise(*z), (f, jacobian), strict=True):
        assert_close(found, expected, relative)
    assert_close(model.adjoint(*z, y), y @ jacobian, 10 * relative)
    assert_close(model.hvp(*z, y, d), hessian @ d, 10 * relative)
    assert_close(hessian, hessian.T, relative / 10)


def assert_derivatives_along(function, y, d, jacobian, hessian, noise: float, sharp: float) -> None:
    """The Jacobian, and the Hessian contracted with y, along d of length 1, by differences of ``function`` on that line.

    ``noise`` is the error of its values. The bounds of the differences are 1e-6 of the Jacobian and ``sharp`` of the
    Hessian at most.
    """
    first, bound = slope(function, 1e-3, noise)
    assert bound < 1e-6 * np.abs(jacobian).max()
    assert_within(jacobian @ d, first, bound)
    second, bound = curvature(lambda s: y @ function(s), 2e-2, noise * np.abs(y).sum())
    assert bound < sharp * np.abs(hessian).max()
    assert_within(d @ hessian @ d, second, bound)


def assert_batch_is_single_states(model, q, v, tau, y, rows: int) -> None:
    """Results of dynamics or of a step for a ``batch`` are those of its states alone; f has this many rows."""
    n = tau.size
    f, jacobian, hessian = model.contract(q, v, tau, y)
    assert (f.shape, jacobian.shape, hessian.shape) == ((3, 5, 7, rows), (3, 5, 7, 2 * n, 3 * n), (3, 5, 7, 3 * n, 3 * n))
    room = np.empty_like(f)
    assert model.f(q, v, tau, out=room) is room
    for k in ((0, 0, 0), (2, 4, 6), (1, 3, 2)):
        alone = q[k[0], 0, k[2]], v[k[1], 0], tau
        assert_close(room[k], model.f(*alone), 1e-10)
        for found, expected in zip((f, jacobian, hessian), model.contract(*alone, y), strict=True):
            assert_close(found[k], expected, 1e-9)


def solving(dynamics, q) -> float:
    """The relative error of solutions of equations with the mass matrix M at q: n times its condition in units of rounding.

    Scales of the coordinates change nothing in the factorisation L'DL: the condition is that of M scaled to a unit
    diagonal.
    """
    mass = dynamics.crba(q)
    scale = np.sqrt(np.diag(mass))
    return float(len(mass) * EPS * np.linalg.cond(mass / np.outer(scale, scale)))


def rotation(quaternion) -> np.ndarray:
    """The matrix of a unit quaternion (x, y, z, w)."""
    (x, y, z), w = quaternion[:3], quaternion[3]
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * cross + 2 * cross @ cross
