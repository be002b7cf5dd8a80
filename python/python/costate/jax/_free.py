"""Functions of robots with floating and spherical joints: their derivatives in the tangent space, by the entries of q."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import jax
import jax.numpy as jnp

from .._charts import Charts
from ._rules import differentiable

if TYPE_CHECKING:
    from .._costate import Robot
    from ._rules import _Order


def of_tangent(robot: Robot, of: tuple[Any, Any, Any], m: int, order: _Order) -> Any:
    """A function of (q, v, tau), of its value, Jacobian and Hessian by (d, v, tau), d in q (+) d."""
    charts = Charts(robot)
    value, jacobian, hessian = of
    # Each is evaluated at the base, where d is zero.
    at_base = _without_d(value), _without_d(jacobian), _without_d(hessian)
    function = differentiable(at_base, robot.n, m, order, base=True)

    def call(q: Any, v: Any, tau: Any) -> Any:
        base = jax.lax.stop_gradient(q)
        return function(base, charts.tangent(base, q, jnp.stack), v, tau)

    return call


def of_step(robot: Robot, of: tuple[Any, Any, Any], order: _Order) -> Any:
    """The same of a time step, whose derivatives are those of the difference from the next state."""
    charts, n, nq = Charts(robot), robot.n, robot.nq
    following, jacobian, hessian = of

    def difference(q: Any, v: Any, tau: Any) -> Any:
        return jnp.zeros(jnp.broadcast_shapes(*(part.shape[:-1] for part in (q, v, tau))) + (2 * n,))

    change = of_tangent(robot, (difference, jacobian, hessian), 2 * n, order)

    def call(q: Any, v: Any, tau: Any) -> Any:
        state = jax.lax.stop_gradient(following(*map(jax.lax.stop_gradient, (q, v, tau))))
        d = change(q, v, tau)
        moved = charts.moved(state[..., :nq], d[..., :n], jnp.stack)
        return jnp.concatenate([moved, state[..., nq:] + d[..., n:]], -1)

    return call


def _without_d(function: Any) -> Any:
    return lambda base, _, *rest: function(base, *rest)
