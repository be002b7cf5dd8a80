"""Values of motions whose tool keeps something or costs something, that pass obstacles, or that keep all limits of an arm.

`python benches/ocp/harness/main.py --values` (by `benches/ocp/run --values`) solves them and compares; the tests of
`control/tests/control/in_space.rs` hold the same values. Every condition is written out here for its robot, not as the library
has it: directions and distances of points, angles of the planar arm as sums of its joint angles."""

import math
from dataclasses import dataclass
from typing import Callable

import casadi as ca
import numpy

import radau
import robots
from model import Model

ELEMENTS, WITHIN = 320, 2e-5
INF = math.inf


def nothing(q, v):
    return []


@dataclass(frozen=True)
class Value:
    """`rows` gives (expression, lower, upper) of what is kept, `running` what costs beside half the squared torques."""
    name: str
    value: float
    q_start: tuple
    q_end: tuple
    rows: Callable = nothing
    running: Callable = lambda q: 0
    robot: str = "two_link"
    duration: float = 1.0
    effort: tuple = (1.0, 1.0)
    # Largest |q|, |v| and |tau|, or (least, largest) for q.
    q_limits: tuple = ((-INF,), (INF,))
    v_max: tuple = (INF,)
    torque_max: tuple = (INF,)
    elements: int = ELEMENTS


def tip(q):
    """Of the two-link arm."""
    return ca.vertcat(ca.cos(q[0]) + ca.cos(q[0] + q[1]), ca.sin(q[0]) + ca.sin(q[0] + q[1]))


def elbow(x, y, cos=math.cos, sin=math.sin, acos=math.acos, atan2=math.atan2):
    """The position of the two-link arm with its tip there, bent to the right."""
    bend = acos((x * x + y * y - 2) / 2)
    return atan2(y, x) - atan2(sin(bend), 1 + cos(bend)), bend


def beside_box(q):
    """The distance of the tip from the box, squared."""
    x = tip(q)
    outside = [ca.fmax(ca.fabs(x[k] - centre) - half, 0) for k, (centre, half) in enumerate(((0.9, 0.25), (0.0, 0.2)))]
    return outside[0]**2 + outside[1]**2


QUARTER = dict(q_start=(0.0, 0.0), q_end=(math.pi / 2, math.pi / 2))
# The tip from (1.2, -0.6) to (1.2, 0.6) m.
ALONG = dict(q_start=elbow(1.2, -0.6), q_end=elbow(1.2, 0.6))
UR5 = dict(robot="ur5", q_start=(0.0, -1.6, 1.8, -1.8, -1.57, 0.0), q_end=(1.5, -1.0, 1.2, -1.5, -1.57, 0.5),
           effort=(4.4444444e-5,) * 3 + (1.2755102e-3,) * 3, q_limits=((-2 * math.pi,), (2 * math.pi,)), v_max=(math.pi,),
           torque_max=(150.0,) * 3 + (28.0,) * 3)
PANDA = dict(robot="panda", q_start=(0.0, -0.5, 0.0, -2.2, 0.0, 1.7, 0.8), q_end=(1.2, 0.3, -0.4, -1.6, 0.5, 2.2, 0.2),
             effort=(1.3211785e-4,) * 4 + (6.9444444e-3,) * 3,
             q_limits=((-2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973),
                       (2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973)),
             v_max=(2.175,) * 4 + (2.61,) * 3, torque_max=(87.0,) * 4 + (12.0,) * 3)

