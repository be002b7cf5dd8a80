"""A peer: a transcription of the task with exact derivatives, and the solver of nonlinear programs that it is given to."""

import resource
import time
from dataclasses import dataclass

import casadi as ca
import numpy

import points
import shapes
from solvers import Ipopt
from transcription import Transcription

@dataclass
class Answer:
    """What either side found."""
    solver: str
    status: str
    solved: bool
    cost: float
    duration: float
    iterations: int
    # Seconds on one core: of the solver alone, and of its process with start and set-up.
    seconds: float
    process_seconds: float
    motion: object = None


class Peer:
    """Solvers of tasks; compiled functions are kept, a robot's model is built once."""

    def __init__(self, build, solver=None, transcription=Transcription):
        """`build` makes the points of a robot with so many spheres in its way."""
        self.build, self.solver, self.transcription = build, solver or Ipopt(), transcription
        self._points, self._forward = {}, {}

    def points(self, robot, spheres):
        key = robot.name, spheres
        if key not in self._points:
            self._points[key] = self.build(robot, spheres)
        return self._points[key]

    def points_of(self, task):
        return self.points(task.robot, len(task.obstacles))

    def prepare(self, task):
        """Compiles what the task needs."""
        self.transcription(task, self.points_of(task), numpy.array([0.0, 1.0]))

    def torques(self, task, q, v, a):
        """Inverse dynamics, a row for each time."""
        if len(q) == 1:
            value = self.points_of(task).value(numpy.concatenate([q[0], v[0], a[0]]), task.obstacles_flat)
            return value.full()[: task.n].T
        z = numpy.vstack([q.T, v.T, a.T])
        par = numpy.tile(numpy.array(task.obstacles_flat)[:, None], z.shape[1])
        return numpy.array(self.points_of(task).value.map(z.shape[1])(z, par))[: task.n].T

    def accelerations(self, task, q, v, u):
        """Forward dynamics M a = u - h with M and h of the model, a row for each time."""
        if task.robot.name not in self._forward:
            self._forward[task.robot.name] = points.forward(self.points(task.robot, 0), task.n)
        n = task.n
        if len(q) == 1:
            bias, m = self._forward[task.robot.name](q[0], v[0])
            return numpy.linalg.solve(numpy.array(m), u[0] - numpy.array(bias).ravel())[None]
        bias, m = self._forward[task.robot.name].map(len(q))(q.T, v.T)
        m = numpy.array(m).T.reshape(-1, n, n)
        return numpy.linalg.solve(m, (u - numpy.array(bias).T)[:, :, None])[:, :, 0]

    def cheapest(self, task, elements, starts, seed=0):
        """The cheapest of several solutions: from the straight line, and from lines bent at random by about a radian."""
        rng = numpy.random.default_rng(seed)
        found = [self.solve(task, elements, bend=rng.uniform(-1, 1, task.n) * (i > 0)) for i in range(starts)]
        return min(found, key=lambda answer: (not answer.solved, answer.cost))

    def resampled(self, task, motion, times):
        """(T, q, v, a, u) at times in parts of T, for a start on another mesh."""
        state, u = (numpy.array(part) for part in zip(*(motion.at(s * motion.duration) for s in times)))
        q, v = state[:, : task.n], state[:, task.n:]
        return motion.duration, q, v, self.accelerations(task, q, v, u), u

    def solve(self, task, elements, start=None, mesh=None, bend=0.0, times=1, **options):
        """Called so many times, unless that takes long; the least time counts, with set-up that of the first call."""
        before = process_seconds()
        mesh = numpy.linspace(0, 1, elements + 1) if mesh is None else mesh
        unknowns = self.transcription(task, self.points_of(task), mesh)
        program = unknowns.PROGRAM(unknowns)
        solver = ca.nlpsol("solver", self.solver.NAME, program.nlp(), {**self.solver.settings(program), **options})
        if start is None:
            q, v, a = shapes.motion(shapes.cubic, task.q_start, task.q_last, task.duration, unknowns.times)
            q, v, a = (part + more for part, more in zip((q, v, a), shapes.bump(bend, task.duration, unknowns.times)))
            start = task.duration, q, v, a, self.torques(task, q, v, a)
        else:
            start = self.resampled(task, start, unknowns.times)
        lower, upper = unknowns.bounds()
        row_lower, row_upper = unknowns.row_bounds()
        arguments = dict(x0=unknowns.guess(start), lbx=lower, ubx=upper, lbg=row_lower, ubg=row_upper, p=numpy.zeros((0, 1)))
        seconds, whole = numpy.inf, None
        for _ in range(times):
            begin = time.process_time()
            try:
                found = solver(**arguments)
            except RuntimeError as error:
                return Answer("peer", f"stopped: {str(error).splitlines()[-1][:80]}", False, numpy.nan, numpy.nan, 0,
                              time.process_time() - begin, process_seconds() - before)
            seconds = min(seconds, time.process_time() - begin)
            whole = whole or process_seconds() - before
        stats = solver.stats()
        motion = unknowns.motion(numpy.array(found["x"]).ravel(), lambda *z: self.torques(task, *z))
        status, solved = self.solver.status(stats)
        return Answer("peer", status, solved, float(found["f"]) / program.cost_factor, motion.duration, stats["iter_count"], seconds,
                      whole, motion)


def process_seconds():
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime
