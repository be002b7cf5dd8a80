"""Values of problems with limits, and the peer's on fine meshes.

`python benches/ocp/harness/main.py --values` (by `benches/ocp/run --values`) solves them by the peer and compares: it has them
to `within`. The further digits are of programs that are not kept here. `source` names their methods: "barrier" is an interior
point on the extremals, "collocation" direct collocation on a mesh graded by hand."""

import math
from dataclasses import dataclass

import casadi as ca
import numpy

import robots
from peer import Peer
from solvers import MIDDLE, Fatrop
from staged import Staged
from task import Task

HALF_PI = math.pi / 2


@dataclass(frozen=True)
class Value:
    name: str
    robot: str
    value: float
    source: str
    task: dict
    # Elements of the peer's mesh, and the relative difference that it reaches there.
    elements: int = 160
    within: float = 1e-4
    # Start from the motion without obstacles: the straight line leads to a dearer minimum.
    free_first: bool = False


def array(*values):
    return numpy.array(values, dtype=float)


class OnLine(Task):
    """The two-link arm's tip on the line y = height."""
    height = 1.2

    def end_conditions(self, q):
        return ca.sin(q[0]) + ca.sin(q[0] + q[1]) - self.height


QUARTER = dict(q_start=array(0, 0), q_end=array(HALF_PI, HALF_PI), duration=1.0, effort=array(1, 1),
               torque_size=array(10, 10))
SWING = dict(q_start=array(0), q_end=array(math.pi), effort=array(1), torque_size=array(5), duration=3.0)
LEAST = dict(effort=array(0, 0), time_weight=1.0, free=True, q_start=array(0, 0.5), q_end=array(0.522, 0.5), duration=3.5,
             torque_size=array(1, 1), u_min=array(-1, -1), u_max=array(1, 1))
MANUTEC = dict(q_start=array(0, -1.5, 0), q_end=array(1, -1.95, 1), torque_size=array(945, 1890, 540),
               u_min=-array(945, 1890, 540), u_max=array(945, 1890, 540))
BOTH = "barrier, collocation"

VALUES = (
    Value("quarter turn", "two_link", 145.13113754, "extremals", QUARTER, 80, 1e-7),
    Value("quarter turn, |v_2| <= 7", "two_link", 155.74483972, BOTH, {**QUARTER, "v_max": array(math.inf, 7)}),
    Value("quarter turn in 2 s, |u| <= (12, 5), |v_2| <= 3, q_1 >= -0.5", "two_link", 22.5760933, BOTH,
          {**QUARTER, "duration": 2.0, "u_min": -array(12, 5), "u_max": array(12, 5), "v_max": array(math.inf, 3),
           "q_min": array(-0.5, -math.inf)}),
    Value("quarter turn, tip outside a disc at (0.34, 0.59) of radius 0.25", "two_link", 170.506985, BOTH,
          {**QUARTER, "obstacles": [((0.34, 0.59, 0.0), 0.25)]}, free_first=True),
    Value("end on the line y = 1.2 of the tip", "two_link", 68.5270885, BOTH,
          {**QUARTER, "q_end": None, "q_guess": array(0.3, 0.9)}),
    Value("least time, |v| <= (0.35, 1)", "two_link", 3.2300988, BOTH, {**LEAST, "v_max": array(0.35, 1)}),
    Value("least time", "two_link", 2.98228, "extremals", LEAST),
    Value("swing-up in 3 s, q >= -0.7", "pendulum", 19.4870292, BOTH, {**SWING, "q_min": array(-0.7)}),
    Value("swing-up in 3 s, q >= -0.2", "pendulum", 27.844211, BOTH, {**SWING, "q_min": array(-0.2)}),
    Value("least time, |v| <= (3, 1.5, 5.2)", "manutec_r3", 0.49518904, BOTH,
          {**MANUTEC, "effort": array(0, 0, 0), "time_weight": 1.0, "free": True, "duration": 0.6,
           "v_max": array(3, 1.5, 5.2)}),
    # Cost of u^2 with u in volts: effort 2 for the voltage, 2/gain^2 for the torque.
    Value("least energy in 0.53 s", "manutec_r3", 20.40425, "extremals",
          {**MANUTEC, "effort": 2 / array(126, 252, 72)**2, "duration": 0.53}),
)


COARSE = 20
# Elements of FATROP, and the relative difference that it reaches there.
FATROP = 40, 1e-3


def check(root, costate, peer):
    """Solves every problem by the peer and, on coarser meshes, by FATROP; whether all values are reproduced."""
    rows = []
    by_fatrop = Peer(peer.points, Fatrop(MIDDLE), Staged)
    for name, side, elements, within in (("peer", peer, None, 0.0), ("FATROP", by_fatrop, *FATROP)):
        for value in VALUES:
            robot = robots.read(root, costate, value.robot)
            kind = OnLine if value.task["q_end"] is None else Task
            task = kind(value.name, "value", robot, **value.task)
            first = task.but(obstacles=[]) if value.free_first else task
            # FATROP's program is checked here, not whether FATROP finds the same minimum.
            start = peer.solve(first, COARSE).motion if value.free_first or elements else None
            found = side.solve(task, elements or value.elements, start)
            difference = abs(found.cost - value.value) / value.value
            rows.append(found.solved and difference <= max(value.within, within))
            print(f"{value.robot}: {value.name}: {value.value:.9g} ({value.source}); {name}, "
                  f"{elements or value.elements} elements: {found.cost:.9g}, {difference:.1e}, {found.iterations} iterations, {found.seconds:.2f} s: "
                  f"{'reproduced' if rows[-1] else f'NOT REPRODUCED, {found.status}'}", flush=True)
    return all(rows)
