"""Direct collocation of a task as a nonlinear program, with its derivatives put together from those of the points.

Unknowns, point by point: q, v, a, u/s, s the size of a torque; and T at the end if it is free. Equations of each point:

    sum_r C_rj q_r = T h v_j,   sum_r C_rj v_r = T h a_j,   tau(q_j, v_j, a_j)/s = u_j/s,   clearances(q_j) >= 0

C differentiates the polynomials of an element at its points, h its share of the time. T stands beside v and a only, so the exact
Hessian is a block for each point and what T adds to it. Limits of q, v, a and u are bounds of the unknowns."""

import casadi as ca
import numpy

import radau


class Transcription:
    def __init__(self, task, points, mesh):
        self.task, self.points = task, points
        self.n, self.d, self.mesh = task.n, radau.DEGREE, numpy.asarray(mesh)
        self.elements = len(mesh) - 1
        self.count = self.elements * self.d
        self.h = numpy.repeat(numpy.diff(self.mesh), self.d)
        self.w = numpy.tile(radau.WEIGHTS, self.elements)
        self.times = (self.mesh[:-1, None] + numpy.diff(self.mesh)[:, None] * radau.POINTS).ravel()
        self.size = 4 * self.n * self.count + task.free
        # Rows of a point: q' = v, v' = a, torques and clearances; those of all points in this order, then the end.
        self.rows_point = 2 * self.n + points.rows
        self.rows = self.rows_point * self.count
        self._point_columns = 4 * self.n * numpy.arange(self.count)
        self._point_rows = self.rows_point * numpy.arange(self.count)
        self.scale = numpy.ones(points.rows)
        self.scale[: self.n] = 1 / task.torque_size

    # Unknowns.

    def columns(self, what):
        """Indices of q, v, a or u, a row for each point."""
        offset = "qvau".index(what) * self.n
        return self._point_columns[:, None] + offset + numpy.arange(self.n)

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
        for what, low, high in (("q", task.q_min, task.q_max), ("v", -task.v_max, task.v_max), ("a", -task.a_max, task.a_max),
                                ("u", task.u_min / task.torque_size, task.u_max / task.torque_size)):
            lower[self.columns(what)], upper[self.columns(what)] = low, high
        end_v = self.columns("v")[-1]
        lower[end_v] = upper[end_v] = task.v_end
        if task.q_end is not None:
            end_q = self.columns("q")[-1]
            lower[end_q] = upper[end_q] = task.q_end
        if task.free:
            lower[-1], upper[-1] = 0.05 * task.duration, 20 * task.duration
        return lower, upper

    def row_bounds(self):
        lower = numpy.zeros((self.count, self.rows_point))
        upper = numpy.zeros((self.count, self.rows_point))
        upper[:, 3 * self.n:] = numpy.inf
        end = numpy.zeros(self.task.end_rows)
        return numpy.append(lower.ravel(), end), numpy.append(upper.ravel(), end)

    # Functions.

    def functions(self):
        """The program and its derivatives: f, g; gradient; Jacobian; upper triangle of the Hessian of lam_f f + lam_g.g."""
        task, n, k = self.task, self.n, self.count
        x, p = ca.MX.sym("x", self.size), ca.MX.sym("p", 0)
        weights = ca.MX.sym("lam_g", self.rows + task.end_rows)
        weight = ca.MX.sym("lam_f")
        duration = x[-1] if task.free else ca.MX(task.duration)
        blocks = ca.reshape(x[: 4 * n * k], 4 * n, k)
        z, u, par = blocks[: 3 * n, :], blocks[3 * n:, :], ca.repmat(ca.DM(task.obstacles_flat), 1, k)
        q_end = blocks[:n, -1]

        # Cost.
        effort = ca.DM(task.effort * task.torque_size**2)
        hw = ca.DM(self.h * self.w).T
        running = ca.sum1(u * u * ca.repmat(effort, 1, k)) / 2 @ hw.T
        f = task.time_weight * duration + duration * running
        in_u = ca.repmat(effort, 1, k) * u * ca.repmat(hw, n, 1) * duration
        gradient = ca.vec(ca.vertcat(ca.MX(3 * n, k), in_u))
        if task.free:
            gradient = ca.vertcat(ca.densify(gradient), task.time_weight + running)

        # Equations.
        differences = self._differences()
        start = self._start()
        rates = ca.vec(blocks[n: 3 * n, :] * ca.repmat(ca.DM(self.h).T, 2 * n, 1))
        collocation = ca.reshape(differences @ x[: 4 * n * k] + start - duration * rates, 2 * n, k)
        values = self.points.value.map(k)(z, par) * ca.repmat(ca.DM(self.scale), 1, k)
        torques = values[:n, :] - u
        g = ca.vec(ca.vertcat(collocation, torques, values[n:, :]))
        end, end_jacobian, end_hessian = self._end()
        g = ca.vertcat(g, end(q_end))

        # Jacobian: constants, v and a beside T, u, the points' blocks, the end.
        rows, columns, entries = [], [], []

        def put(row, column, value):
            rows.append(numpy.ravel(row)), columns.append(numpy.ravel(column)), entries.append(value)

        put(*self._differences_at, ca.DM(self._differences_entries))
        rate_rows = self._point_rows[:, None] + numpy.arange(2 * n)
        rate_columns = self._point_columns[:, None] + n + numpy.arange(2 * n)
        put(rate_rows[:, :n], rate_columns[:, :n], -duration * ca.DM(numpy.repeat(self.h, n)))
        put(rate_rows[:, n:], rate_columns[:, n:], -duration * ca.DM(numpy.repeat(self.h, n)))
        if task.free:
            put(rate_rows, numpy.full(rate_rows.shape, self.size - 1), -rates)
        u_rows = self._point_rows[:, None] + 2 * n + numpy.arange(n)
        put(u_rows, self.columns("u"), -ca.DM.ones(n * k))
        at_row, at_column = (numpy.array(at) for at in self.points.jacobian_at)
        jacobian = self.points.jacobian.map(k)(z, par) * ca.repmat(ca.DM(self.scale[at_row]), 1, k)
        put(self._point_rows[:, None] + 2 * n + at_row, self._point_columns[:, None] + at_column, ca.vec(jacobian))
        at_row, at_column = (numpy.array(at, dtype=int) for at in end_jacobian.sparsity_out(0).get_triplet())
        put(self.rows + at_row, self._point_columns[-1] + at_column, ca.vertcat(*_nonzeros(end_jacobian(q_end))))
        jacobian = sparse(self.rows + task.end_rows, self.size, rows, columns, entries)

        # Hessian, lower triangle, then transposed.
        rows, columns, entries = [], [], []
        lam = ca.reshape(weights[: self.rows], self.rows_point, k)
        at_row, at_column = (numpy.array(at) for at in self.points.hessian_at)
        block = self.points.hessian.map(k)(z, par, lam[2 * n:, :] * ca.repmat(ca.DM(self.scale), 1, k))
        put(self._point_columns[:, None] + at_row, self._point_columns[:, None] + at_column, ca.vec(block))
        put(self.columns("u"), self.columns("u"), weight * duration * ca.vec(ca.repmat(effort, 1, k) * ca.repmat(hw, n, 1)))
        if task.free:
            last = numpy.full(k * n, self.size - 1)
            put(last, self.columns("u"), weight * ca.vec(ca.repmat(effort, 1, k) * u * ca.repmat(hw, n, 1)))
            put(numpy.full(2 * n * k, self.size - 1), rate_columns,
                -ca.vec(lam[: 2 * n, :] * ca.repmat(ca.DM(self.h).T, 2 * n, 1)))
        at_row, at_column = (numpy.array(at, dtype=int) for at in end_hessian.sparsity_out(0).get_triplet())
        keep = at_row >= at_column
        in_end = end_hessian(q_end, weights[self.rows:])
        hessian = sparse(self.size, self.size, rows, columns, entries)
        if task.end_rows:
            last_q = sparse(self.size, self.size, [self._point_columns[-1] + at_row[keep]],
                            [self._point_columns[-1] + at_column[keep]],
                            [ca.vertcat(*[value for value, kept in zip(_nonzeros(in_end), keep) if kept])])
            hessian = hessian + last_q
        return {"x": x, "f": f, "g": g}, {
            "grad_f": ca.Function("nlp_grad_f", [x, p], [f, ca.densify(gradient)]),
            "jac_g": ca.Function("nlp_jac_g", [x, p], [g, jacobian]),
            "hess_lag": ca.Function("nlp_hess_l", [x, p, weight, weights], [hessian.T]),
        }

    def _differences(self):
        """C of all elements and both of q' and v', the given start apart: a constant matrix."""
        n, d = self.n, self.d
        rows, columns, entries = [], [], []
        for element in range(self.elements):
            for j in range(d):
                row = self._point_rows[element * d + j]
                own = 2 * n * (element * d + j)
                for r in range(d + 1):
                    point = element * d + r - 1
                    if point < 0:
                        continue
                    column = self._point_columns[point]
                    for i in range(2 * n):
                        rows.append((own + i, row + i)), columns.append(column + i)
                        entries.append(radau.DERIVATIVE[r, j])
        rows = numpy.array(rows)
        self._differences_at, self._differences_entries = (rows[:, 1], numpy.array(columns)), numpy.array(entries)
        return ca.DM.triplet(rows[:, 0].tolist(), list(map(int, columns)), ca.DM(entries), 2 * n * self.count, 4 * n * self.count)

    def _start(self):
        """What the given start adds to the equations of the first element."""
        state = numpy.concatenate([self.task.q_start, self.task.v_start])
        found = numpy.zeros((self.count, 2 * self.n))
        found[: self.d] = radau.DERIVATIVE[0][:, None] * state
        return ca.DM(found.ravel())

    def _end(self):
        """Conditions on q at the end, their Jacobian and contracted Hessian."""
        q = ca.SX.sym("q", self.n)
        lam = ca.SX.sym("lam", self.task.end_rows)
        value = self.task.end_conditions(q)
        return (ca.Function("end", [q], [ca.densify(value)], {"cse": True}),
                ca.Function("end_jacobian", [q], [ca.jacobian(value, q)], {"cse": True}),
                ca.Function("end_hessian", [q, lam], [ca.hessian(ca.dot(value, lam), q)[0]], {"cse": True}))


def _nonzeros(matrix):
    return [matrix.nz[i] for i in range(matrix.nnz())]


def sparse(height, width, rows, columns, entries):
    """A matrix of entries at places that all differ."""
    rows, columns = (numpy.concatenate(parts).astype(int).tolist() for parts in (rows, columns))
    values = ca.densify(ca.vertcat(*[ca.MX(part) for part in entries]))
    pattern, order = ca.Sparsity.triplet(height, width, rows, columns, False)
    return ca.MX(pattern, values.nz[list(order)])
