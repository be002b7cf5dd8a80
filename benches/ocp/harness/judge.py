"""What an answer is worth: its torques are integrated again, its limits looked at, its cost computed anew.

Both sides are judged by the same integrator (DOP853 of scipy) with the same dynamics, M(q) a = u - h(q, v)."""

from dataclasses import dataclass

import casadi as ca
import numpy
from scipy.integrate import solve_ivp

import obstacles
from model import Model

# Relative and absolute tolerance of the integrator.
RELATIVE, ABSOLUTE = 1e-9, 1e-11
# The motion is integrated from the answer's own state at the start of each of this many parts, and once through.
PARTS = 20
# Torques of a controller are held for so long (s), or a little less, with so many steps of Runge and Kutta's method of order 4.
HOLD, STEPS = 1e-3, 2
# Places of a piece at which limits are looked at, ends included.
LOOKS = 17
# Gauss points of the cost on each piece.
NODES, WEIGHTS = numpy.polynomial.legendre.leggauss(5)

# An answer counts as a solution if its solver says so and
#   the largest gap of the parts, in parts of the largest size of the component, is below this: generous, because torques of
#   1e-4 N m turn the wrist of a UR5 without rotors by radians; the tables tell the gap,
GAP = 1.0
#   and no limit is violated by more than this share of its range at the solver's points. Between them violations are told:
#   torques of a polynomial collocation at a jump exceed their bounds by construction.
AT_POINTS = 1e-5


@dataclass
class Judgement:
    cost: float
    gap: float
    cut: float
    end: float
    held: float
    at_points: float
    between: float
    # Of `between` what is not torques.
    states: float

    def accepted(self):
        return self.gap <= GAP and self.at_points <= AT_POINTS


