"""A motion by CasADi's Opti and IPOPT, with the exact Hessian of a time step."""

from pathlib import Path

import casadi
import costate
import costate.casadi
import numpy as np

ROBOTS = Path(__file__).parents[2] / "robots"
START, END, INTERVALS = [0.0, 0.0], [np.pi / 2, np.pi / 2], 50


def solve(robot):
    """Least effort, rest to rest in 1 s, torques constant on each interval."""
    dt = 1 / INTERVALS
    step = costate.casadi.step(robot, "rk4", dt)  # (x, tau) -> x_next, x = (q, v)
    opti = casadi.Opti()
    x, tau = opti.variable(4, INTERVALS + 1), opti.variable(2, INTERVALS)
    opti.minimize(0.5 * dt * casadi.sumsqr(tau))
    opti.subject_to(x[:, 0] == np.array(START + [0, 0]))
    opti.subject_to(x[:, -1] == np.array(END + [0, 0]))
    for k in range(INTERVALS):
        opti.subject_to(x[:, k + 1] == step(x[:, k], tau[:, k]))
    opti.set_initial(x, np.linspace(START + [0, 0], END + [0, 0], INTERVALS + 1).T)
    opti.solver("ipopt", {"ipopt.print_level": 0, "ipopt.sb": "yes", "print_time": 0})
    solution = opti.solve()
    return solution.value(opti.f), solution.stats(), costate.casadi.calls(step)


if __name__ == "__main__":
    robot = costate.Robot.from_file(ROBOTS / "two_link.toml")
    J, stats, calls = solve(robot)
    print(f"{stats['return_status']}: cost {J:.6g} after {stats['iter_count']} iterations; calls: {calls}")
    # Each Hessian of IPOPT is one exact contraction for each interval: nothing is differenced.
    assert calls["jac_adj1_f"] == INTERVALS * stats["n_call_nlp_hess_l"] > 0
    # Torques that may change at any time cost less, by a part of second order in dt.
    least = costate.Problem(robot, start=START, end=END, time=1.0, cost=[1.0, 1.0], limits=False).solve().check().cost
    print(f"of the continuous problem: {least:.6g}")
    assert least < J < least * (1 + 5 / INTERVALS**2)
