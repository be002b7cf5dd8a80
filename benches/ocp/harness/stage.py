"""What FATROP evaluates on one interval of the program of staged.py, compiled once a robot and kind of task.

Unknowns are the state x = (q, v), or (q, v, T) in a free time, and the controls a_1, a_2, a_3, the accelerations at Radau's
points c_j. With h = s T, s the share of the interval of the time, the motion at a point is linear in them:

    q_j = q + h c_j v + h^2 sum_r A_jr a_r,   v_j = v + h sum_r B_jr a_r,

B integrates the polynomials of the controls from 0 to c_j, A twice. The last point is the end of the interval. With
z_j = (q_j, v_j, a_j) = P_j (x, a_1, a_2, a_3) the Hessian by the unknowns is the sum of P_j' H_j P_j, H_j of the point, and a
border for T. stage.c does these products; the functions of the points are those that the other transcriptions call."""

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


def functions(task, own, limited):
    """Functions by name of (w, T, s, e, scale, par, unit): the unknowns, the time, the share of the interval, effort times the
    weights of the quadrature by point, what rows of torques and clearances are multiplied by, the obstacles, and the unit of time
    of rates and accelerations, also that of 1/s and e (s); of "second" also of the weight of the cost and of the multipliers of torques and clearances and of z by point. `own` are the compiled points of the
    task, `limited` holds the joints whose q, v, a and torques have limits."""
    kind = f"{task.robot.name}{len(task.obstacles) or ''}{'_free' if task.free else ''}"
    rows = "".join(name + "".join(map(str, joints)) for name, joints in limited.items() if joints) or "no_limits"
    found = {}
    for names, name in ((COMMON, f"{kind}_stage"), (LIMITED, f"{kind}_{rows}_stage")):
        if name not in own.built:
            path = points.fastest(own.cache, name, text(names, task, own, limited), names[-1], own.libraries)
            own.built[name] = {name: ca.external(name, str(path)) for name in names}
        found |= own.built[name]
    return found


def text(names, task, own, limited):
    """C of these functions."""
    n, d, free = task.n, radau.DEGREE, int(task.free)
    states, w = 2 * n + free, 2 * n + free + d * n
    torques = [*limited["u"], *range(n, own.rows)]
    kept = [order * n + joint for order, name in enumerate("qva") for joint in limited[name]]
    rows = states + d * (len(torques) + len(kept))
    inputs = {"w": (w, 1), "T": (1, 1), "s": (1, 1), "e": (n, d), "scale": (own.rows, 1), "par": (4 * len(task.obstacles), 1),
              "unit": (1, 1)}
    more = {"weight": (1, 1), "lam": (own.rows, d), "nu": (3 * n, d)}
    outputs = {"cost": (1, 1), "gradient": (w, 1), "second": (w, w), "rows": (rows, 1), "jacobian_of_rows": (rows, w)}
    called = (own.value, own.jacobian, own.hessian)
    sizes = {"N": n, "FREE": free, "ROWS": own.rows, "JACOBIAN": len(own.jacobian_at[0]), "HESSIAN": len(own.hessian_at[0]),
             "LIMITED": len(torques), "KEPT": len(kept), "EXTRA": max(max(each.sz_arg(), each.sz_res()) for each in called)}
    integers = {"jacobian_i": own.jacobian_at[0], "jacobian_j": own.jacobian_at[1], "hessian_i": own.hessian_at[0],
                "hessian_j": own.hessian_at[1], "limited": torques, "kept": kept}
    lines = [
        "typedef long long int INT;",
        *(f"#define {name} {size}" for name, size in sizes.items()),
        *(f"static const int {name}[] = {{{', '.join(map(str, numbers)) or 0}}};" for name, numbers in integers.items()),
        f"static const double POINTS[] = {{{reals(radau.POINTS)}}};",
        *(f"static const double {name}[3][3] = {{{', '.join(f'{{{reals(row)}}}' for row in matrix)}}};"
          for name, matrix in {"ONCE": ONCE, "TWICE": TWICE}.items()),
        *(f"int {each.name()}(const double **, double **, INT *, double *, int);" for each in called),
        BODY.read_text(),
    ]
    work = len(inputs) + len(more), 1, max(each.sz_iw() for each in called), max(each.sz_w() for each in called)
    for name in names:
        lines += interface(name, inputs | (more if name == "second" else {}), outputs[name], work)
    return "\n".join(lines) + "\n"


def reals(numbers):
    return ", ".join(repr(float(number)) for number in numbers)
