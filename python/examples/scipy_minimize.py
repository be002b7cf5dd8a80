"""A motion by SciPy's trust-constr, with exact Jacobians and Hessians of a time step."""

from pathlib import Path

import costate
import costate.scipy
import numpy as np

ROBOTS = Path(__file__).parents[2] / "robots"
START, GOAL, INTERVALS = np.zeros(4), np.array([0.4, -0.3, 0.0, 0.0]), 20

if __name__ == "__main__":
    robot = costate.Robot.from_file(ROBOTS / "two_link.toml")
    step = costate.Step(costate.Dynamics(robot), "rk4", 1 / INTERVALS)
    program = costate.scipy.Transcription(step, INTERVALS, START, GOAL)
    result = program.minimize(gtol=1e-8, maxiter=300)
    x, tau = program.split(result.x)
    print(f"cost {result.fun:.6g} after {result.nit} iterations, constraints to {result.constr_violation:.1e}")
    assert result.constr_violation < 1e-8
    least = costate.Problem(
        robot, start=START[:2], end=GOAL[:2], time=1.0, cost=[1.0, 1.0], limits=False
    ).solve().check().cost
    print(f"of the continuous problem: {least:.6g}")
    assert least < result.fun < least * (1 + 5 / INTERVALS**2)
