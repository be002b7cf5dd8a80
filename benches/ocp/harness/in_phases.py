"""Values of motions through vias, in cycles, with limits and costs of powers, motors, jerks and rates of torques.

`python benches/ocp/harness/main.py --values` (by `benches/ocp/run --values`) solves them and compares; the tests
`control/tests/control/vias.rs`, `power.rs`, `rates/mod.rs` and `unactuated.rs` hold the same values. The equations of the robots
are written out: nothing is taken from costate."""

import math
from dataclasses import dataclass, field

import casadi as ca

import phases
from in_space import tip
from phases import Phases

HALF_PI = math.pi / 2
# Of the quarter turn, and the via on its way.
START, END, PLACE = (0.0, 0.0), (HALF_PI, HALF_PI), (1.0, 0.2)


@dataclass(frozen=True)
class Value:
    """`within` is the relative difference that the test allows, `more` holds further figures: how they are read off, their
    values, and the differences that the test allows."""
    test: str
    name: str
    value: float
    within: float
    problem: Phases
    more: dict = field(default_factory=dict)


def arm(mass):
    """Two uniform rods of 1 kg and 1 m, with this mass (kg) at the tip."""
    def torques(q, v, a):
        c, s, first = ca.cos(q[1]), ca.sin(q[1]), 0.5 + mass
        own, both = 1 / 3 + mass, 1 / 3 + mass + first * c
        return ca.vertcat((4 / 3 + mass + own + 2 * first * c) * a[0] + both * a[1] - first * s * v[1] * (2 * v[0] + v[1]),
                          both * a[0] + own * a[1] + first * s * v[0]**2)
    return torques


def pendulum(q, v, a):
    """1 kg on a rod of 1 m, with viscous friction."""
    return a + 9.81 * ca.sin(q) + 0.5 * v


def cart_pole(q, v, a):
    """A cart of 1 kg, a uniform pole of 0.1 kg and 1 m, upright at zero."""
    c, s = ca.cos(q[1]), ca.sin(q[1])
    return ca.vertcat(1.1 * a[0] + 0.05 * (c * a[1] - s * v[1]**2), 0.05 * c * a[0] + 0.1 / 3 * a[1] - 0.05 * 9.8 * s)


FREE, LOADED = arm(1.0), arm(2.0)


def at(state, q):
    return [state.q - ca.DM(q)]


def resting(state, q):
    return [*at(state, q), state.v]


def still(x):
    """No accelerations at the ends."""
    return [x[0].a, x[-1].a]


def between(*more):
    """From rest at the start to rest at the end, with more conditions."""
    return lambda x: [*resting(x[0], START), *resting(x[-1], END), *(row for rows in more for row in rows(x))]


def quarter(*more, **changes):
    """The quarter turn without vias."""
    return Phases(**{"robots": (FREE,), "places": (START, END), "times": (1.0,), "conditions": between(*more)} | changes)


def through(*more, **changes):
    """The quarter turn with one via."""
    return Phases(**{"robots": (FREE, FREE), "places": (START, PLACE, END), "times": (0.5, 1.0), "rates": (END,),
                     "free": (True, False), "conditions": between(*more)} | changes)


def via(x):
    return at(x[1], PLACE)


def stop_there(x):
    return resting(x[1], PLACE)


def time(k):
    return lambda found: found.times[k]


# From the via on with 1 kg at the tip, in free time.
PICK = {"robots": (FREE, LOADED), "times": (1.5, 3.0), "free": (True, True), "rates": ()}
RATED = {"smooth": True, "jerk": (1e-3, 2e-3)}


def vias(name, value, within, problem, times, **more):
    """The cost is flat around the best times."""
    most = 0.3 * math.sqrt(within)
    found = {f"time of via {k + 1}": (time(k), at, most) for k, at in enumerate(times)}
    return Value("vias.rs", name, value, within, problem, found | more)


def last(value):
    return time(-1), value, 1e-3


