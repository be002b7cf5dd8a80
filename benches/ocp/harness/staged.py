"""Direct collocation in stages, for FATROP: states q and v at the nodes, accelerations at Radau's points as controls.

A stage is an interval. Its unknowns are x = (q, v), or (q, v, T) in a free time, and the accelerations at its three points; the
last stage is x alone. Rows of a stage: x_{k+1} - F(x_k, u_k) = 0, linear in a given time; then, point by point, torques that
have limits, clearances, and q, v and a where these have limits. Torques are no unknowns: they stand in cost and inequalities
only. Start and end are bounds of x. stage.py has the functions of a stage.

The unit of time of v and a is the mean interval of the first guess: in seconds the q of a fine mesh hardly depend on a, and
FATROP's pivots cannot tell them from zero."""

import numpy

import radau
import shapes
import stage
from motion import Accelerated
from staged_program import StagedProgram


class Staged:
    PROGRAM = StagedProgram

    def __init__(self, task, points, mesh):
        self.task, self.n, self.mesh = task, task.n, numpy.asarray(mesh)
        self.elements = len(mesh) - 1
        self.limited = {name: numpy.flatnonzero(numpy.isfinite(low) | numpy.isfinite(high)).tolist()
                        for name, (low, high) in self.limits().items()}
        self.functions = stage.functions(task, points, self.limited)
        # States and controls of a stage, and unknowns of it.
        self.states, self.controls = 2 * self.n + task.free, radau.DEGREE * self.n
        self.stage = self.states + self.controls
        self.size = self.stage * self.elements + self.states
        self.clearances = points.rows - self.n
        # Rows of a point, and of a stage without and with the next state.
        self.rows_point = self.clearances + sum(map(len, self.limited.values()))
        self.paths = radau.DEGREE * self.rows_point
        self.rows_stage = self.states + self.paths
        self.rows, self.end_rows = self.rows_stage * self.elements, task.end_rows
        # First unknown of each state, as a column.
        self.first = self.stage * numpy.arange(self.elements + 1)[:, None]
        # Unit of time (s), and those of q, v and a.
        self.unit = task.duration / self.elements
        self.units = dict(zip("qvau", (1.0, self.unit, self.unit**2, 1 / task.torque_size)))
        self.scale = numpy.ones(points.rows)
        self.scale[: self.n] = self.units["u"]
        # The first guess is given at the points and then at the nodes.
        self.times = numpy.append((self.mesh[:-1, None] + numpy.diff(self.mesh)[:, None] * radau.POINTS).ravel(), self.mesh)

    def limits(self):
        task = self.task
        return {"u": (task.u_min, task.u_max), "q": (task.q_min, task.q_max), "v": (-task.v_max, task.v_max),
                "a": (-task.a_max, task.a_max)}

    def structure(self):
        """States, controls and rows besides the dynamics of every stage, the last one among them."""
        k = self.elements
        return {"N": k, "nx": [self.states] * (k + 1), "nu": [self.controls] * k + [0],
                "ng": [self.paths] * k + [self.end_rows]}

    def first_guess(self):
        """The cubic from start to end."""
        task = self.task
        motion = shapes.motion(shapes.cubic, task.q_start, task.q_last, task.duration, self.times)
        return self.guess((task.duration, *motion, None))

    def guess(self, motion):
        duration, q, v, a, _ = motion
        points = radau.DEGREE * self.elements
        x = numpy.zeros(self.size)
        x[self.first + numpy.arange(2 * self.n)] = numpy.hstack([q[points:], self.units["v"] * v[points:]])
        controls = self.units["a"] * a[:points].reshape(self.elements, -1)
        x[self.first[:-1] + self.states + numpy.arange(self.controls)] = controls
        if self.task.free:
            x[self.first + 2 * self.n] = duration
        return x

    def bounds(self):
        task, n = self.task, self.n
        lower, upper = numpy.full(self.size, -numpy.inf), numpy.full(self.size, numpy.inf)
        last = self.size - self.states
        for first, q, v in ((0, task.q_start, task.v_start), (last, task.q_end, task.v_end)):
            for place, value in ((first, q), (first + n, self.units["v"] * v)):
                if value is not None:
                    lower[place: place + n] = upper[place: place + n] = value
        if task.free:
            lower[2 * n], upper[2 * n] = 0.05 * task.duration, 20 * task.duration
        return lower, upper

    def row_bounds(self):
        low, high = (numpy.concatenate([numpy.append((given[side] * self.units[name])[self.limited[name]],
                                                     [clear] * self.clearances if name == "u" else [])
                                        for name, given in self.limits().items()])
                     for side, clear in ((0, 0.0), (1, numpy.inf)))
        found = [numpy.append(numpy.zeros(self.states), numpy.tile(part, radau.DEGREE)) for part in (low, high)]
        end = numpy.zeros(self.end_rows)
        return tuple(numpy.append(numpy.tile(part, self.elements), end) for part in found)

    def motion(self, x, torques):
        """q, v and the accelerations of every interval, with inverse dynamics along the polynomials through these."""
        n, k = self.n, self.elements
        states = x[self.first[:-1] + numpy.arange(2 * n)]
        a = x[self.first[:-1] + self.states + numpy.arange(self.controls)].reshape(k, radau.DEGREE, n) / self.units["a"]
        return Accelerated(self.mesh * self.duration(x), states[:, :n], states[:, n:] / self.units["v"], a, torques)

    def duration(self, x):
        return x[2 * self.n] if self.task.free else self.task.duration
