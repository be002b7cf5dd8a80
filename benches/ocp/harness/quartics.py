"""costate's transcription as another nonlinear program for IPOPT.

On each interval q is a polynomial of degree four; q and v are continuous at the nodes, accelerations may jump there. Limits
hold at Gauss's three points, those of q and v at the nodes too. Unknowns: those of the points as in transcription.py, then q
and v at every node but the first, and T. With x_0 = 0 the left node of an interval and x_1, x_2, x_3 its points, v is the cubic
through its values at these four places, and the equations are, h being the share of the time,

    q_j - q_0 = T h sum_r I_rj v_r,   sum_r C_rj v_r = T h a_j   at a point,
    q_4 - q_0 = T h sum_r I_r4 v_r,   v_4 = sum_r L_r v_r        at the right node, x_4 = 1,

I integrates Lagrange's polynomials from 0 to these places, C differentiates them, L are their values at 1."""

import numpy

import radau
from motion import Quartic
from transcription import Transcription

PLACES = Quartic.PLACES[1:4]
BASIS = radau.basis(Quartic.PLACES[:4])
# Row r, column j: of the polynomial of place r its integral from 0 to place j + 1, its derivative at point j + 1, its end.
INTEGRAL = numpy.array([polynomial.integ()(Quartic.PLACES[1:]) for polynomial in BASIS])
DERIVATIVE = numpy.array([polynomial.deriv()(PLACES) for polynomial in BASIS])
END = numpy.array([polynomial(1.0) for polynomial in BASIS])


class Quartics(Transcription):
    PLACES, WEIGHTS = PLACES, numpy.array([5, 8, 5]) / 18

    def __init__(self, task, points, mesh):
        super().__init__(task, points, mesh)
        n, k = self.n, self.elements
        # q and v at the end of each interval, as rows of unknowns.
        self.nodes = 4 * n * self.count + numpy.arange(2 * n * k).reshape(k, 2 * n)
        self.times = numpy.append(self.times, self.mesh[1:])
        self.size += 2 * n * k
        self.rows += 2 * n * k
        self.linear_rows += 2 * n * k
        self.end = self.nodes[-1].reshape(2, n)

    def guess(self, motion):
        duration, *values = motion
        x = super().guess((duration, *(value[: self.count] for value in values)))
        x[self.nodes] = numpy.hstack([value[self.count:] for value in values[:2]])
        return x

    def bounds(self):
        lower, upper = super().bounds()
        lower[self.nodes] = numpy.append(self.task.q_min, -self.task.v_max)
        upper[self.nodes] = numpy.append(self.task.q_max, self.task.v_max)
        self.hold_end(lower, upper)
        return lower, upper

    def row_bounds(self):
        lower, upper = super().row_bounds()
        at = self.rows_point * self.count
        return numpy.zeros(len(lower) + self.nodes.size), numpy.insert(upper, at, numpy.zeros(self.nodes.size))

    def places(self, k):
        """Of an interval: unknowns of q and of v at its left end, its points and its right end; none at the start."""
        n, d = self.n, self.d
        first = self.nodes[k - 1] if k else None
        points = [self.first_unknown[d * k + j, 0] + numpy.arange(2 * n) for j in range(d)]
        return [first, *points, self.nodes[k]]

    def terms(self):
        """What stands in E and in R: (matrix, rows, unknowns or value at the start, entry)."""
        n, d, widths = self.n, self.d, numpy.diff(self.mesh)
        start = self.task.q_start, self.task.v_start
        for k in range(self.elements):
            places = self.places(k)
            at = [(place[:n], place[n:]) if place is not None else start for place in places]
            known = [place is None for place in places]
            for j in range(d + 1):
                # The rows of q and of v.
                first = 2 * n * (d * k + j) if j < d else 2 * n * (self.count + k)
                rows_q = first + numpy.arange(n)
                rows_v = rows_q + n
                yield "E", rows_q, at[j + 1][0], 1.0, False
                yield "E", rows_q, at[0][0], -1.0, known[0]
                for r in range(d + 1):
                    yield "R", rows_q, at[r][1], widths[k] * INTEGRAL[r, j], known[r]
                    entry = DERIVATIVE[r, j] if j < d else -END[r]
                    yield "E", rows_v, at[r][1], entry, known[r]
                if j < d:
                    yield "R", rows_v, self.columns("a")[d * k + j], widths[k], False
                else:
                    yield "E", rows_v, at[j + 1][1], 1.0, False

    def triplets(self, matrix):
        kept = [(rows, columns, numpy.full(len(rows), entry)) for name, rows, columns, entry, known in self.terms()
                if name == matrix and not known]
        return tuple(numpy.concatenate(parts) for parts in zip(*kept))

    def differences(self):
        return self.triplets("E")

    def rates(self):
        return self.triplets("R")

    def start_terms(self):
        found = {"E": numpy.zeros(self.linear_rows), "R": numpy.zeros(self.linear_rows)}
        for name, rows, values, entry, known in self.terms():
            if known:
                found[name][rows] += entry * values
        return found["E"], found["R"]

    def motion(self, x, torques):
        """The quartics through q and v at the nodes and q in the middle of the intervals: what IPOPT leaves of the equations
        does not make them jump."""
        task, n, duration = self.task, self.n, self.duration(x)
        h = duration * numpy.diff(self.mesh)[:, None]
        nodes = numpy.vstack([numpy.append(task.q_start, task.v_start), x[self.nodes]])
        q, v, middle = nodes[:, :n], nodes[:, n:], x[self.columns("q")[1::self.d]]
        q_0, q_1, v_0, v_1 = q[:-1], q[1:], h * v[:-1], h * v[1:]
        bubble = middle - (q_0 + q_1) / 2 - (v_0 - v_1) / 8
        rows_q, rows_v = [], []
        for s in Quartic.PLACES:
            rows_q.append(q_0 * (1 - 3 * s**2 + 2 * s**3) + v_0 * (s - 2 * s**2 + s**3) + q_1 * (3 * s**2 - 2 * s**3)
                          + v_1 * (s**3 - s**2) + 16 * bubble * s**2 * (1 - s)**2)
            rows_v.append((6 * (q_1 - q_0) * (s - s**2) + v_0 * (1 - 4 * s + 3 * s**2) + v_1 * (3 * s**2 - 2 * s)
                           + 32 * bubble * s * (1 - s) * (1 - 2 * s)) / h)
        times = duration * (self.mesh[:-1, None] + numpy.diff(self.mesh)[:, None] * Quartic.PLACES)
        flat = lambda rows: numpy.stack(rows, axis=1).reshape(-1, n)
        return Quartic(times.ravel(), flat(rows_q), flat(rows_v), torques)
