"""The functions of a transcription with exact derivatives, put together from those of the points.

T stands beside the rates and the cost only, so the Hessian is a block for each point and a border. CasADi sees each function as a
few operations on whole arrays; the mapped functions of the points do the work."""

import casadi as ca
import numpy


class Entries:
    """A sparse matrix as places and values; all places differ."""

    def __init__(self, height, width):
        self.shape, self.rows, self.columns, self.values = (height, width), [], [], []

    def put(self, rows, columns, values):
        rows, columns = numpy.broadcast_arrays(rows, columns)
        self.rows.append(rows.ravel())
        self.columns.append(columns.ravel())
        self.values.append(ca.densify(ca.MX(values)))

    def matrix(self):
        rows, columns = (numpy.concatenate(parts).astype(int).tolist() for parts in (self.rows, self.columns))
        pattern, order = ca.Sparsity.triplet(*self.shape, rows, columns, False)[:2]
        values, order = ca.vertcat(*self.values), list(order)
        return ca.MX(pattern, values if order == list(range(len(order))) else values.nz[order])


class Functions:
    """What solvers call, from the parts of a program: its cost, and equations, jacobian and hessian by their names."""

    # What the cost of the task is multiplied by.
    cost_factor = 1.0

    def nlp(self):
        return {"x": self.x, "f": self.cost(), "g": self.equations()}

    def derivatives(self):
        """What nlpsol takes in place of its own derivatives."""
        weights, weight = ca.MX.sym("lam_g", self.of.rows + self.of.end_rows), ca.MX.sym("lam_f")
        arguments = [self.x, self.p]
        return {
            "grad_f": ca.Function("nlp_grad_f", arguments, [self.cost(), self.gradient()]),
            "jac_g": ca.Function("nlp_jac_g", arguments, [self.equations(), self.jacobian()]),
            "hess_lag": ca.Function("nlp_hess_l", [*arguments, weight, weights], [self.hessian(weight, weights)]),
        }

    def running(self):
        """Integral of 1/2 sum effort u^2 over the time in parts of T."""
        return ca.dot(self.effort, self.u * self.u) / 2

    def cost(self):
        return self.of.task.time_weight * self.duration + self.duration * self.running()


