"""Motions in phases by collocation in CasADi and IPOPT: vias, robots that change there, cycles, limits and costs of torques,
powers, jerks and rates of torques.

The state x is (q, v), the control w the acceleration; with jerks or rates of torques x is (q, v, a) and w the jerk. On each
element x is the polynomial through its values at the left end and at Radau's points, where

    sum_r C_rj x_r = T h (x'_j),   x' = (v, a) or (v, a, w),

T being the time of the phase, an unknown, and h the share of the element. Torques are inverse dynamics at the points, their
rates tau_q v + tau_v a + tau_a w. Elements in which the control bends most are split until the cost does not change."""

import math
from dataclasses import dataclass, field
from typing import Callable

import casadi as ca
import numpy
from scipy.interpolate import CubicHermiteSpline

import radau
from shell import stop

DEGREE = 4
POINTS = numpy.array(ca.collocation_points(DEGREE, "radau"))
DERIVATIVE, _, WEIGHTS = ca.collocation_coeff(list(POINTS))
# Of the polynomial through values at the points: its first coefficient.
LEADING = numpy.array([polynomial.coeffs[0] for polynomial in radau.basis(POINTS)])
# Elements of a phase at first, parts of one that is split, rounds of splitting, the relative change of the cost that ends them,
# and the part of the largest bend from which elements are split.
ELEMENTS, PARTS, ROUNDS, SETTLED, BENT = 40, 4, 8, 1e-9, 0.1
# Smoothing of the cost of energy (W).
SMOOTHING = 1.0
# What IPOPT's tolerance is absolute for: costs are scaled to this, as far as they are known.
SIZE = 1000.0

PLACES = (numpy.arange(PARTS)[:, None] + POINTS) / PARTS
STATE_AT, CONTROL_AT = (numpy.array([[[polynomial(s) for s in part] for part in PLACES] for polynomial in radau.basis(nodes)])
                        for nodes in (numpy.append(0.0, POINTS), POINTS))


@dataclass(frozen=True)
class State:
    q: object
    v: object
    a: object = None


@dataclass(frozen=True)
class Phases:
    """`robots` gives tau(q, v, a) of each phase. At `times` (s) phases end, those of `free` are guesses; the guess of positions
    begins at the first of `places` and ends phases at the others. `conditions` gives what vanishes, of the states at the start
    and at the end of each phase. Costs: of a second, half a squared torque, a joule, half a squared jerk and rate of a torque.
    `most` holds limits by the names in `magnitudes`; torque zero is an equation."""
    robots: tuple
    places: tuple
    times: tuple
    conditions: Callable
    free: tuple = (False,)
    # Of the guess, where phases meet; without them it stops there.
    rates: tuple = ()
    second: float = 0.0
    effort: tuple = (1.0, 1.0)
    energy: float = 0.0
    jerk: tuple = (0.0, 0.0)
    torque_rate: tuple = (0.0, 0.0)
    most: dict = field(default_factory=dict)
    # Speeds up to which a motor has its full torque, and at which it has none.
    motor: tuple = ()
    # Whether accelerations are part of the state.
    smooth: bool = False


@dataclass
class Found:
    """`pieces` holds shares of the elements, states at their nodes and controls at their points, for each phase."""
    cost: float
    times: numpy.ndarray
    pieces: list
    change: float = math.inf

    @property
    def elements(self):
        return sum(len(shares) for shares, *_ in self.pieces)

    def state(self, place):
        """(q, v) at the start or at the end of a phase."""
        _, nodes, controls = self.pieces[max(place - 1, 0)]
        n = controls.shape[2]
        row = nodes[-1, -1] if place else nodes[0, 0]
        return State(row[:n], row[n:2 * n])


def magnitudes(problem, q, v, tau, rate, jerk):
    power = tau * v
    found = {"torque": tau, "power": power, "total power": ca.sum1(power), "torque rate": rate, "jerk": jerk}
    if problem.motor:
        # Falls from the torque limit at the first speed to zero at the second one: a line in (v, tau).
        corner, none = (ca.DM(speeds) for speeds in problem.motor)
        found["motor"] = (tau / ca.DM(problem.most["torque"]) * (none - corner) + v) / none
    return found


def point(problem, torques):
    """(x, w) to the running cost and to what is kept at a point, in parts of its limits; the limits of these."""
    q, v, a, jerk = (ca.SX.sym(name, len(problem.places[0])) for name in ("q", "v", "a", "jerk"))
    tau = torques(q, v, a)
    rate = ca.jtimes(tau, ca.vertcat(q, v, a), ca.vertcat(v, a, jerk))
    half_squares = lambda weights, rows: ca.dot(ca.DM(weights), rows**2) / 2
    power = tau * v
    cost = half_squares(problem.effort, tau)
    cost += problem.energy / 2 * ca.sum1(power + ca.sqrt(power**2 + SMOOTHING**2) - SMOOTHING)
    if problem.smooth:
        cost += half_squares(problem.jerk, jerk) + half_squares(problem.torque_rate, rate)
    kept, most = [], []
    found = magnitudes(problem, q, v, tau, rate, jerk)
    for name, limits in (problem.most | ({"motor": (1.0,) * tau.numel()} if problem.motor else {})).items():
        for i, limit in enumerate(limits):
            if math.isfinite(limit):
                kept.append(found[name][i] / (limit or 1.0))
                most.append(1.0 if limit else 0.0)
    state, control = (ca.vertcat(q, v, a), jerk) if problem.smooth else (ca.vertcat(q, v), a)
    return ca.Function("point", [state, control], [cost, ca.vertcat(*kept)], {"cse": True}), numpy.array(most)


def guess(problem):
    """Cubics from place to place, at rest at the ends."""
    times, places = numpy.append(0.0, problem.times), numpy.array(problem.places)
    rates = numpy.zeros(places.shape)
    for row, given in zip(rates[1:-1], problem.rates):
        row[:] = given
    spline = CubicHermiteSpline(times, places, rates)
    orders = 3 if problem.smooth else 2
    pieces = []
    for k in range(len(problem.times)):
        shares = numpy.full(ELEMENTS, 1 / ELEMENTS)
        nodes = (numpy.arange(ELEMENTS)[:, None] + numpy.append(0.0, POINTS)) / ELEMENTS
        # Inside of the phase, as accelerations jump at its ends.
        t = times[k] + (times[k + 1] - times[k]) * (nodes * (1 - 2e-9) + 1e-9)
        values = [spline(t, order) for order in range(orders + 1)]
        pieces.append((shares, numpy.concatenate(values[:orders], axis=2), values[orders][:, 1:]))
    return Found(math.nan, numpy.array(problem.times), pieces)


def split(found):
    """The same motion with the elements split in which the control bends most, weighted by the square of their time."""
    spans = numpy.diff(numpy.append(0.0, found.times))
    size = numpy.max([abs(controls).max((0, 1)) for *_, controls in found.pieces], axis=0)
    bends = [(abs(numpy.einsum("r,krn->kn", LEADING, controls)) / size).max(1) * (span * shares)**2
             for span, (shares, _, controls) in zip(spans, found.pieces)]
    least = BENT * max(bend.max() for bend in bends)
    pieces = []
    for bend, piece in zip(bends, found.pieces):
        parts = [[], [], []]
        for bent, share, nodes, controls in zip(bend > least, *piece):
            if not bent:
                new = [[share], [nodes], [controls]]
            else:
                inner = numpy.einsum("rpj,rn->pjn", STATE_AT, nodes)
                first = numpy.concatenate([nodes[:1], inner[:-1, -1]])
                new = [[share / PARTS] * PARTS, numpy.concatenate([first[:, None], inner], axis=1),
                       numpy.einsum("rpj,rn->pjn", CONTROL_AT, controls)]
            for rows, more in zip(parts, new):
                rows.extend(more)
        pieces.append(tuple(map(numpy.array, parts)))
    return Found(found.cost, found.times, pieces)


class Program:
    """The nonlinear program on the elements of a motion, which is its first guess."""

    def __init__(self, problem, start):
        self.unknowns, self.x0, self.low = [], [], []
        self.rows, self.limits = [], []
        spans = numpy.diff(numpy.append(0.0, start.times))
        durations = [self.unknown(span, 0.05 * span) for span in spans]
        ends, self.parts, cost = [], [], 0
        for torques, duration, (shares, nodes, controls) in zip(problem.robots, durations, start.pieces):
            function, most = point(problem, torques)
            flat = lambda rows: rows.reshape(-1, rows.shape[2]).T
            first, x, w = self.unknown(nodes[0, 0]), self.unknown(flat(nodes[:, 1:])), self.unknown(flat(controls))
            self.parts.append((shares, first, x, w))
            self.vanish(first - ends[-1]) if ends else ends.append(first)
            ends.append(x[:, -1])
            d, n = DEGREE, w.shape[0]
            widths = duration * ca.DM(shares).T
            states = [ca.horzcat(first, x[:, d - 1:-1:d]), *(x[:, j::d] for j in range(d))]
            rates = ca.vertcat(x[n:, :], w)
            for j in range(d):
                slope = sum(DERIVATIVE[r, j] * states[r] for r in range(d + 1))
                self.vanish(ca.vec(slope - ca.repmat(widths, x.shape[0], 1) * rates[:, j::d]))
            running, kept = function.map(x.shape[1])(x, w)
            self.keep(ca.vec(kept), numpy.tile(most, x.shape[1]))
            cost += duration * ca.dot(ca.kron(ca.DM(shares), ca.DM(WEIGHTS)), ca.vec(running))
        n = self.parts[0][3].shape[0]
        for row in problem.conditions([State(*ca.vertsplit(end, n)) for end in ends]):
            self.vanish(row)
        for k, free in enumerate(problem.free):
            if not free:
                self.vanish(sum(durations[: k + 1]) - problem.times[k])
        self.scale = 1.0 if math.isnan(start.cost) else SIZE / start.cost
        self.cost = self.scale * (cost + problem.second * sum(durations))
        self.durations = ca.vertcat(*durations)

    def unknown(self, value, low=-math.inf):
        value = numpy.asarray(value, dtype=float)
        symbol = ca.MX.sym("x", *value.shape)
        self.unknowns.append(ca.vec(symbol))
        self.x0.append(value.ravel(order="F"))
        self.low.append(numpy.full(value.size, low))
        return symbol

    def vanish(self, row):
        self.keep(row, numpy.zeros(row.numel()))

    def keep(self, rows, most):
        self.rows.append(rows)
        self.limits.append(most)

    def solve(self, name):
        options = {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.mu_strategy": "adaptive",
                   "ipopt.tol": 1e-10, "ipopt.bound_relax_factor": 0.0, "ipopt.max_iter": 1000}
        x, most = ca.vertcat(*self.unknowns), numpy.concatenate(self.limits)
        solver = ca.nlpsol("solver", "ipopt", {"x": x, "f": self.cost, "g": ca.vertcat(*self.rows)}, options)
        found = solver(x0=numpy.concatenate(self.x0), lbx=numpy.concatenate(self.low), lbg=-most, ubg=most)
        if not solver.stats()["success"]:
            stop(f"{name}: IPOPT says {solver.stats()['return_status']}")
        outputs = [self.durations, *(part for _, *parts in self.parts for part in parts)]
        durations, *values = map(numpy.array, ca.Function("values", [x], outputs)(found["x"]))
        pieces = []
        for (shares, *_), first, states, controls in zip(self.parts, values[::3], values[1::3], values[2::3]):
            states, controls = (rows.T.reshape(len(shares), DEGREE, -1) for rows in (states, controls))
            left = numpy.concatenate([first.T, states[:-1, -1]])
            pieces.append((shares, numpy.concatenate([left[:, None], states], axis=1), controls))
        return Found(float(found["f"]) / self.scale, numpy.cumsum(durations), pieces)


def solve(name, problem):
    """Until the cost has settled: the last motion, with the relative change of its cost by the last round."""
    found = Program(problem, guess(problem)).solve(name)
    for _ in range(ROUNDS):
        before = found.cost
        found = Program(problem, split(found)).solve(name)
        found.change = abs(found.cost / before - 1)
        if found.change <= SETTLED:
            break
    return found
