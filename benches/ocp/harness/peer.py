"""The peer: direct collocation with CasADi's derivatives, solved by IPOPT with MUMPS."""

import resource
import time
from dataclasses import dataclass

import casadi as ca
import numpy

import points
import radau
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
    "ipopt.tol": 1e-8,
    # Limits are kept, not widened by 1e-8.
    "ipopt.bound_relax_factor": 0.0,
    "ipopt.max_iter": 1000,
}
SOLVED = ("Solve_Succeeded", "Solved_To_Acceptable_Level")


@dataclass
class Answer:
    """What either side found: the state and the torques of its own interpolation at any time."""
    solver: str
    status: str
    solved: bool
    cost: float
    duration: float
    iterations: int
    # Seconds on one core: of the solver alone, and of its process with start and set-up.
    seconds: float
    process_seconds: float
    # Times where pieces of the interpolation meet, states there, and functions of the time.
    knots: numpy.ndarray = None
    states: numpy.ndarray = None
    torque: object = None
    state: object = None
    raw: object = None


class Peer:
    """Solvers of tasks; compiled functions are kept, a robot's model is built once."""

    def __init__(self, cache, interpreted=False, limit=60.0):
        self.cache, self.interpreted, self.limit = cache, interpreted, limit
        self._points = {}

    def points(self, task):
        key = task.robot.name, len(task.obstacles)
        if key not in self._points:
            self._points[key] = points.build(self.cache, task.robot, len(task.obstacles), self.interpreted)
        return self._points[key]

    def torques(self, task, q, v, a):
        """Inverse dynamics, a row for each time."""
        z = numpy.vstack([q.T, v.T, a.T])
        value = self.points(task).value
        return numpy.array(value.map(z.shape[1])(z, numpy.tile(numpy.array(task.obstacles_flat)[:, None], z.shape[1])))[: task.n].T

    def solve(self, task, elements, start=None, mesh=None, **options):
        before = process_seconds()
        mesh = numpy.linspace(0, 1, elements + 1) if mesh is None else mesh
        program = Transcription(task, self.points(task), mesh)
        nlp, derivatives = program.functions()
        settings = {**OPTIONS, "ipopt.max_cpu_time": self.limit, **derivatives, **options}
        solver = ca.nlpsol("solver", "ipopt", nlp, settings)
        if start is None:
            end = task.q_end if task.q_end is not None else task.q_guess
            q, v, a = shapes.motion(shapes.cubic, task.q_start, end, task.duration, program.times)
            start = task.duration, q, v, a, self.torques(task, q, v, a)
        else:
            start = start.raw.at(program.times)
        lower, upper = program.bounds()
        row_lower, row_upper = program.row_bounds()
        arguments = dict(x0=program.guess(start), lbx=lower, ubx=upper, lbg=row_lower, ubg=row_upper, p=numpy.zeros((0, 1)))
        begin = time.process_time()
        try:
            found = solver(**arguments)
        except RuntimeError as error:
            return Answer("peer", f"stopped: {str(error).splitlines()[-1][:80]}", False, numpy.nan, numpy.nan, 0,
                          time.process_time() - begin, process_seconds() - before)
        seconds = time.process_time() - begin
        status = solver.stats()
        solution = Solution(program, numpy.array(found["x"]).ravel())
        return Answer("peer", status["return_status"], status["return_status"] in SOLVED, float(found["f"]), solution.duration,
                      status["iter_count"], seconds, process_seconds() - before, solution.knots, solution.states,
                      solution.torque, solution.state, solution)


class Solution:
    """The polynomials of a solved program."""

    def __init__(self, program, x):
        task = program.task
        self.program, self.duration = program, x[-1] if task.free else task.duration
        self.q, self.v, self.a, self.u = (x[program.columns(what)] for what in "qvau")
        self.u = self.u * task.torque_size
        self.knots = program.mesh * self.duration
        first = numpy.concatenate([task.q_start, task.v_start])
        points = numpy.hstack([self.q, self.v])
        self.states = numpy.vstack([first, points[program.d - 1:: program.d]])

    def _place(self, t):
        mesh = self.program.mesh
        s = min(max(t / self.duration, 0.0), 1.0)
        element = min(max(numpy.searchsorted(mesh, s, side="right") - 1, 0), len(mesh) - 2)
        return element, (s - mesh[element]) / (mesh[element + 1] - mesh[element])

    def torque(self, t, element=None):
        place, x = self._place(t) if element is None else (element, self._share(t, element))
        d = self.program.d
        return sum(polynomial(x) * self.u[place * d + j] for j, polynomial in enumerate(radau.CONTROL))

    def _share(self, t, element):
        mesh = self.program.mesh
        return (t / self.duration - mesh[element]) / (mesh[element + 1] - mesh[element])

    def state(self, t):
        element, x = self._place(t)
        d = self.program.d
        nodes = numpy.vstack([self.states[element][None], numpy.hstack([self.q, self.v])[element * d: (element + 1) * d]])
        return sum(polynomial(x) * node for polynomial, node in zip(radau.STATE, nodes))

    def at(self, times):
        """(T, q, v, a, u) at times in parts of T, for a start on another mesh."""
        n = self.program.n
        state = numpy.array([self.state(s * self.duration) for s in times])
        torque = numpy.array([self.torque(s * self.duration) for s in times])
        after = self.program.times
        a = numpy.array([[numpy.interp(s, after, self.a[:, i]) for i in range(n)] for s in times])
        return self.duration, state[:, :n], state[:, n:], a, torque


def process_seconds():
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime
