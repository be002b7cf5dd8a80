"""Steps of walking robots in minimal coordinates by CasADi and IPOPT: direct collocation at three Gauss points of each interval.
walking.py and soles.py have the robots."""

import json
import subprocess
from dataclasses import dataclass

import casadi as ca
import numpy as np

from shell import stop

DEGREE = 3
PARTS = np.array(ca.collocation_points(DEGREE, "legendre"))
QUIET = {"print_time": False, "ipopt.print_level": 0, "ipopt.tol": 1e-10, "ipopt.max_iter": 3000, "ipopt.sb": "yes"}
# A mesh is fine enough when halves of its intervals change the cost by less, relative; with so many meshes at most.
SETTLED, MESHES = 1e-7, 12


@dataclass(frozen=True)
class Walker:
    """A robot whose foot that stands is ground. Positions q are as many numbers as it has ways to move then, `torques` of motors
    drive it. The landing is an impact of the robot in the air: rates `after`, an impulse `jump`.

    `point(q, v, a, u, length)` is what the equations of motion miss, and what is positive; `ends(length, (q_0, v_0), (q_T, v_T),
    after, jump)` is what is zero and what is positive at the ends. `guess(s, length)` has a row q for each part s of the step,
    `guess_after(length, time, rates)` is a guess of the rates after the landing."""
    name: str
    torques: int
    most: float
    lower: np.ndarray
    upper: np.ndarray
    rates_after: int
    impulses: int
    point: ca.Function
    ends: object
    guess: object
    guess_after: object


class Step:
    """The program of a step on a mesh, parts of the step from 0 to 1, or on so many equal intervals; x, p, f and g are CasADi's
    names. Length and duration are parameters."""

    def __init__(self, walker, mesh):
        self.walker, self.mesh = walker, np.linspace(0, 1, mesh + 1) if isinstance(mesh, int) else mesh
        parts = (self.mesh[:-1, None] + np.diff(self.mesh)[:, None] * PARTS).ravel()
        self.opti, n, count, nodes = ca.Opti(), len(walker.lower), len(parts), len(self.mesh)
        self.size = self.opti.parameter(2)
        self.at_nodes = [self.opti.variable(n, nodes) for _ in range(2)]
        self.at_points = [self.opti.variable(n, count) for _ in range(2)]
        self.torques = self.opti.variable(walker.torques, count)
        self.parts = self.mesh, parts
        self.transcribe(n, count)
        # Opti bakes a program when it has a solver.
        self.opti.solver("ipopt")
        self.nlp = {"x": self.opti.x, "p": self.opti.p, "f": self.opti.f, "g": self.opti.g}

    def transcribe(self, n, count):
        opti, walker, length, time = self.opti, self.walker, self.size[0], self.size[1]
        C, D, B = ca.collocation_coeff(list(PARTS))
        weights = ca.DM(np.kron(np.diff(self.mesh), np.array(B).ravel()))
        (q_n, v_n), (q_c, v_c), rates = self.at_nodes, self.at_points, []
        for k, part in enumerate(np.diff(self.mesh)):
            h, own = part * time, slice(DEGREE * k, DEGREE * (k + 1))
            Q, V = ca.horzcat(q_n[:, k], q_c[:, own]), ca.horzcat(v_n[:, k], v_c[:, own])
            opti.subject_to(ca.vec(Q @ C - h * v_c[:, own]) == 0)
            opti.subject_to(q_n[:, k + 1] == Q @ D)
            opti.subject_to(v_n[:, k + 1] == V @ D)
            rates.append(V @ C / h)
        equations, self.limits = walker.point.map(count)(q_c, v_c, ca.horzcat(*rates), self.torques,
                                                         ca.repmat(length, 1, count))
        opti.subject_to(ca.vec(equations) == 0)
        # Where their multipliers are.
        first = len(rates) * (DEGREE + 2) * n + equations.numel()
        self.rows = slice(first, first + self.limits.numel())
        opti.subject_to(ca.vec(self.limits) >= 0)
        opti.minimize(time / 2 * ca.dot(weights, ca.sum1(self.torques * self.torques).T))
        self.after, self.jump = opti.variable(walker.rates_after), opti.variable(walker.impulses)
        zero, positive = walker.ends(length, (q_n[:, 0], v_n[:, 0]), (q_n[:, -1], v_n[:, -1]), self.after, self.jump)
        for rows in zero:
            opti.subject_to(rows == 0)
        for rows in positive:
            opti.subject_to(rows >= 0)

    def columns(self, unknowns):
        """Their places among all unknowns."""
        return np.array(ca.jacobian(ca.vec(unknowns), self.opti.x).sparsity().get_triplet()[1])

    def arguments(self, length, time, start=None):
        """Of a solver: the first guess, bounds and parameters. `start(s)` has rows of q and of v at parts of the step, in place of
        the guess of the robot."""
        opti, walker = self.opti, self.walker
        opti.set_value(self.size, [length, time])
        speeds = np.diff(walker.guess([0, 1], length), axis=0) / time
        start = start or (lambda s: (walker.guess(s, length), np.tile(speeds, (len(s), 1))))
        opti.set_initial(self.after, walker.guess_after(length, time, speeds[0]))
        for unknowns, parts in zip((self.at_nodes, self.at_points), self.parts):
            for one, rows in zip(unknowns, start(parts)):
                opti.set_initial(one, rows.T)
        value = lambda of: np.array(opti.debug.value(of, opti.initial())).ravel()
        lower, upper = np.full(opti.nx, -np.inf), np.full(opti.nx, np.inf)
        # That IPOPT takes them for bounds of unknowns.
        most = np.full(walker.torques, walker.most)
        for unknowns, bounds in ((self.torques, (-most, most)), (self.at_nodes[0], (walker.lower, walker.upper)),
                                 (self.at_points[0], (walker.lower, walker.upper))):
            columns = self.columns(unknowns)
            lower[columns], upper[columns] = (np.tile(bound, len(columns) // len(bound)) for bound in bounds)
        return {"x0": value(opti.x), "lbx": lower, "ubx": upper, "lbg": value(opti.lbg), "ubg": value(opti.ubg),
                "p": [length, time]}

    def solve(self, length, time, start=None):
        """What IPOPT returns."""
        solver = ca.nlpsol("solver", "ipopt", self.nlp, QUIET)
        arguments = self.arguments(length, time, start)
        found = solver(**arguments)
        if not solver.stats()["success"]:
            stop(f"a step of {self.walker.name}: IPOPT says {solver.stats()['return_status']}")
        return found | {key: arguments[key] for key in ("lbx", "ubx", "p")}

    def read(self, of, found):
        """Expressions of the program in what a solver returned."""
        return np.array(ca.Function("read", [self.nlp["x"], self.nlp["p"]], [of])(found["x"], found["p"]))

    def told(self, found):
        """The cost, and the impulse of the landing (N s, and N m s where it has a moment)."""
        return float(found["f"]), self.read(self.jump, found).ravel()

    def positions(self, found):
        """`start` for another mesh: straight lines between the points that there are."""
        at = np.concatenate(self.parts)
        order = np.argsort(at)
        rows = [np.hstack([self.read(one, found) for one in both]).T[order] for both in zip(self.at_nodes, self.at_points)]
        return lambda s: [np.array([np.interp(s, at[order], column) for column in row.T]).T for row in rows]

    def active(self, found):
        """For each point which limits are active there: those whose multipliers are more than what is left."""
        x, low, high, by_x, by_g = (np.array(found[key]).ravel() for key in ("x", "lbx", "ubx", "lam_x", "lam_g"))
        columns = np.hstack([self.columns(of).reshape(len(self.parts[1]), -1) for of in (self.at_points[0], self.torques)])
        left = np.minimum(x - low, high - x)[columns]
        rows = self.read(self.limits, found).T
        return np.hstack([abs(by_x[columns]) > left, abs(by_g[self.rows]).reshape(rows.shape) > rows])

    def finer(self, found):
        """The mesh with halves of the intervals in which limits begin or end to be active, or beside which they do."""
        changes = np.flatnonzero((np.diff(self.active(found).astype(int), axis=0) != 0).any(axis=1))
        halved = np.unique(np.append(changes, changes + 1) // DEGREE)
        return np.sort(np.append(self.mesh, (self.mesh[halved] + self.mesh[halved + 1]) / 2))


def solve(walker, length, time, mesh, start=None):
    """The cost of a step, and the impulse of its landing. The mesh is made finer until the cost settles."""
    cost = np.inf
    for _ in range(MESHES):
        step, before = Step(walker, mesh), cost
        found = step.solve(length, time, start)
        cost = float(found["f"])
        if abs(cost - before) <= SETTLED * cost:
            return step.told(found)
        mesh, start = step.finer(found), step.positions(found)
    stop(f"a step of {walker.name}: the cost has not settled on {len(mesh) - 1} intervals")


def found_by(costate, problem):
    """What costate finds."""
    command = [costate, "optimize", problem, "--json"]
    return json.loads(subprocess.run(command, capture_output=True, text=True, check=False).stdout)