class Judge:
    def __init__(self, peer):
        self.peer = peer
        self._clearances = {}

    def judge(self, task, motion):
        if motion is None or not numpy.isfinite(motion.duration):
            return None
        parts = self.parts(task, motion)
        gap, end = self.integrate(task, motion, *parts)
        at_points, between = self.violations(task, motion)
        limited = numpy.isfinite([task.u_min, task.u_max]).any()
        cut = self.gap(task, motion, *parts) if limited else gap
        return Judgement(cost(task, motion), gap, cut, end, self.held(task, motion, *parts), max(at_points), max(between),
                         between[0])

    def parts(self, task, motion):
        """Times of the parts' ends, the states at their starts and those to be reached, and the sizes of components."""
        n, times = task.n, numpy.linspace(0, motion.duration, PARTS + 1)
        states = numpy.array([motion.at(t)[0] for t in times])
        size = numpy.maximum(abs(states[:, :n]).max(0), 0.1), numpy.maximum(abs(states[:, n:]).max(0), 1e-3)
        size = numpy.concatenate(size)
        # The last point is what was asked for.
        wanted = states[1:].copy()
        if task.q_end is not None:
            wanted[-1] = numpy.concatenate([task.q_end, task.v_end])
        states[0] = numpy.concatenate([task.q_start, task.v_start])
        return times, states[:-1], wanted, size

    def integrate(self, task, motion, times, states, wanted, size):
        """Largest gap of the parts, and the miss at the end of a motion integrated once through, both relative to sizes."""
        gap, through = 0.0, states[0]
        for i in range(PARTS):
            reached = self.step(task, motion, states[i], times[i], times[i + 1])
            gap = max(gap, (abs(reached - wanted[i]) / size).max()) if reached is not None else numpy.inf
            if through is not None:
                through = reached if i == 0 else self.step(task, motion, through, times[i], times[i + 1])
        return gap, numpy.inf if through is None else (abs(through - wanted[-1]) / size).max()

    def gap(self, task, motion, times, states, wanted, size):
        """Largest gap of the parts with torques cut to their limits."""
        reached = [self.step(task, motion, states[i], times[i], times[i + 1], (task.u_min, task.u_max)) for i in range(PARTS)]
        return max(numpy.inf if state is None else (abs(state - wanted[i]) / size).max() for i, state in enumerate(reached))

    def held(self, task, motion, times, states, wanted, size):
        """Largest miss of the parts with torques as a controller sends them: those in the middle of each millisecond, cut to
        their limits and held."""
        n, count = task.n, int(numpy.ceil(times[1] / HOLD - 1e-9))
        hold = times[1] / count
        middles = times[:-1, None] + hold * (0.5 + numpy.arange(count))
        torques = numpy.array([[motion.torque(t, motion.piece(t)) for t in row] for row in middles])
        torques = numpy.clip(torques, task.u_min, task.u_max)
        rate = lambda x, u: numpy.hstack([x[:, n:], self.peer.accelerations(task, x[:, :n], x[:, n:], u)])
        # All parts at once.
        x, h = states, hold / STEPS
        for k in range(count * STEPS):
            u = torques[:, k // STEPS]
            k1 = rate(x, u)
            k2 = rate(x + h / 2 * k1, u)
            k3 = rate(x + h / 2 * k2, u)
            x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(x + h * k3, u))
        return (abs(x - wanted) / size).max()

    def step(self, task, motion, state, begin, end, limits=(-numpy.inf, numpy.inf)):
        """From `begin` to `end` with torques cut to `limits`, stopping where pieces meet; None where the integration does
        not arrive."""
        n = task.n
        inner = motion.knots[(motion.knots > begin + 1e-12) & (motion.knots < end - 1e-12)]
        stops = numpy.concatenate([[begin], inner, [end]])
        for first, last in zip(stops[:-1], stops[1:]):
            piece = motion.piece((first + last) / 2)

            def rate(t, x, piece=piece):
                u = numpy.clip(motion.torque(t, piece), *limits)
                return numpy.concatenate([x[n:], self.peer.accelerations(task, x[None, :n], x[None, n:], u[None])[0]])

            found = solve_ivp(rate, (first, last), state, "DOP853", rtol=RELATIVE, atol=ABSOLUTE, first_step=last - first)
            if not found.success or not numpy.isfinite(found.y[:, -1]).all():
                return None
            state = found.y[:, -1]
        return state

    def violations(self, task, motion):
        """Largest violations of a limit at the solver's points and between them, in parts of the range of the limit: of
        positions, rates and clearances, and of torques."""
        pieces = numpy.repeat(numpy.arange(len(motion.knots) - 1), LOOKS)
        grid = numpy.concatenate([numpy.linspace(a, b, LOOKS) for a, b in zip(motion.knots[:-1], motion.knots[1:])])
        state, torque = (numpy.array(part) for part in zip(*(motion.at(t, piece) for t, piece in zip(grid, pieces))))
        return self.violation(task, *motion.given), self.violation(task, state[:, :task.n], state[:, task.n:], torque)

    def violation(self, task, q, v, u):
        worst = []
        for values, low, high in ((q, task.q_min, task.q_max), (v, -task.v_max, task.v_max), (u, task.u_min, task.u_max)):
            spread = high - low
            spread = numpy.where(numpy.isfinite(spread), spread, 1.0)
            worst.append(max(0.0, ((low - values) / spread).max(), ((values - high) / spread).max()))
        states, torques = max(worst[:2]), worst[2]
        if task.obstacles:
            clearance = numpy.array(self.clearances(task).map(len(q))(q.T, numpy.tile(
                numpy.array(task.obstacles_flat)[:, None], len(q))))
            states = max(states, -clearance.min() / (task.obstacles[0][1] + task.own_radius))
        return states, torques

    def clearances(self, task):
        key = task.robot.name, len(task.obstacles)
        if key not in self._clearances:
            q, par = ca.SX.sym("q", task.n), ca.SX.sym("par", 4 * len(task.obstacles))
            value = obstacles.clearances(Model(task.robot), q, par, len(task.obstacles))
            self._clearances[key] = ca.Function("clearances", [q, par], [ca.densify(value)])
        return self._clearances[key]


def cost(task, motion):
    total = task.time_weight * motion.duration
    for piece, (first, last) in enumerate(zip(motion.knots[:-1], motion.knots[1:])):
        half = (last - first) / 2
        for x, weight in zip(NODES, WEIGHTS):
            u = motion.torque(first + half * (1 + x), piece)
            total += weight * half * float(task.effort @ u**2) / 2
    return total
