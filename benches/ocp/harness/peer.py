"""The peer: direct collocation with CasADi's derivatives, solved by IPOPT with MUMPS."""

import resource
import time
from dataclasses import dataclass

import casadi as ca
import numpy

import points
import shapes
from transcription import Transcription

OPTIONS = {
    "print_time": False,
    # Not needed, and not to be had of compiled functions.
    "no_nlp_grad": True,
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "ipopt.linear_solver": "mumps",
    "ipopt.mu_strategy": "adaptive",
    # Limits are kept, not widened by 1e-8.
    "ipopt.bound_relax_factor": 0.0,
    "ipopt.max_iter": 1000,
}
# Of IPOPT by default; with which costs come out about as near to the best ones as costate's at its first tolerance; and the
# number of that tolerance itself.
TIGHT, MIDDLE, LOOSE = 1e-8, 1e-6, 1e-4
SOLVED = ("Solve_Succeeded", "Solved_To_Acceptable_Level")


def tolerances(tolerance):
    """Options of IPOPT. What it accepts after 15 iterations without progress is 1e-6 with the tight tolerance, its default, and
    no looser than the tolerance with others."""
    if tolerance == TIGHT:
        return {"ipopt.tol": tolerance}
    keys = ("tol", "constr_viol_tol", "compl_inf_tol", "acceptable_tol", "acceptable_constr_viol_tol",
            "acceptable_compl_inf_tol")
    return {f"ipopt.{key}": tolerance for key in keys}


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

    def __init__(self, build, limit=60.0, tolerance=TIGHT, transcription=Transcription):
        """`build` makes the points of a robot with so many spheres in its way."""
        self.build, self.limit, self.tolerances, self.transcription = build, limit, tolerances(tolerance), transcription
        self._points, self._forward = {}, {}

    def points(self, robot, spheres):
        key = robot.name, spheres
        if key not in self._points:
            self._points[key] = self.build(robot, spheres)
        return self._points[key]

    def points_of(self, task):
        return self.points(task.robot, len(task.obstacles))

    def torques(self, task, q, v, a):
        """Inverse dynamics, a row for each time."""
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
        settings = {**OPTIONS, **self.tolerances, "ipopt.max_cpu_time": self.limit, **program.derivatives(), **options}
        solver = ca.nlpsol("solver", "ipopt", program.nlp(), settings)
        if start is None:
            end = task.q_end if task.q_end is not None else task.q_guess
            q, v, a = shapes.motion(shapes.cubic, task.q_start, end, task.duration, unknowns.times)
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
        status = solver.stats()
        motion = unknowns.motion(numpy.array(found["x"]).ravel(), lambda *z: self.torques(task, *z))
        return Answer("peer", status["return_status"], status["return_status"] in SOLVED, float(found["f"]), motion.duration,
                      status["iter_count"], seconds, whole, motion)


def process_seconds():
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime
