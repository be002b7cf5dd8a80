"""What FATROP evaluates on one interval of the program of staged.py, compiled once a robot and kind of task.

Unknowns are the state x = (q, v), or (q, v, T) in a free time, and the controls a_1, a_2, a_3, the accelerations at Radau's points
c_j. With h = s T, s the share of the interval of the time, the motion at a point is linear in them:

    q_j = q + h c_j v + h^2 sum_r A_jr a_r,   v_j = v + h sum_r B_jr a_r,

B integrates the polynomials of the controls from 0 to c_j, A twice. The last point is the end of the interval. z_j = (q_j, v_j, a_j)
is P_j (x, a_1, a_2, a_3); the Hessian by the unknowns is the sum of P_j' H_j P_j, H_j of the point, and a border for T. stage.c does
these products; the functions of the points are those that the other transcriptions call."""

from pathlib import Path

import casadi as ca
import numpy

import points
import radau
from external import interface

ONCE, TWICE = (numpy.array([[polynomial.integ(times)(place) for polynomial in radau.CONTROL] for place in radau.POINTS])
               for times in (1, 2))
# Functions that are the same whatever the limits are, and the others.
COMMON, LIMITED = ("cost", "gradient", "second"), ("rows", "jacobian_of_rows")
BODY = Path(__file__).with_name("stage.c")


class Stages:
    """The functions of a robot with so many spheres in its way, from its points."""

    def __init__(self, cache, robot, spheres, of_points):
        self.cache, self.robot, self.spheres, self.points = cache, robot, spheres, of_points
        self.value = of_points.value
        self._built = {}

    def of(self, free, limited):
        """Functions by name of (w, T, s, e, scale, par): the unknowns, the time, the share of the interval, effort times the
        weights of the quadrature by point, what rows of torques and clearances are multiplied by, and the obstacles; of "second"
        also of the weight of the cost and of the multipliers of torques and clearances and of z by point. `limited` holds the
        joints whose q, v, a and torques have limits."""
        kind = f"{self.robot.name}{self.spheres or ''}{'_free' if free else ''}"
        rows = "".join(name + "".join(map(str, joints)) for name, joints in limited.items() if joints)
        found = {}
        for names, name in ((COMMON, kind), (LIMITED, f"{kind}_{rows}" if rows else f"{kind}_no_limits")):
            if name not in self._built:
                self._built[name] = self._build(f"{name}_stage", names, free, limited)
            found |= self._built[name]
        return found

    def _build(self, stem, names, free, limited):
        text = self.text(names, free, limited)
        path = points.fastest(self.cache, stem, text, names[-1], self.points.libraries)
        return {name: ca.external(name, str(path)) for name in names}

    def text(self, names, free, limited):
        n, own, d = self.robot.n, self.points, radau.DEGREE
        w = 2 * n + free + d * n
        torques = [*limited["u"], *range(n, own.rows)]
        kept = [order * n + joint for order, name in enumerate("qva") for joint in limited[name]]
        path = len(torques) + len(kept)
        inputs = {"w": (w, 1), "T": (1, 1), "s": (1, 1), "e": (n, d), "scale": (own.rows, 1), "par": (4 * self.spheres, 1)}
        more = {"weight": (1, 1), "lam": (own.rows, d), "nu": (3 * n, d)}
        outputs = {"cost": (1, 1), "gradient": (w, 1), "second": (w, w), "rows": (w - d * n + d * path, 1),
                   "jacobian_of_rows": (w - d * n + d * path, w)}
        called = (own.value, own.jacobian, own.hessian)
        extra = max(max(function.sz_arg(), function.sz_res()) for function in called)
        sizes = {"N": n, "FREE": int(free), "ROWS": own.rows, "JACOBIAN": len(own.jacobian_at[0]),
                 "HESSIAN": len(own.hessian_at[0]), "LIMITED": len(torques), "KEPT": len(kept), "EXTRA": extra}
        integers = {"jacobian_i": own.jacobian_at[0], "jacobian_j": own.jacobian_at[1], "hessian_i": own.hessian_at[0],
                    "hessian_j": own.hessian_at[1], "limited": torques, "kept": kept}
        integrals = {"ONCE": ONCE, "TWICE": TWICE}
        lines = [
            "typedef long long int INT;",
            *(f"#define {name} {size}" for name, size in sizes.items()),
            *(f"static const int {name}[] = {{{', '.join(map(str, numbers)) or 0}}};" for name, numbers in integers.items()),
            f"static const double POINTS[] = {{{reals(radau.POINTS)}}};",
            *(f"static const double {name}[3][3] = {{{', '.join(f'{{{reals(row)}}}' for row in matrix)}}};"
              for name, matrix in integrals.items()),
            *(f"int {function.name()}(const double **, double **, INT *, double *, int);" for function in called),
            BODY.read_text(),
        ]
        work = (len(inputs) + len(more), 1, max(function.sz_iw() for function in called), max(function.sz_w() for function in called))
        for name in names:
            lines += interface(name, inputs | (more if name == "second" else {}), outputs[name], work)
        return "\n".join(lines) + "\n"


def reals(numbers):
    return ", ".join(repr(float(number)) for number in numbers)
