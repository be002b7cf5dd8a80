"""Differential dynamic programming with exact second derivatives, in NumPy.

A two-link arm goes towards a goal in 100 steps of 20 ms: minimise dt/2 sum |tau|^2 + w/2 |x_K - goal|^2.
"""

from pathlib import Path

import costate
import numpy as np

ROBOTS = Path(__file__).parents[2] / "robots"
STEPS, DT, WEIGHT = 100, 0.02, 100.0
GOAL = np.array([2.5, -2.0, 0.0, 0.0])  # q (rad), v (rad/s)


def model() -> costate.Step:
    """One time step of the arm, x+ = Phi(x, tau)."""
    robot = costate.Robot.from_file(ROBOTS / "two_link.toml")
    return costate.Step(costate.Dynamics(robot), "semi_implicit_euler", DT)


def roll_out(step, tau, gains=None, near=None):
    """States and torques from rest, with feedback around other states where gains are given."""
    x, used = np.zeros((STEPS + 1, 4)), np.array(tau)
    for k in range(STEPS):
        if gains is not None:
            used[k] += gains[k] @ (x[k] - near[k])
        x[k + 1] = step.f(x[k, :2], x[k, 2:], used[k])
    return x, used


def cost(x, tau):
    return 0.5 * DT * (tau**2).sum() + 0.5 * WEIGHT * ((x[-1] - GOAL) ** 2).sum()


def backward(step, x, tau, shift):
    """Feedforward k and feedback K of each step; the decrease that they promise; None if a Hessian is indefinite."""
    y, V = WEIGHT * (x[-1] - GOAL), WEIGHT * np.eye(4)  # gradient and Hessian of what is left to pay
    forward, feedback, promised = np.zeros((STEPS, 2)), np.zeros((STEPS, 2, 4)), 0.0
    for k in reversed(range(STEPS)):
        _, J, H = step.contract(x[k, :2], x[k, 2:], tau[k], y)  # H = y'Phi_zz, z = (x, tau)
        Q, g = J.T @ V @ J + H, J.T @ y
        Q[4:, 4:] += DT * np.eye(2) + shift * np.eye(2)
        g[4:] += DT * tau[k]
        if np.linalg.eigvalsh(Q[4:, 4:])[0] <= 0:
            return None
        forward[k] = -np.linalg.solve(Q[4:, 4:], g[4:])
        feedback[k] = -np.linalg.solve(Q[4:, 4:], Q[4:, :4])
        promised -= 0.5 * g[4:] @ forward[k]
        y = g[:4] + feedback[k].T @ g[4:]
        V = Q[:4, :4] + Q[:4, 4:] @ feedback[k]
        V = 0.5 * (V + V.T)
    return forward, feedback, promised


def solve(step, tolerance=1e-12):
    """States, torques, cost, iterations."""
    x, tau = roll_out(step, np.zeros((STEPS, 2)))
    J, shift = cost(x, tau), 0.0
    for iteration in range(200):
        found = backward(step, x, tau, shift)
        while found is None:
            shift = max(4 * shift, 1e-3)
            found = backward(step, x, tau, shift)
        forward, feedback, promised = found
        if promised < tolerance * J:
            return x, tau, J, iteration
        for length in 0.5 ** np.arange(20):
            x_new, tau_new = roll_out(step, tau + length * forward, feedback, x)
            if cost(x_new, tau_new) < J - 0.1 * length * promised:
                break
        else:
            shift = max(4 * shift, 1e-3)
            continue
        x, tau, J, shift = x_new, tau_new, cost(x_new, tau_new), shift / 4 if shift > 1e-6 else 0.0
    raise AssertionError("not solved in 200 iterations")


def kkt_residual(step, x, tau):
    """How well x and tau meet the conditions of first order, written for all steps at once, without a recursion."""
    J = step.jacobian(x[:-1, :2].copy(), x[:-1, 2:].copy(), tau)
    states, torques = 4 * STEPS, 2 * STEPS
    A = np.eye(states)  # derivative of x_{k+1} - Phi(x_k, tau_k) by x_1 .. x_K
    B = np.zeros((states, torques))  # and by the torques
    for k in range(STEPS):
        rows = slice(4 * k, 4 * k + 4)
        if k:
            A[rows, 4 * k - 4 : 4 * k] = -J[k, :, :4]
        B[rows, 2 * k : 2 * k + 2] = -J[k, :, 4:]
    slope = np.zeros(states)
    slope[-4:] = WEIGHT * (x[-1] - GOAL)
    y = np.linalg.solve(A.T, slope)
    return np.abs(DT * tau.ravel() - B.T @ y).max()


def least_cost() -> float:
    """The least cost, for the other examples."""
    return solve(model())[2]


if __name__ == "__main__":
    step = model()
    x, tau, J, iterations = solve(step)
    residual = kkt_residual(step, x, tau)
    print(f"cost {J:.9g} after {iterations} iterations; x_K = {x[-1].round(4)}; residual {residual:.1e}")
    assert residual < 1e-6
    # Nearby torques cost more.
    random = np.random.default_rng(0)
    assert all(cost(*roll_out(step, tau + 1e-3 * random.normal(size=tau.shape))) > J for _ in range(5))
