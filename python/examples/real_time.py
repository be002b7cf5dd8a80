"""The same problem solved again and again while its end moves, as a controller does."""

from pathlib import Path

import costate
import numpy as np

ROBOTS = Path(__file__).parents[2] / "robots"
V_MAX = [np.inf, 7.0]  # rad/s

if __name__ == "__main__":
    arm = costate.Robot.from_file(ROBOTS / "two_link.toml")

    def problem(start, v, end):
        limits = {"v_max": V_MAX, "from_robot": False}
        return costate.Problem(arm, start={"q": start, "v": v}, end=end, time=1.0, cost=[1.0, 1.0], limits=limits)

    q, v, end = np.zeros(2), np.zeros(2), np.array([1.5, 1.5])
    options = {"nodes": 61, "tolerance": 1e-7, "machine_code": "at_once"}
    motion = costate.Resolve(problem(q, v, end), **options)
    first = motion.solve()
    assert first.status == "solved"
    steps = []
    for period in range(20):
        q, v, _ = motion.state(0.01)  # what the robot measures after 10 ms
        q = q + 1e-3 * np.sin(period)  # it is never quite where it should be
        v = np.clip(v, np.negative(V_MAX), V_MAX)
        end = end + [0.004, -0.002]
        motion.set_start(q, v)
        motion.set_end(end, np.zeros(2))
        found = motion.solve(steps=20)
        assert found.keeps_limits and found.status == "solved"
        steps.append(found.iterations)
        tau = motion.torques(0.0)  # N m, for the next period
    print(f"first solve: {first.iterations} Newton steps; later ones: {np.mean(steps):.1f}; torques now {tau}")
    anew = costate.Resolve(problem(q, v, end), **options).solve()
    print(f"cost {found.cost:.7g}; solved anew {anew.cost:.7g}")
    assert abs(found.cost - anew.cost) < 1e-5 * anew.cost
    # The gain of the optimal feedback: what the torques change by where the state is off.
    K = motion.feedback().gain(0.0)
    off = 1e-4 * np.array([1.0, -0.5, 0.3, 0.2])
    before = motion.torques(0.0)
    motion.set_start(q + off[:2], v + off[2:])
    motion.solve(steps=20)
    change = motion.torques(0.0) - before
    print(f"predicted change {K @ off}, found {change}")
    assert np.abs(K @ off - change).max() < 2e-2 * np.abs(change).max()
