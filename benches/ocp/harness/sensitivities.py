"""Derivatives of an optimal cost by parameters of the robot, against differences of the peer's costs."""

import copy

import robots
from task import Task
from values import QUARTER

# dJ/dtheta of the quarter turn: mass at the tip, length of rod 1 (uniform, of the same mass), inertia added at the tip.
SENSITIVITIES = {"mass": 121.36971718, "length": 357.75366826, "inertia": 271.71942099}
# Step of the differences, and the relative error that they may have.
STEP, WITHIN = 1e-3, 1e-5
ELEMENTS = 80


def two_link(robot, mass=1.0, length=1.0, inertia=0.0):
    """The arm with another mass at its tip, another first rod, more inertia at the tip."""
    changed = copy.deepcopy(robot)
    changed.name = f"two_link_{round(mass / STEP)}_{round(length / STEP)}_{round(inertia / STEP)}".replace("-", "m")
    upper, lower = changed.joints
    total = 1 + mass
    centre = (0.5 + mass) / total
    lower["mass"], lower["com"][0] = total, centre
    lower["inertia"][2][2] = 1 / 3 + mass + inertia - total * centre**2
    lower["placement"]["xyz"][0] = length
    upper["com"][0], upper["inertia"][2][2] = length / 2, length**2 / 12
    return changed


def check(root, costate, peer):
    """By central differences of the peer's costs."""
    robot = robots.read(root, costate, "two_link")
    cost = lambda **change: peer.solve(Task("", "value", two_link(robot, **change), **QUARTER), ELEMENTS).cost
    kept = True
    for name, value in SENSITIVITIES.items():
        middle = {"mass": 1.0, "length": 1.0, "inertia": 0.0}[name]
        found = (cost(**{name: middle + STEP}) - cost(**{name: middle - STEP})) / (2 * STEP)
        difference = abs(found - value) / value
        kept &= difference <= WITHIN
        print(f"two_link: quarter turn, dJ/d {name}: {value:.10g} (envelope theorem); peer: {found:.10g}, {difference:.1e}: "
              f"{'reproduced' if difference <= WITHIN else 'NOT REPRODUCED'}", flush=True)
    return kept
