"""Direct collocation of a task as a nonlinear program: its unknowns, equations and bounds.

Unknowns, point by point: q, v, a, u/s, s the size of a torque; and T at the end if it is free. Equations of each point:

    sum_r C_rj q_r = T h v_j,   sum_r C_rj v_r = T h a_j,   tau(q_j, v_j, a_j)/s = u_j/s,   clearances(q_j) >= 0

C differentiates the polynomials of an element at its points, h is its share of the time. Limits of q, v, a and u are bounds
of the unknowns. program.py makes the functions and their derivatives; it sees the equations without dynamics as

    E x + e - T (R x + r) = 0

with 2n rows a point, and those that a transcription adds after all points. quartics.py is another transcription."""

import numpy

import radau
from motion import Collocated
from program import Program


class Transcription:
    PROGRAM = Program
    # Points of an element, and their weights.
    PLACES, WEIGHTS = radau.POINTS, radau.WEIGHTS

    def __init__(self, task, points, mesh):
        self.task, self.points = task, points
        self.n, self.d, self.mesh = task.n, len(self.PLACES), numpy.asarray(mesh)
        self.elements = len(mesh) - 1
        self.count = self.elements * self.d
        # Of each point: share of the time of its element, weight of the quadrature, time in parts of T.
        self.h = numpy.repeat(numpy.diff(self.mesh), self.d)
        self.w = numpy.tile(self.WEIGHTS, self.elements)
        self.times = (self.mesh[:-1, None] + numpy.diff(self.mesh)[:, None] * self.PLACES).ravel()
        self.size = 4 * self.n * self.count + task.free
        # Rows of a point: q' = v, v' = a, torques and clearances; those of all points in this order, then the end.
        self.rows_point = 2 * self.n + points.rows
        self.rows = self.rows_point * self.count
        # Those without dynamics.
        self.linear_rows = 2 * self.n * self.count
        self.end_rows = task.end_rows
        # First unknown and first row of each point, as a column.
        self.first_unknown = 4 * self.n * numpy.arange(self.count)[:, None]
        self.first_row = self.rows_point * numpy.arange(self.count)[:, None]
        # Unknowns that are q and v at the end.
        self.end = (self.first_unknown[-1] + numpy.arange(2 * self.n)).reshape(2, self.n)
        # What the rows of torques and clearances are multiplied by.
        self.scale = numpy.ones(points.rows)
        self.scale[: self.n] = 1 / task.torque_size

    def columns(self, what):
        """Indices of q, v, a or u among the unknowns, a row for each point."""
        return self.first_unknown + "qvau".index(what) * self.n + numpy.arange(self.n)

    def guess(self, motion):
        """Unknowns of (T, q, v, a, u at the points)."""
        duration, *values = motion
        x = numpy.zeros(self.size)
        for what, value in zip("qvau", values):
            x[self.columns(what)] = value / self.task.torque_size if what == "u" else value
        if self.task.free:
            x[-1] = duration
        return x

    def bounds(self):
        task = self.task
        lower, upper = numpy.full(self.size, -numpy.inf), numpy.full(self.size, numpy.inf)
        size = task.torque_size
        for what, low, high in (("q", task.q_min, task.q_max), ("v", -task.v_max, task.v_max),
                                ("a", -task.a_max, task.a_max), ("u", task.u_min / size, task.u_max / size)):
            lower[self.columns(what)], upper[self.columns(what)] = low, high
        self.hold_end(lower, upper)
        if task.free:
            lower[-1], upper[-1] = 0.05 * task.duration, 20 * task.duration
        return lower, upper

    def hold_end(self, lower, upper):
        """What is given of q and v at the end."""
        for columns, value in zip(self.end, (self.task.q_end, self.task.v_end)):
            if value is not None:
                lower[columns] = upper[columns] = value

    def row_bounds(self):
        """Equations are zero, clearances are not negative."""
        upper = numpy.zeros((self.count, self.rows_point))
        upper[:, 3 * self.n:] = numpy.inf
        upper = numpy.append(upper.ravel(), numpy.zeros(self.end_rows))
        return numpy.zeros(len(upper)), upper

    def row(self, number):
        """Where a row of E and R stands among all."""
        points = 2 * self.n * self.count
        return numpy.where(number < points, self.rows_point * (number // (2 * self.n)) + number % (2 * self.n),
                           self.rows_point * self.count + number - points)

    def differences(self):
        """Rows, columns and entries of E, here C in all equations, the given start apart."""
        rows, columns, entries = [], [], []
        state = numpy.arange(2 * self.n)
        for point in range(self.count):
            j, before = point % self.d, point - point % self.d - 1
            for r in range(self.d + 1):
                if before + r >= 0:
                    rows.append(2 * self.n * point + state)
                    columns.append(self.first_unknown[before + r] + state)
                    entries.append(numpy.full(2 * self.n, radau.DERIVATIVE[r, j]))
        return tuple(numpy.concatenate(parts) for parts in (rows, columns, entries))

    def rates(self):
        """Rows, columns and entries of R."""
        both = numpy.arange(2 * self.n)
        columns = (self.first_unknown + self.n + both).ravel()
        return numpy.arange(len(columns)), columns, numpy.repeat(self.h, 2 * self.n)

    def start_terms(self):
        """e and r: what the given start adds."""
        found = numpy.zeros((self.count, 2 * self.n))
        found[: self.d] = radau.DERIVATIVE[0][:, None] * numpy.concatenate([self.task.q_start, self.task.v_start])
        return found.ravel(), numpy.zeros(found.size)

    def motion(self, x, _):
        """What the unknowns are, with torques of their own."""
        q, v, u = (x[self.columns(what)] for what in "qvu")
        start = numpy.concatenate([self.task.q_start, self.task.v_start])
        return Collocated(self.mesh, self.duration(x), start, q, v, u * self.task.torque_size)

    def duration(self, x):
        return x[-1] if self.task.free else self.task.duration
