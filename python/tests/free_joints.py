"""Robots with floating and spherical joints, and differences with bounds of their errors, for the tests of free joints."""

import costate
import numpy as np
import pytest
from conftest import ROBOTS

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
