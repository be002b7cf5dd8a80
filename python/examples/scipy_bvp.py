"""The maximum principle as a boundary-value problem for SciPy's solve_bvp, with an exact Jacobian."""

from pathlib import Path

import costate
import costate.scipy
import numpy as np
from scipy.integrate import trapezoid

ROBOTS = Path(__file__).parents[2] / "robots"
START, GOAL = np.zeros(4), np.array([0.4, -0.3, 0.0, 0.0])


def guess(dynamics, nodes=20):
    """A cubic from start to goal with its torques, which are costates of p: from a straight line without any the
    iteration ends at another extremal, which costs more."""
    t, way = np.linspace(0, 1, nodes)[:, None], GOAL[:2] - START[:2]
    q, v, a = START[:2] + (3 - 2 * t) * t**2 * way, 6 * t * (1 - t) * way, (6 - 12 * t) * way
    return np.concatenate([q, dynamics.momentum(q, v), 0 * q, dynamics.rnea(q, v, a)], axis=1).T


if __name__ == "__main__":
    robot = costate.Robot.from_file(ROBOTS / "two_link.toml")
    dynamics = costate.Dynamics(robot, "qp")
    extremal = costate.scipy.Extremal(dynamics, START, GOAL)
    solution = extremal.solve(1.0, guess(dynamics), tol=1e-8, max_nodes=20000)
    assert solution.status == 0, solution.message
    times = np.linspace(0, 1, 2001)
    z = solution.sol(times)
    tau = extremal.torques(z)
    J = trapezoid(0.5 * (tau**2).sum(axis=0), times)
    # H = y'f - 1/2 |tau|^2 is constant along an extremal.
    H = (z[4:] * extremal.fun(None, z)[:4]).sum(axis=0) - 0.5 * (tau**2).sum(axis=0)
    print(f"cost {J:.8g} on {len(solution.x)} nodes; H = {H.mean():.6g}, drift {np.ptp(H):.1e}")
    assert np.ptp(H) < 1e-6 * abs(H.mean())
    problem = costate.Problem(robot, start=START[:2], end=GOAL[:2], time=1.0, cost=[1.0, 1.0], limits=False)
    least = problem.solve(method="collocation").check().cost
    print(f"by costate.Problem: {least:.8g}")
    assert abs(J - least) < 1e-5 * least