class Program(Functions):
    """Symbols and the parts that several functions share."""

    def __init__(self, transcription):
        self.of = t = transcription
        task, n, k = t.task, t.n, t.count
        self.x, self.p = ca.MX.sym("x", t.size), ca.MX.sym("p", 0)
        self.duration = self.x[-1] if task.free else ca.MX(task.duration)
        blocks = ca.reshape(self.x[: 4 * n * k], 4 * n, k)
        self.z, self.u, self.q_end = blocks[: 3 * n, :], blocks[3 * n:, :], self.x[t.end[0].tolist()]
        # Equations without dynamics: places and entries of both matrices, both sums.
        self.differences, self.rates = t.differences(), t.rates()
        first, second = t.start_terms()
        self.change = self.matrix(self.differences) @ self.x + ca.DM(first)
        self.going = self.matrix(self.rates) @ self.x + ca.DM(second)
        # By points: constants of the obstacles, effort times weight of the quadrature.
        self.par = ca.repmat(ca.DM(task.obstacles_flat), 1, k)
        self.scale = ca.repmat(ca.DM(t.scale), 1, k)
        self.effort = ca.DM(numpy.outer(task.effort * task.torque_size**2, t.h * t.w))
        self.end = EndConditions(task)

    def gradient(self):
        t = self.of
        found = ca.densify(ca.vec(ca.vertcat(ca.MX(3 * t.n, t.count), self.effort * self.u * self.duration)))
        found = ca.vertcat(found, ca.MX.zeros(t.size - t.task.free - found.numel()))
        return ca.vertcat(found, t.task.time_weight + self.running()) if t.task.free else found

    def matrix(self, places):
        """Of triplets, over all unknowns."""
        rows, columns, entries = places
        return ca.DM.triplet(rows.tolist(), columns.tolist(), ca.DM(entries), self.of.linear_rows, self.of.size)

    def equations(self):
        t = self.of
        linear, points = self.change - self.duration * self.going, 2 * t.n * t.count
        values = t.points.value.map(t.count)(self.z, self.par) * self.scale
        of_points = ca.vertcat(ca.reshape(linear[:points], 2 * t.n, t.count), values[: t.n, :] - self.u, values[t.n:, :])
        return ca.vertcat(ca.vec(of_points), linear[points:], self.end.value(self.q_end))

    def jacobian(self):
        t = self.of
        found = Entries(t.rows + t.end_rows, t.size)
        rows, columns, entries = self.differences
        found.put(t.row(rows), columns, entries)
        rows, columns, entries = self.rates
        found.put(t.row(rows), columns, -self.duration * ca.DM(entries))
        if t.task.free:
            rows = numpy.unique(rows)
            found.put(t.row(rows), t.size - 1, -self.going[rows.tolist()])
        found.put(t.first_row + 2 * t.n + numpy.arange(t.n), t.columns("u"), -ca.DM.ones(t.n * t.count))
        rows, columns = (numpy.array(part) for part in t.points.jacobian_at)
        values = t.points.jacobian.map(t.count)(self.z, self.par) * ca.repmat(ca.DM(t.scale[rows]), 1, t.count)
        found.put(t.first_row + 2 * t.n + rows, t.first_unknown + columns, ca.vec(values))
        rows, columns = numpy.indices((t.end_rows, t.n)).reshape(2, -1, order="F")
        found.put(t.rows + rows, t.end[0][columns], ca.vec(self.end.jacobian(self.q_end)))
        return found.matrix()

    def hessian(self, weight, weights):
        """Upper triangle of the second derivatives of weight cost + weights.equations."""
        t = self.of
        lam = ca.reshape(weights[: t.rows_point * t.count], t.rows_point, t.count)
        found = Entries(t.size, t.size)
        rows, columns = (numpy.array(part) for part in t.points.hessian_at)
        values = t.points.hessian.map(t.count)(self.z, self.par, lam[2 * t.n:, :] * self.scale)
        # The points give the lower triangle.
        found.put(t.first_unknown + columns, t.first_unknown + rows, ca.vec(values))
        found.put(t.columns("u"), t.columns("u"), weight * self.duration * ca.vec(self.effort))
        if t.task.free:
            found.put(t.columns("u"), t.size - 1, weight * ca.vec(self.effort * self.u))
            linear = ca.vertcat(ca.vec(lam[: 2 * t.n, :]), weights[t.rows_point * t.count: t.rows])
            timed = numpy.unique(self.rates[1])
            found.put(timed, t.size - 1, -(self.matrix(self.rates).T @ linear)[timed.tolist()])
        if not t.end_rows:
            return found.matrix()
        rows, columns = numpy.triu_indices(t.n)
        values = self.end.hessian(self.q_end, weights[t.rows:])
        last = Entries(t.size, t.size)
        values = ca.vec(values).nz[(rows + t.n * columns).tolist()]
        last.put(t.end[0][rows], t.end[0][columns], values)
        return found.matrix() + last.matrix()


class EndConditions:
    """Conditions on q at the end, dense Jacobian and contracted Hessian."""

    def __init__(self, task):
        q, lam = ca.SX.sym("q", task.n), ca.SX.sym("lam", task.end_rows)
        value = task.end_conditions(q)
        options = {"cse": True}
        self.value = ca.Function("end", [q], [ca.densify(value)], options)
        self.jacobian = ca.Function("end_jacobian", [q], [ca.densify(ca.jacobian(value, q))], options)
        self.hessian = ca.Function("end_hessian", [q, lam], [ca.densify(ca.hessian(ca.dot(value, lam), q)[0])], options)
