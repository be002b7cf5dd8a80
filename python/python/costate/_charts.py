"""The tangent space of robots with floating and spherical joints, by arithmetic that JAX and PyTorch differentiate.

Functions of a configuration are computed at q_0 and differentiated by d in q_0 (+) d, at d = 0. As functions of the entries
of q they are those of d(q), which `tangent` has, with q_0 = q held: value and first two derivatives are exact. d does not
change with the length of a quaternion. `moved` is q_0 (+) d to second order, for next states.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    from ._costate import Robot

    _Vector: TypeAlias = list[Any]

# Puts arrays beside each other along a new last axis.
Stack: TypeAlias = Callable[[list[Any], int], Any]


def _cross(a: _Vector, b: _Vector) -> _Vector:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def _dot(a: _Vector, b: _Vector) -> Any:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _plus(a: _Vector, b: _Vector, factor: Any = 1.0) -> _Vector:
    return [of_a + factor * of_b for of_a, of_b in zip(a, b, strict=True)]


def _turned(vector: _Vector, scalar: Any, x: _Vector) -> _Vector:
    """R x of a unit quaternion."""
    once = _cross(vector, x)
    return _plus(_plus(x, once, 2.0 * scalar), _cross(vector, once), 2.0)


class Charts:
    """The entries of q and of d of a robot."""

    def __init__(self, robot: Robot) -> None:
        self.nq, self.n = robot.nq, robot.n
        # First entries of q and of d, and how many displacements come before the quaternion.
        self.free = [(at, i, 3 if kind == "floating" else 0) for _, kind, at, i in robot.free_joints]
        self.plain: list[tuple[int, int]] = []
        start, k = 0, 0
        for at, i, slides in [*self.free, (self.nq, self.n, 0)]:
            self.plain += [(start + j - k, j) for j in range(k, i)]
            start, k = at + slides + 4, i + slides + 3

    def tangent(self, base: Any, q: Any, stack: Stack) -> Any:
        """d (..., n) with q = base (+) d, for q = base but for derivatives: zero, with its exact first two derivatives.

        With conj(a_0) o a = (w, s) and e = R_0' (r - r_0): theta = 2 w / s, rho = e - theta x e / 2.
        """
        d: list[Any] = [None] * self.n
        for at, i in self.plain:
            d[i] = q[..., at] - base[..., at]
        for at, i, slides in self.free:
            here, there = ([of[..., at + k] for k in range(slides + 4)] for of in (base, q))
            vector, w = here[slides : slides + 3], there[slides : slides + 3]
            scalar, s = here[-1], there[-1]
            product = _plus(_plus([scalar * x for x in w], vector, -s), _cross(vector, w), -1.0)
            size = scalar * s + _dot(vector, w)
            theta = [2.0 * x / size for x in product]
            d[i + slides : i + slides + 3] = theta
            if slides:
                away = _turned([-x for x in vector], scalar, _plus(there[:3], here[:3], -1.0))
                d[i : i + 3] = _plus(away, _cross(theta, away), -0.5)
        return stack(d, -1)

    def moved(self, base: Any, d: Any, stack: Stack) -> Any:
        """base (+) d (..., nq) to second order.

        r_0 + R_0 (rho + theta x rho / 2), and a_0 o (theta / 2, 1 - |theta|^2 / 8).
        """
        q: list[Any] = [None] * self.nq
        for at, i in self.plain:
            q[at] = base[..., at] + d[..., i]
        for at, i, slides in self.free:
            here = [base[..., at + k] for k in range(slides + 4)]
            vector, scalar = here[slides : slides + 3], here[-1]
            theta = [d[..., i + slides + k] for k in range(3)]
            half, rest = [0.5 * x for x in theta], 1.0 - 0.125 * _dot(theta, theta)
            turned = _plus(_plus([scalar * x for x in half], vector, rest), _cross(vector, half))
            q[at + slides : at + slides + 4] = [*turned, scalar * rest - _dot(vector, half)]
            if slides:
                rho = [d[..., i + k] for k in range(3)]
                q[at : at + 3] = _plus(here[:3], _turned(vector, scalar, _plus(rho, _cross(theta, rho), 0.5)))
        return stack(q, -1)
