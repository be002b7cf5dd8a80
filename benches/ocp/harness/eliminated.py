"""costate's transcription with few unknowns, as another nonlinear program for IPOPT; quartics.py has the same with many.

On each interval q is a polynomial of degree four, the cubic with q and q' of both ends and a bubble b h^2 x^2 (1 - x)^2/2;
q and v are continuous at the nodes, accelerations may jump there. Unknowns: q and r at every node but the first, b of every interval,
u/s at Gauss's three points, s the size of a torque, and T if it is free; r = v T/T_0 with the guess T_0, so r = v in a given
time. Motions begin and end at rest. At the points, and for limits at the nodes,

    q = P_q x + e_q,   v = c (P_v x + e_v),   a = c^2 (P_a x + e_a),   c = T_0/T

Equations: tau(q_j, v_j, a_j)/s = u_j/s and clearances(q_j) >= 0 at the points. Limits of u, and of what is an unknown itself,
are bounds of unknowns; those of q, v and a at points, and of v at nodes in a free time, are rows."""

import casadi as ca
import numpy

from motion import Quartic
from eliminated_program import EliminatedProgram

PLACES, WEIGHTS = Quartic.PLACES[1:4], numpy.array([5, 8, 5]) / 18
# Of q, r at the left end, q, r at the right end, b, and the powers of the width h that stand beside them.
SHAPES = [numpy.poly1d(powers) for powers in ([2, -3, 0, 1], [1, -2, 1, 0], [-2, 3, 0, 0], [1, -1, 0, 0], [0.5, -1, 0.5, 0, 0])]
UNITS = (0, 1, 0, 1, 2)


class Eliminated:
    PROGRAM = EliminatedProgram

    def __init__(self, task, points, mesh):
        self.task, self.points, self.n = task, points, task.n
        self.mesh = numpy.asarray(mesh)
        n, k = self.n, len(mesh) - 1
        self.elements, self.count = k, 3 * k
        # Of each interval its part of T_0 (s); of each point its weight and its time, then those of the nodes, in parts of T.
        self.widths = numpy.diff(self.mesh) * task.duration
        self.w = (numpy.diff(self.mesh)[:, None] * WEIGHTS).ravel()
        self.times = numpy.append((self.mesh[:-1, None] + numpy.diff(self.mesh)[:, None] * PLACES).ravel(), self.mesh[1:])
        # Unknowns: q and r at the nodes, b, u/s at the points.
        self.nodes = numpy.arange(2 * n * k).reshape(k, 2 * n)
        self.bubbles = 2 * n * k + numpy.arange(n * k).reshape(k, n)
        self.efforts = 3 * n * k + numpy.arange(n * self.count).reshape(self.count, n)
        self.size = 6 * n * k + task.free
        self.scale = numpy.ones(points.rows)
        self.scale[:n] = 1 / task.torque_size
        # P and e of q, r and the second derivative at every point.
        self.matrix, self.known = self.at_points()
        self.powers = numpy.repeat([0, 1, 2], n)
        self.limited()
        self.end_rows = task.end_rows
        self.rows = points.rows * self.count + len(self.kept_powers)

    def at_points(self):
        n, rows, columns, entries = self.n, [], [], []
        known = numpy.zeros(3 * n * self.count)
        start = numpy.concatenate([self.task.q_start, self.task.v_start])
        for k, h in enumerate(self.widths):
            ends = [self.nodes[k - 1] if k else None, self.nodes[k]]
            for j, place in enumerate(PLACES):
                for order in range(3):
                    row = 3 * n * (3 * k + j) + n * order + numpy.arange(n)
                    for c, shape in enumerate(SHAPES):
                        value = (shape.deriv(order) if order else shape)(place) * h ** (UNITS[c] - order)
                        part = slice(n, None) if c in (1, 3) else slice(n)
                        if c < 2 and not k:
                            known[row] += value * start[part]
                            continue
                        rows.append(row)
                        columns.append(self.bubbles[k] if c == 4 else ends[c // 2][part])
                        entries.append(numpy.full(n, value))
        rows, columns = (numpy.concatenate(part).tolist() for part in (rows, columns))
        matrix = ca.DM.triplet(rows, columns, ca.DM(numpy.concatenate(entries)), len(known), self.size)
        return matrix, known

    def limited(self):
        """Rows for limits that are no bounds: K and what is added, powers of c, least and largest values."""
        task, n, none = self.task, self.n, ca.DM(0, self.size)
        parts, known, powers, low, high = [none], [], [], [], []
        for order, lower, upper in ((0, task.q_min, task.q_max), (1, -task.v_max, task.v_max), (2, -task.a_max, task.a_max)):
            joints = numpy.flatnonzero(numpy.isfinite(lower) | numpy.isfinite(upper))
            rows = (3 * n * numpy.arange(self.count)[:, None] + n * order + joints).ravel()
            parts.append(self.matrix[rows.tolist(), :] if len(rows) else none)
            known.append(self.known[rows])
            if order == 1 and task.free and len(joints):
                columns = (self.nodes[:-1, n:][:, joints]).ravel()
                parts.append(ca.DM.triplet(list(range(len(columns))), columns.tolist(), ca.DM.ones(len(columns)),
                                           len(columns), self.size))
                known.append(numpy.zeros(len(columns)))
                rows = numpy.append(rows, columns)
            powers.append(numpy.full(len(rows), order))
            times = len(rows) // len(joints) if len(joints) else 0
            low.append(numpy.tile(lower[joints], times))
            high.append(numpy.tile(upper[joints], times))
        self.kept = ca.vertcat(*parts)
        self.kept_known, self.kept_powers, self.kept_low, self.kept_high = map(numpy.concatenate, (known, powers, low, high))

    def guess(self, motion):
        """Unknowns of (T, q, v, a, u) at the points and then at the nodes."""
        duration, q, v, _, u = motion
        x = numpy.zeros(self.size)
        r = v * duration / self.task.duration
        x[self.nodes] = numpy.hstack([q[self.count:], r[self.count:]])
        x[self.efforts] = u[: self.count] / self.task.torque_size
        # The middle of the cubics without bubbles.
        x[self.bubbles] = 32 / self.widths[:, None]**2 * (q[1: self.count: 3] - self.values(x, 0.5)[0])
        if self.task.free:
            x[-1] = duration
        return x

    def bounds(self):
        task, n = self.task, self.n
        lower, upper = numpy.full(self.size, -numpy.inf), numpy.full(self.size, numpy.inf)
        lower[self.efforts], upper[self.efforts] = task.u_min / task.torque_size, task.u_max / task.torque_size
        lower[self.nodes[:, :n]], upper[self.nodes[:, :n]] = task.q_min, task.q_max
        if not task.free:
            lower[self.nodes[:, n:]], upper[self.nodes[:, n:]] = -task.v_max, task.v_max
        for columns, value in ((self.nodes[-1, :n], task.q_end), (self.nodes[-1, n:], task.v_end)):
            if value is not None:
                lower[columns] = upper[columns] = value
        if task.free:
            lower[-1], upper[-1] = 0.05 * task.duration, 20 * task.duration
        return lower, upper

    def row_bounds(self):
        upper = numpy.zeros((self.count, self.points.rows))
        upper[:, self.n:] = numpy.inf
        zeros = numpy.zeros(self.end_rows)
        return (numpy.concatenate([numpy.zeros(upper.size), self.kept_low, zeros]),
                numpy.concatenate([upper.ravel(), self.kept_high, zeros]))

    def values(self, x, place):
        """q and r of all intervals at a place in [0, 1], from the unknowns."""
        n, h = self.n, self.widths[:, None]
        nodes = numpy.vstack([numpy.append(self.task.q_start, self.task.v_start), x[self.nodes]])
        q, r = nodes[:, :n], nodes[:, n:]
        parts = (q[:-1], h * r[:-1], q[1:], h * r[1:], h**2 * x[self.bubbles])
        return (sum(shape(place) * part for shape, part in zip(SHAPES, parts)),
                sum(shape.deriv()(place) * part for shape, part in zip(SHAPES, parts)) / h)

    def motion(self, x, torques):
        """As costate gives its own: five rows an interval."""
        duration = x[-1] if self.task.free else self.task.duration
        times = duration * (self.mesh[:-1, None] + numpy.diff(self.mesh)[:, None] * Quartic.PLACES)
        q, r = (numpy.stack(part, axis=1).reshape(-1, self.n)
                for part in zip(*(self.values(x, place) for place in Quartic.PLACES)))
        return Quartic(times.ravel(), q, r * self.task.duration / duration, torques)