VIAS = (
    vias("a via at a given time", 709.837029, 1e-6, through(via, free=(False, False)), ()),
    vias("at any time", 683.075598, 1e-6, through(via), (0.5353498,)),
    vias("one joint, on the way", 145.13113754, 1e-6,
         through(lambda x: [x[1].q[0] - 1.0], places=(START, (1.0, 1.0), END)), (0.7066422,)),
    vias("stopping", 1763.83704, 1e-6, through(stop_there, rates=()), (0.5208382,)),
    vias("picking up", 119.2922484, 1e-6, through(stop_there, second=20.0, **PICK), (2.1005849,), end=last(4.4734593)),
    vias("picking up, placing, back", 176.89347, 1e-6,
         Phases((FREE, LOADED, FREE), (START, PLACE, END, START), (2.0, 4.5, 6.5), free=(True,) * 3, second=20.0,
                conditions=lambda x: [row for state, q in zip(x, (START, PLACE, END, START)) for row in resting(state, q)]),
         (2.1005849, 4.4734593), end=last(6.6335051)),
    vias("picking up with at most 5 N m", 4.283254, 3e-6,
         through(stop_there, second=1.0, effort=(0.01, 0.01), most={"torque": (5.0, 5.0)}, **PICK), (1.68694,)),
    vias("a given time and rate", 406.59564, 3e-6,
         through(via, lambda x: [x[1].v[0] - 1.0], times=(0.6, 2.0), rates=((1.0, 1.0),), free=(False, True), second=20.0), (),
         rate=(lambda found: found.state(1).v[1], 1.42239, 1e-3)),
    # A dearer minimum than at any time: the elbow first bends the other way.
    vias("the tip at a place", 824.610145, 1e-6,
         through(lambda x: [tip(x[1].q) - ca.DM([math.cos(1) + math.cos(1.2), math.sin(1) + math.sin(1.2)])],
                 rates=((5.0, -9.0),)), (0.5263784,)),
    vias("with a cost of jerks", 993.712714, 1e-5, through(via, **RATED), (0.5491794,)),
    vias("picking up with a cost of jerks", 124.83957, 1e-5, through(stop_there, second=20.0, **RATED, **PICK), (2.276433,)),
    vias("a cycle", 68.300997, 1e-6,
         Phases((FREE, LOADED), ((-0.8, 2.0), PLACE, (-0.8, 2.0)), (1.0, 2.0), free=(True, False),
                conditions=lambda x: [x[0].q[0] + 0.8, x[0].v, x[0].q - x[2].q, x[2].v, *via(x)]),
         (0.8732841,), elbow=(lambda found: found.state(0).q[1], 2.7045956, 1e-3)),
    vias("a turn of a pendulum", 3.29039479, 1e-6,
         Phases((pendulum,), ((-math.pi,), (math.pi,)), (2.0,), effort=(1.0,),
                conditions=lambda x: [x[0].q + math.pi, x[1].q - math.pi, x[0].v - x[1].v]),
         (), rate=(lambda found: found.state(0).v[0], 1.09770715, 1e-4)),
)

POWER = tuple(Value("power.rs", *rest) for rest in (
    ("at most 30 and 150 W", 151.21889, 3e-6, quarter(most={"power": (30.0, 150.0)})),
    ("at most 120 W of both joints", 146.80174, 3e-6, quarter(most={"total power": (120.0,)})),
    ("motors", 150.33038, 3e-6, quarter(most={"torque": (20.0, 28.0)}, motor=((3.0, 4.0), (8.0, 12.0)))),
    ("a cost of energy", 172.99066, 3e-6, quarter(energy=1.0)),
    ("two_link_motors.toml", 180.73515, 3e-6,
     quarter(energy=1.0, most={"torque": (25.0, 28.0), "total power": (80.0,)}, motor=((3.0, 4.0), (8.0, 12.0)))),
))


def smooth(*more, **changes):
    return quarter(*more, smooth=True, **changes)


LEAST = {"times": (1.2,), "free": (True,), "second": 1.0, "effort": (0.0, 0.0)}
JERKS = {"jerk": (60.0, 80.0)}
COST = (1e-3, 5e-4)
RATES = tuple(Value("rates/mod.rs", *rest) for rest in (
    ("jerks, at rest", 315.38594, 3e-6, smooth(still, most={"jerk": (200.0, 300.0)})),
    ("jerks", 522.59880, 3e-6, smooth(most={"jerk": (60.0, 120.0)})),
    ("rates of torques", 146.15291, 1e-6, smooth(most={"torque rate": (75.0, 120.0)})),
    ("a cost of jerks", 219.26025905, 1e-6, smooth(jerk=(1e-3, 2e-3))),
    ("a cost of rates of torques", 148.26055156, 1e-6, smooth(torque_rate=COST)),
    ("the same, at rest", 172.08693898, 1e-6, smooth(still, torque_rate=COST)),
    ("least time, jerks", 0.94269861, 1e-6, smooth(still, most=JERKS, **LEAST)),
    ("least time, jerks and rates of torques", 1.27668027, 1e-5,
     smooth(still, most=JERKS | {"torque rate": (150.0, 80.0)}, **LEAST)),
    ("two_link_jerk.toml", 1.44097521, 1e-5,
     smooth(still, most=JERKS | {"torque": (25.0, 9.0), "torque rate": (150.0, 80.0)}, **LEAST)),
    ("a cost of jerks, rates of torques", 380.05161, 3e-6,
     smooth(still, jerk=(1e-3, 1e-3), second=80.0, most={"torque rate": (300.0, 150.0)})),
))

UNACTUATED = (
    Value("unactuated.rs", "swing-up", 31.928860223, 1e-6,
          Phases((cart_pole,), ((0.0, math.pi), (1.0, 0.0)), (2.0,), effort=(1.0, 0.0), most={"torque": (20.0, 0.0)},
                 conditions=lambda x: [*resting(x[0], (0.0, math.pi)), *resting(x[1], (1.0, 0.0))])),
)


def check(*_):
    """Solves every problem; whether all values are reproduced."""
    kept = True
    for value in (*VIAS, *POWER, *RATES, *UNACTUATED):
        found = phases.solve(value.name, value.problem)
        difference = abs(found.cost / value.value - 1)
        reproduced = difference <= value.within and found.change <= phases.SETTLED
        told = ""
        for name, (read, expected, within) in value.more.items():
            reproduced &= abs(read(found) - expected) <= within
            told += f", {name} {expected:.9g}: {read(found):.9g}"
        kept &= reproduced
        print(f"{value.test}: {value.name}: {value.value:.11g}; collocation, {found.elements} elements: {found.cost:.11g}, "
              f"{difference:.1e}, last change {found.change:.0e}{told}: {'reproduced' if reproduced else 'NOT REPRODUCED'}",
              flush=True)
    return kept
