"""Newton's method on all torques of a motion, with the exact Hessian by JAX."""

import costate
import costate.jax
import ddp
import jax
import jax.numpy as jnp

jax.config.update("jax_enable_x64", True)

step = costate.jax.Model(ddp.model().dynamics).step("semi_implicit_euler", ddp.DT)


def cost(tau):
    """dt/2 sum |tau|^2 + w/2 |x_K - goal|^2 of the motion from rest."""

    def next_state(x, tau):
        return step(x[:2], x[2:], tau), None

    x, _ = jax.lax.scan(next_state, jnp.zeros(4), tau.reshape(-1, 2))
    return 0.5 * ddp.DT * (tau**2).sum() + 0.5 * ddp.WEIGHT * ((x - ddp.GOAL) ** 2).sum()


value, gradient, hessian = jax.jit(cost), jax.jit(jax.grad(cost)), jax.jit(jax.hessian(cost))

if __name__ == "__main__":
    tau = jnp.zeros(2 * ddp.STEPS)
    for iteration in range(100):
        J, g, H = value(tau), gradient(tau), hessian(tau)
        if jnp.abs(g).max() < 1e-9:
            break
        # Directions of negative curvature are descended too.
        size, directions = jnp.linalg.eigh(H)
        change = -directions @ ((directions.T @ g) / jnp.maximum(jnp.abs(size), 1e-6))
        length = min(1.0, 10 / float(jnp.linalg.norm(change)))
        while value(tau + length * change) > J + 1e-4 * length * (g @ change) + 1e-14 * J:
            length /= 2
        tau = tau + length * change
    J = float(value(tau))
    print(f"cost {J:.9g} after {iteration} iterations")
    expected = ddp.least_cost()
    assert abs(J - expected) < 1e-9 * expected
