"""The functions of eliminated.py with exact derivatives, put together from those of the points.

z^ = P x + e stands for z = (q, v, a) = (z^_q, c z^_v, c^2 z^_a) of all points; with m the power of c, dz/dT = -m z/T and
d2z/dT2 = m (m + 1) z/T^2. First and second derivatives by z are multiplied by powers of c, so they are those by z^."""

import casadi as ca
import numpy

from program import EndConditions, Entries, Functions


class EliminatedProgram(Functions):
    def __init__(self, transcription):
        self.of = t = transcription
        task, n, m = t.task, t.n, t.count
        self.x, self.p = ca.MX.sym("x", t.size), ca.MX.sym("p", 0)
        self.duration = self.x[-1] if task.free else ca.MX(task.duration)
        c = task.duration / self.duration
        self.c = ca.vertcat(1, c, c**2, c**3, c**4)
        self.inner = t.matrix @ self.x + ca.DM(t.known)
        self.z = ca.reshape(self.inner * self.power(numpy.tile(t.powers, m)), 3 * n, m)
        self.kept = (t.kept @ self.x + ca.DM(t.kept_known)) * self.power(t.kept_powers)
        self.u, self.q_end = self.x[t.efforts.ravel().tolist()], self.x[t.nodes[-1, :n].tolist()]
        self.par = ca.repmat(ca.DM(task.obstacles_flat), 1, m)
        self.scale = ca.repmat(ca.DM(t.scale), 1, m)
        self.effort = ca.DM((t.w[:, None] * task.effort * task.torque_size**2).ravel())
        self.end = EndConditions(task)

    def power(self, powers):
        """c to these powers, a column."""
        return self.c[numpy.asarray(powers).tolist()] if self.of.task.free else ca.DM.ones(len(powers))

    def by_time(self, powers):
        """-m/T."""
        return -ca.DM(numpy.asarray(powers, dtype=float)) / self.duration

    def twice_by_time(self, powers):
        """m (m + 1)/T^2."""
        powers = numpy.asarray(powers, dtype=float)
        return ca.DM(powers * (powers + 1)) / self.duration**2

    def gradient(self):
        t = self.of
        parts = [ca.MX.zeros(t.efforts[0, 0]), self.effort * self.u * self.duration]
        return ca.vertcat(*parts, *([t.task.time_weight + self.running()] if t.task.free else []))

    def equations(self):
        t = self.of
        values = t.points.value.map(t.count)(self.z, self.par) * self.scale
        values = ca.vertcat(values[: t.n, :] - ca.reshape(self.u, t.n, t.count), values[t.n:, :])
        return ca.vertcat(ca.vec(values), self.kept, self.end.value(self.q_end))

    def by_inner(self):
        """Jacobian of torques and clearances of all points by z^."""
        t = self.of
        rows, columns = (numpy.array(part) for part in t.points.jacobian_at)
        factors = ca.DM(t.scale[rows]) * self.power(t.powers[columns])
        values = t.points.jacobian.map(t.count)(self.z, self.par) * ca.repmat(factors, 1, t.count)
        found = Entries(t.points.rows * t.count, 3 * t.n * t.count)
        point = numpy.arange(t.count)[:, None]
        found.put(t.points.rows * point + rows, 3 * t.n * point + columns, ca.vec(values))
        return found.matrix()

    def jacobian(self):
        t = self.of
        of_points, count = self.by_inner(), t.points.rows * t.count
        height, last = t.rows + t.end_rows, t.size - 1
        both = ca.vertcat(of_points @ t.matrix, ca.diag(self.power(t.kept_powers)) @ t.kept,
                          ca.MX(t.end_rows, t.size))
        own = Entries(height, t.size)
        rows = t.points.rows * numpy.arange(t.count)[:, None] + numpy.arange(t.n)
        own.put(rows, t.efforts, -ca.DM.ones(t.efforts.size))
        rows, columns = numpy.indices((t.end_rows, t.n)).reshape(2, -1, order="F")
        own.put(t.rows + rows, t.nodes[-1, columns], ca.vec(self.end.jacobian(self.q_end)))
        if t.task.free:
            own.put(numpy.arange(count), last, of_points @ (self.by_time(numpy.tile(t.powers, t.count)) * self.inner))
            moving = numpy.flatnonzero(t.kept_powers)
            own.put(count + moving, last, (self.by_time(t.kept_powers) * self.kept)[moving.tolist()])
        return both + own.matrix()

    def twice_by_inner(self, lam):
        """The symmetric second derivatives of lam.(torques, clearances) of all points by z^."""
        t = self.of
        rows, columns = (numpy.array(part) for part in t.points.hessian_at)
        values = t.points.hessian.map(t.count)(self.z, self.par, ca.reshape(lam, t.points.rows, t.count) * self.scale)
        values *= ca.repmat(self.power(t.powers[rows] + t.powers[columns]), 1, t.count)
        point = 3 * t.n * numpy.arange(t.count)[:, None]
        found = Entries(3 * t.n * t.count, 3 * t.n * t.count)
        found.put(point + rows, point + columns, ca.vec(values))
        inside = numpy.flatnonzero(rows != columns)
        found.put(point + columns[inside], point + rows[inside], ca.vec(values[inside.tolist(), :]))
        return found.matrix()

    def hessian(self, weight, weights):
        """Upper triangle of the second derivatives of weight cost + weights.equations."""
        t = self.of
        count, last = t.points.rows * t.count, t.size - 1
        lam, kept = weights[:count], weights[count: t.rows]
        inner = self.twice_by_inner(lam)
        own = Entries(t.size, t.size)
        own.put(t.efforts, t.efforts, weight * self.duration * self.effort)
        if t.task.free:
            powers = numpy.tile(t.powers, t.count)
            change, first = self.by_time(powers) * self.inner, self.by_inner().T @ lam
            column = t.matrix.T @ (inner @ change + self.by_time(powers) * first)
            column += t.kept.T @ (self.by_time(t.kept_powers) * self.power(t.kept_powers) * kept)
            states = numpy.arange(t.efforts[0, 0])
            own.put(states, last, column[states.tolist()])
            own.put(t.efforts, last, weight * self.effort * self.u)
            own.put(last, last, ca.dot(change, inner @ change) + ca.dot(self.twice_by_time(powers) * self.inner, first)
                    + ca.dot(self.twice_by_time(t.kept_powers) * self.kept, kept))
        found = ca.triu(t.matrix.T @ inner @ t.matrix) + own.matrix()
        if not t.end_rows:
            return found
        rows, columns = numpy.triu_indices(t.n)
        values = ca.vec(self.end.hessian(self.q_end, weights[t.rows:])).nz[(rows + t.n * columns).tolist()]
        end = Entries(t.size, t.size)
        end.put(t.nodes[-1, rows], t.nodes[-1, columns], values)
        return found + end.matrix()
