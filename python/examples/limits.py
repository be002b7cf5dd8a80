"""A UR5 from rest to rest within its limits of position, rate and torque."""

from pathlib import Path

import costate
import numpy as np

ROBOTS = Path(__file__).parents[2] / "robots"
START = [0.0, -1.6, 1.8, -1.8, -1.57, 0.0]
END = [1.5, -1.0, 1.2, -1.5, -1.57, 0.5]

if __name__ == "__main__":
    robot = costate.Robot.from_file(ROBOTS / "ur5.urdf")
    problem = costate.Problem(robot, start=START, end=END, time=0.8, cost=1 / robot.effort_limits**2, limits=True)
    solution = problem.solve().check()
    print(solution)
    samples = solution.sample(4000)
    # Rates and torques stay within their limits, between the nodes too.
    assert (np.abs(samples.v) <= robot.velocity_limits * (1 + 1e-3)).all()
    assert (np.abs(samples.tau) <= robot.effort_limits * (1 + 1e-9)).all()
    lower, upper = robot.position_limits
    assert (samples.q >= lower - 1e-6).all() and (samples.q <= upper + 1e-6).all()
    # The torques are those of inverse dynamics, and they lead to the end when they are integrated.
    dynamics = costate.Dynamics(robot)
    torques = dynamics.rnea(samples.q, samples.v, samples.a)
    assert np.abs(torques - samples.tau).max() < 1e-3 * np.abs(samples.tau).max()
    times = np.linspace(0, solution.final_time, 8001)
    step = costate.Step(dynamics, "rk4", times[1])
    middle = solution.sample(times=times[:-1] + times[1] / 2).tau
    x = np.concatenate([START, np.zeros(6)])
    for tau in middle:
        x = step.f(x[:6], x[6:], tau)
    miss = np.abs(x - np.concatenate([END, np.zeros(6)])).max()
    print(f"integrated, the torques miss the end by {miss:.1e} rad, rad/s")
    assert miss < 1e-2