VALUES = (
    Value("a cost of the tip, 1000 per squared metre from (1.2, 1.2)", 2007.524506, **QUARTER,
          running=lambda q: 1000 * ca.sumsqr(tip(q) - ca.DM([1.2, 1.2]))),
    Value("the tip within 0.05 m of x = 1.2: a plane, a line, a box; beyond a wall", 50.334388, **ALONG,
          rows=lambda q, v: [(tip(q)[0], 1.15, 1.25)]),
    Value("an axis, or the orientation, of the second link within 1.2 rad", 292.1224, (0.0, 0.0), (math.pi / 2, 0.0),
          rows=lambda q, v: [(q[0] + q[1], math.pi / 4 - 1.2, math.pi / 4 + 1.2)]),
    Value("the tip at most 4 m/s fast", 157.542706, **QUARTER,
          rows=lambda q, v: [(ca.sumsqr(ca.jtimes(tip(q), q, v)), -INF, 16.0)]),
    Value("a ball of 0.05 m at the tip beside a box", 53.55413, **ALONG, rows=lambda q, v: [(beside_box(q), 0.05**2, INF)]),
    Value("balls of 0.3 and 0.5 m at the tip and at the base", 46.009469, (0.0, 2.2), (1.5, 2.2),
          rows=lambda q, v: [(ca.sumsqr(tip(q)), 0.8**2, INF)]),
    Value("all limits of a UR5", 0.01226013763, **UR5, elements=80),
    Value("all limits of a Panda", 0.04458062569, **PANDA, elements=80),
)


def functions(robot, value):
    """(q, v, a) to (running cost, torques and rows) at a point, and the bounds of these."""
    n = robot.n
    q, v, a = (ca.SX.sym(name, n) for name in "qva")
    tau = Model(robot).torques(q, v, a)
    rows = value.rows(q, v)
    limited = numpy.isfinite(full(value.torque_max, n))
    kept = [tau[i] for i in numpy.flatnonzero(limited).tolist()] + [row[0] for row in rows]
    most = full(value.torque_max, n)[limited]
    lower, upper = ([*sign * most, *(row[k] for row in rows)] for k, sign in ((1, -1), (2, 1)))
    cost = ca.dot(ca.DM(value.effort), tau**2) / 2 + value.running(q)
    point = ca.Function("point", [q, v, a], [cost, ca.vertcat(*kept)], {"cse": True})
    return point, numpy.array(lower), numpy.array(upper)


def full(numbers, n):
    return numpy.broadcast_to(numpy.array(numbers, dtype=float), n)


def solve(robot, value, tolerance=1e-9):
    """By Radau collocation of degree 3: the cost, the number of IPOPT's iterations, and whether it is solved."""
    n, d, duration = robot.n, radau.DEGREE, value.duration
    count = value.elements * d
    h = duration / value.elements
    point, lower, upper = functions(robot, value)
    q, v, a = (ca.MX.sym(name, n, count) for name in "qva")
    cost, kept = point.map(count)(q, v, a)
    weights = ca.DM(numpy.tile(radau.WEIGHTS * h, value.elements)).T
    equations = []
    for state, rate, first in ((q, v, value.q_start), (v, a, (0.0,) * n)):
        ends = ca.horzcat(ca.DM(first), state[:, d - 1:-1:d])
        nodes = [ends, *(state[:, j::d] for j in range(d))]
        for j in range(d):
            slope = sum(radau.DERIVATIVE[r, j] * nodes[r] for r in range(d + 1))
            equations.append(ca.vec(slope - h * rate[:, j::d]))
    g = ca.vertcat(*equations, ca.vec(kept))
    zeros = numpy.zeros(2 * n * count)
    bounds = [numpy.concatenate([zeros, numpy.tile(side, count)]) for side in (lower, upper)]
    low, high = ([full(side, n)] * count for side in value.q_limits)
    low[-1] = high[-1] = numpy.array(value.q_end)
    v_max = [full(value.v_max, n)] * (count - 1) + [numpy.zeros(n)]
    free = numpy.full(n * count, INF)
    x_low = numpy.concatenate([*low, *(-most for most in v_max), -free])
    x_high = numpy.concatenate([*high, *v_max, free])
    s = ((numpy.arange(value.elements)[:, None] + radau.POINTS) / value.elements).ravel()[:, None]
    start, end = numpy.array(value.q_start), numpy.array(value.q_end)
    guess = [start + (end - start) * s**2 * (3 - 2 * s), (end - start) * 6 * s * (1 - s) / duration,
             (end - start) * (6 - 12 * s) / duration**2]
    options = {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.mu_strategy": "adaptive",
               "ipopt.tol": tolerance, "ipopt.bound_relax_factor": 0.0, "ipopt.max_iter": 500}
    unknowns = ca.vertcat(ca.vec(q), ca.vec(v), ca.vec(a))
    solver = ca.nlpsol("solver", "ipopt", {"x": unknowns, "f": ca.dot(weights, cost), "g": g}, options)
    found = solver(x0=numpy.concatenate([part.ravel() for part in guess]), lbx=x_low, ubx=x_high, lbg=bounds[0], ubg=bounds[1])
    return float(found["f"]), solver.stats()["iter_count"], solver.stats()["success"]


