"""Two phases: an arm stops on its way, takes up a payload, and goes on; the time of the stop is free."""

from pathlib import Path

import costate
import numpy as np

ROBOTS = Path(__file__).parents[2] / "robots"
START, PICK, END, TIME = [0.0, 0.0], [0.9, 0.6], [0.2, 1.6], 2.0
PAYLOAD = {"frame": "tip", "mass": 0.5}

if __name__ == "__main__":
    arm = costate.Robot.from_file(ROBOTS / "two_link.toml").add_frame("tip", "elbow", xyz=[1, 0, 0])
    common = {"cost": [1.0, 1.0], "limits": False}
    whole = costate.Problem(
        arm, start=START, end=END, time=TIME, via=[{"q": PICK, "stop": True, "payload": [PAYLOAD]}], **common
    ).solve(tolerance=1e-8)
    whole.check()
    (stop,) = whole.via_times
    print(f"cost {whole.cost:.7g}; the arm stops at {stop:.5g} s")

    # The same as two problems, at this time and beside it.
    loaded = arm.with_payload("tip", 0.5)

    def both(stop):
        first = costate.Problem(arm, start=START, end=PICK, time=stop, **common)
        second = costate.Problem(loaded, start=PICK, end=END, time=TIME - stop, **common)
        return sum(problem.solve(tolerance=1e-8).check().cost for problem in (first, second))

    apart = [both(stop + shift) for shift in (-0.02, 0.0, 0.02)]
    print("the phases apart, with a stop 0.02 s earlier, then, and 0.02 s later:", np.round(apart, 6))
    assert abs(apart[1] - whole.cost) < 1e-5 * whole.cost
    assert apart[1] < min(apart[0], apart[2])
