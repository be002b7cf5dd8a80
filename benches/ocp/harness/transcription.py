"""Direct collocation of a task as a nonlinear program: its unknowns, equations and bounds.

Unknowns, point by point: q, v, a, u/s, s the size of a torque; and T at the end if it is free. Equations of each point:

    sum_r C_rj q_r = T h v_j,   sum_r C_rj v_r = T h a_j,   tau(q_j, v_j, a_j)/s = u_j/s,   clearances(q_j) >= 0

C differentiates the polynomials of an element at its points, h is its share of the time. Limits of q, v, a and u are bounds
of the unknowns. program.py makes the functions and their derivatives."""

import numpy

import radau


class Transcription:
    def __init__(self, task, points, mesh):
        self.task, self.points = task, points
        self.n, self.d, self.mesh = task.n, radau.DEGREE, numpy.asarray(mesh)
        self.elements = len(mesh) - 1
        self.count = self.elements * self.d
        # Of each point: share of the time of its element, weight of the quadrature, time in parts of T.
        self.h = numpy.repeat(numpy.diff(self.mesh), self.d)
        self.w = numpy.tile(radau.WEIGHTS, self.elements)
        self.times = (self.mesh[:-1, None] + numpy.diff(self.mesh)[:, None] * radau.POINTS).ravel()
        self.size = 4 * self.n * self.count + task.free
        # Rows of a point: q' = v, v' = a, torques and clearances; those of all points in this order, then the end.
        self.rows_point = 2 * self.n + points.rows
        self.rows = self.rows_point * self.count
        self.end_rows = task.end_rows
        # First unknown and first row of each point, as a column.
        self.first_unknown = 4 * self.n * numpy.arange(self.count)[:, None]
        self.first_row = self.rows_point * numpy.arange(self.count)[:, None]
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
        for what, value in (("q", task.q_end), ("v", task.v_end)):
            if value is not None:
                last = self.columns(what)[-1]
                lower[last] = upper[last] = value
        if task.free:
            lower[-1], upper[-1] = 0.05 * task.duration, 20 * task.duration
        return lower, upper

    def row_bounds(self):
        """Equations are zero, clearances are not negative."""
        upper = numpy.zeros((self.count, self.rows_point))
        upper[:, 3 * self.n:] = numpy.inf
        upper = numpy.append(upper.ravel(), numpy.zeros(self.end_rows))
        return numpy.zeros(len(upper)), upper

    def differences(self):
        """Rows, columns and entries of C in all equations, the given start apart."""
        rows, columns, entries = [], [], []
        state = numpy.arange(2 * self.n)
        for point in range(self.count):
            j, before = point % self.d, point - point % self.d - 1
            for r in range(self.d + 1):
                if before + r >= 0:
                    rows.append(self.first_row[point] + state)
                    columns.append(self.first_unknown[before + r] + state)
                    entries.append(numpy.full(2 * self.n, radau.DERIVATIVE[r, j]))
        return tuple(numpy.concatenate(parts) for parts in (rows, columns, entries))

    def start_terms(self):
        """What the given start adds to the equations of the first element: 2n numbers a point."""
        found = numpy.zeros((self.count, 2 * self.n))
        found[: self.d] = radau.DERIVATIVE[0][:, None] * numpy.concatenate([self.task.q_start, self.task.v_start])
        return found