def on_the_plane(elements=ELEMENTS):
    """The tip on x = 1.2 from y = -0.6 to 0.6 m in 1 s: by inverse kinematics a motion of one number y, whose second derivative
    is the control. Half the integral of the squared torques of the unit arm."""
    y, rate, second = (ca.SX.sym(name) for name in ("y", "rate", "second"))
    q = ca.vertcat(*elbow(1.2, y, ca.cos, ca.sin, ca.acos, ca.atan2))
    v = ca.jacobian(q, y) * rate
    a = ca.jacobian(q, y) * second + ca.jacobian(v, y) * rate
    c, s = ca.cos(q[1]), ca.sin(q[1])
    bias = 1.5 * s * ca.vertcat(-v[1] * (2 * v[0] + v[1]), v[0]**2)
    tau = ca.vertcat((11 / 3 + 3 * c) * a[0] + (4 / 3 + 1.5 * c) * a[1], (4 / 3 + 1.5 * c) * a[0] + 4 / 3 * a[1]) + bias
    point = ca.Function("point", [y, rate, second], [ca.sumsqr(tau) / 2])
    count, d, h = elements * radau.DEGREE, radau.DEGREE, 1 / elements
    states = [ca.MX.sym(name, 1, count) for name in ("y", "rate", "second")]
    equations = []
    for state, slope, first in ((states[0], states[1], -0.6), (states[1], states[2], 0.0)):
        nodes = [ca.horzcat(first, state[d - 1:-1:d]), *(state[j::d] for j in range(d))]
        for j in range(d):
            equations.append(ca.vec(sum(radau.DERIVATIVE[r, j] * nodes[r] for r in range(d + 1)) - h * slope[j::d]))
    equations += [states[0][-1] - 0.6, states[1][-1]]
    cost = ca.dot(ca.DM(numpy.tile(radau.WEIGHTS * h, elements)), ca.vec(point.map(count)(*states)))
    s = ((numpy.arange(elements)[:, None] + radau.POINTS) / elements).ravel()
    guess = numpy.concatenate([-0.6 + 1.2 * s**2 * (3 - 2 * s), 7.2 * s * (1 - s), 7.2 * (1 - 2 * s)])
    options = {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.tol": 1e-10}
    program = {"x": ca.vertcat(*map(ca.vec, states)), "f": cost, "g": ca.vertcat(*equations)}
    solver = ca.nlpsol("solver", "ipopt", program, options)
    return float(solver(x0=guess, lbg=0, ubg=0)["f"])


ON_THE_PLANE = 53.7038197


def check(root, costate, _):
    """Solves every problem; whether all values are reproduced."""
    rows = []
    for value in VALUES:
        robot = robots.read(root, costate, value.robot)
        cost, iterations, solved = solve(robot, value)
        rows.append((f"{value.robot}: {value.name}", value.value, cost, solved, f", {iterations} iterations"))
    rows.append(("two_link: the tip on a plane", ON_THE_PLANE, on_the_plane(), True, ""))
    kept = True
    for name, value, cost, solved, more in rows:
        difference = abs(cost - value) / value if value else INF
        reproduced = solved and difference <= WITHIN
        kept &= reproduced
        print(f"{name}: {value:.9g}; collocation: {cost:.9g}, {difference:.1e}{more}: "
              f"{'reproduced' if reproduced else 'NOT REPRODUCED'}", flush=True)
    return kept
