"""The functions of staged.py with exact derivatives, put together from those of the stages: a dense block each."""

import casadi as ca
import numpy

import radau
from program import EndConditions, Entries, Functions


class StagedProgram(Functions):
    def __init__(self, transcription):
        self.of = t = transcription
        task, k = t.task, t.elements
        self.x, self.p = ca.MX.sym("x", t.size), ca.MX.sym("p", 0)
        inner, self.last = self.x[: t.stage * k], self.x[t.stage * k:]
        self.w = ca.reshape(inner, t.stage, k)
        self.after = self.after_states()
        time = self.w[2 * t.n, :] if task.free else ca.DM([[task.duration] * k])
        across = lambda column: ca.repmat(ca.DM(column), 1, k)
        effort = numpy.outer(task.effort, radau.WEIGHTS)
        self.duration = self.x[2 * t.n] if task.free else task.duration
        self.end = EndConditions(task)
        self.arguments = [self.w, time, ca.DM(numpy.diff(t.mesh) / t.unit).T, across(effort * t.unit), across(t.scale),
                          across(task.obstacles_flat), across(t.unit)]
        # The first guess costs 1, so that tolerances are relative.
        self.cost_factor = 1 / (float(ca.Function("cost", [self.x], [self.cost()])(t.first_guess())) or 1.0)
        self.arguments[3] *= self.cost_factor

    def after_states(self):
        """x_1, ..., x_N."""
        columns = (self.of.first[1:] + numpy.arange(self.of.states)).ravel()
        return ca.reshape(self.x[columns.tolist()], self.of.states, self.of.elements)

    def of_stages(self, name, *more):
        function = self.of.functions[name].map(self.of.elements)
        return function(*self.arguments, *more)

    def cost(self):
        task = self.of.task
        spent = ca.sum2(self.of_stages("cost")) if task.effort.any() else 0
        return self.cost_factor * task.time_weight * self.duration + spent

    def gradient(self):
        t = self.of
        inner = ca.vec(self.of_stages("gradient")) if t.task.effort.any() else ca.DM.zeros(t.stage * t.elements)
        found = ca.vertcat(inner, ca.DM.zeros(t.states))
        if not t.task.free:
            return found
        return found + self.cost_factor * t.task.time_weight * ca.DM.triplet([2 * t.n], [0], [1.0], t.size, 1)

    def equations(self):
        t = self.of
        rows = self.of_stages("rows")
        found = ca.vertcat(self.after - rows[: t.states, :], rows[t.states:, :])
        return ca.vertcat(ca.vec(found), self.end.value(self.last[: t.n]))

    def jacobian(self):
        t = self.of
        found = Entries(t.rows + t.end_rows, t.size)
        rows, columns = numpy.indices((t.rows_stage, t.stage)).reshape(2, -1, order="F")
        sign = numpy.where(numpy.arange(t.rows_stage) < t.states, -1.0, 1.0)
        stage = numpy.arange(t.elements)[:, None]
        values = ca.reshape(self.of_stages("jacobian_of_rows"), t.rows_stage, t.stage * t.elements)
        found.put(t.rows_stage * stage + rows, t.stage * stage + columns,
                  ca.vec(values * ca.DM(numpy.tile(sign[:, None], (1, t.stage * t.elements)))))
        state = numpy.arange(t.states)
        found.put(t.rows_stage * stage + state, t.first[1:] + state, ca.DM.ones(t.states * t.elements))
        rows, columns = numpy.indices((t.end_rows, t.n)).reshape(2, -1, order="F")
        found.put(t.rows + rows, t.first[-1] + columns, ca.vec(self.end.jacobian(self.last[: t.n])))
        return found.matrix()

    def hessian(self, weight, weights):
        """Upper triangle of the second derivatives of weight cost + weights.equations."""
        return ca.triu(self.whole_hessian(weight, weights))

    def whole_hessian(self, weight, weights):
        """The same with both triangles."""
        t = self.of
        found = Entries(t.size, t.size)
        rows, columns = numpy.indices((t.stage, t.stage)).reshape(2, -1, order="F")
        first = t.first[:-1]
        values = self.of_stages("second", ca.repmat(weight, 1, t.elements), *self.multipliers(weights))
        found.put(first + rows, first + columns, ca.vec(values))
        if t.end_rows:
            rows, columns = numpy.indices((t.n, t.n)).reshape(2, -1, order="F")
            values = self.end.hessian(self.last[: t.n], weights[t.rows:])
            found.put(t.first[-1] + rows, t.first[-1] + columns, ca.vec(values))
        return found.matrix()

    def multipliers(self, weights):
        """Those of the rows of torques and clearances, and by z, at every point; zero where there is no row."""
        t, n, d = self.of, self.of.n, radau.DEGREE
        none = t.rows + t.end_rows
        limited = [*t.limited["u"], *range(n, n + t.clearances)]
        kept = [order * n + joint for order, name in enumerate("qva") for joint in t.limited[name]]
        lam = numpy.full((t.elements, d, n + t.clearances), none)
        nu = numpy.full((2, t.elements, d, 3 * n), none)
        row = t.rows_stage * numpy.arange(t.elements)[:, None]
        path = (row + t.states)[:, :, None] + t.rows_point * numpy.arange(d)[:, None]
        lam[:, :, limited] = path + numpy.arange(len(limited))
        nu[0][:, :, kept] = path + len(limited) + numpy.arange(len(kept))
        # q and v of the last point are those of the next state, which stand there with the other sign.
        nu[1][:, -1, : 2 * n] = row + numpy.arange(2 * n)
        padded = ca.vertcat(weights, 0)
        given = lambda places: padded[places.ravel().tolist()]
        return (ca.reshape(given(lam), n + t.clearances, d * t.elements),
                ca.reshape(given(nu[0]) - given(nu[1]), 3 * n, d * t.elements))
