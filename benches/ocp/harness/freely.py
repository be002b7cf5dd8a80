"""Values of a floating body with a hinge that turns by 150 degrees, its orientation a quaternion as four plain states.

`python benches/ocp/harness/main.py --values freely` (by `benches/ocp/run --values`) solves it and compares; the test
`control/tests/control/reorientation.rs` holds the same values. The equations are those of Hamel for two bodies, written out
here: T of the velocities in the axes of the trunk, momenta p = T_v, forces u from the rates of p in these axes. One value is
that of IPOPT on the motion, which is a minimum. The other is that of IPOPT as a solver of equations on the extremals, from
costates that are zero: a saddle, to which no minimiser leads."""

import math

import casadi as ca
import numpy

import radau

TIME, ELEMENTS, WITHIN = 2.0, 80, 2e-9
MINIMUM, SADDLE = 33.3867199, 33.4567456
NQ, N = 8, 7
# What is taken of the mass of the trunk and of the link (kg, m, kg m^2), of the hinge and of gravity (m/s^2).
TRUNK = (2.0, ca.DM([0.05, 0.0, 0.1]), ca.DM([0.3, 0.4, 0.5]))
LINK = (0.8, ca.DM([0.5, 0.0, 0.0]), ca.DM([0.02, 0.1, 0.1]))
HINGE, AXIS, GRAVITY = ca.DM([0.2, 0.0, 0.0]), ca.DM([0.0, 1.0, 0.0]), ca.DM([0.0, 0.0, -2.0])
TURN = numpy.array([0.2, 1.0, 0.3]) / numpy.linalg.norm([0.2, 1.0, 0.3]) * math.radians(150)
SHIFT, BEND = numpy.array([0.5, 0.2, 0.3]), 0.8


def rotation(a):
    """Of the unit quaternion (x, y, z, w)."""
    x, y, z, w = ca.vertsplit(a)
    return ca.vertcat(ca.horzcat(1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
                      ca.horzcat(2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
                      ca.horzcat(2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)))


def forces(a, hinge, v, rate):
    """u of the orientation a, the angle of the hinge, v = (linear, angular, hinge) and its rate."""
    linear, w, bend = v[:3], v[3:6], v[6]
    c, s = ca.cos(hinge), ca.sin(hinge)
    turned = ca.vertcat(ca.horzcat(c, 0, s), ca.horzcat(0, 1, 0), ca.horzcat(-s, 0, c))
    (m_1, c_1, j_1), (m_2, own, j_2) = TRUNK, LINK
    arm = turned @ own
    c_2 = HINGE + arm
    v_1, v_2 = linear + ca.cross(w, c_1), linear + ca.cross(w, c_2) + bend * ca.cross(AXIS, arm)
    w_2 = turned.T @ (w + bend * AXIS)
    kinetic = (m_1 * ca.sumsqr(v_1) + ca.dot(w, j_1 * w) + m_2 * ca.sumsqr(v_2) + ca.dot(w_2, j_2 * w_2)) / 2
    p = ca.gradient(kinetic, v)
    p_rate = ca.jtimes(p, v, rate) + ca.jtimes(p, hinge, bend)
    g = rotation(a).T @ GRAVITY
    moment = m_1 * ca.cross(c_1, g) + m_2 * ca.cross(c_2, g)
    return ca.vertcat(p_rate[:3] + ca.cross(w, p[:3]) - (m_1 + m_2) * g,
                      p_rate[3:6] + ca.cross(w, p[3:6]) + ca.cross(linear, p[:3]) - moment,
                      p_rate[6] - ca.gradient(kinetic, hinge) - m_2 * ca.dot(g, ca.cross(AXIS, arm)))


def symbols():
    """q, v and the rate of v; u, and q' = (R v, a o (w, 0) / 2, hinge rate)."""
    q, v, rate = ca.SX.sym("q", NQ), ca.SX.sym("v", N), ca.SX.sym("rate", N)
    x, y, z, w = ca.vertsplit(q[3:7])
    turn = ca.vertcat(ca.horzcat(w, -z, y), ca.horzcat(z, w, -x), ca.horzcat(-y, x, w), ca.horzcat(-x, -y, -z))
    q_rate = ca.vertcat(rotation(q[3:7]) @ v[:3], turn @ v[3:6] / 2, v[6])
    return q, v, rate, forces(q[3:7], q[7], v, rate), q_rate


def way(s):
    """q and v at part s of the time on the way whose parts are those of a cubic."""
    part, rate = s * s * (3 - 2 * s), 6 * s * (1 - s) / TIME
    angle = numpy.linalg.norm(TURN)
    a = numpy.array([*(TURN / angle * math.sin(angle * part / 2)), math.cos(angle * part / 2)])
    linear = numpy.array(rotation(ca.DM(a))).T @ SHIFT * rate
    return numpy.array([*SHIFT * part, *a, BEND * part]), numpy.array([*linear, *TURN * rate, BEND * rate])


def times(elements):
    return ((numpy.arange(elements)[:, None] + radau.POINTS) / elements).ravel()


def collocated(state, slope, start, elements):
    """The equations of states at all points, whose rates these are."""
    d, h = radau.DEGREE, TIME / elements
    nodes = [ca.horzcat(start, state[:, d - 1:-1:d]), *(state[:, j::d] for j in range(d))]
    slopes = (sum(radau.DERIVATIVE[r, j] * nodes[r] for r in range(d + 1)) - h * slope[:, j::d] for j in range(d))
    return [ca.vec(equation) for equation in slopes]


def at_end(q, v):
    """The end is reached, at rest: vec(conj(a_T) o a) = 0 fixes the orientation."""
    end, _ = way(1.0)
    x, y, z, w = end[3:7]
    back = ca.DM([[w, z, -y, -x], [-z, w, x, -y], [y, -x, w, -z]])
    return [back @ q[3:7], q[:3] - end[:3], q[7] - end[7], v]


def solved(unknowns, cost, equations, guess):
    """What IPOPT finds: the unknowns, or nothing."""
    options = {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.tol": 1e-10, "ipopt.max_iter": 300}
    solver = ca.nlpsol("solver", "ipopt", {"x": unknowns, "f": cost, "g": ca.vertcat(*equations)}, options)
    found = solver(x0=guess, lbg=0, ubg=0)["x"]
    return found if solver.stats()["success"] else None


def weights(elements):
    return ca.DM(numpy.tile(radau.WEIGHTS * TIME / elements, elements)).T


def minimum(elements=ELEMENTS):
    """The cost of the motion of least half squared forces, from cubics with accelerations that are zero."""
    q, v, rate, u, q_rate = symbols()
    point = ca.Function("point", [q, v, rate], [ca.sumsqr(u) / 2, q_rate], {"cse": True})
    count = elements * radau.DEGREE
    q, v, rate = (ca.MX.sym(name, rows, count) for name, rows in (("q", NQ), ("v", N), ("rate", N)))
    cost, slopes = point.map(count)(q, v, rate)
    equations = [*collocated(q, slopes, ca.DM(way(0.0)[0]), elements), *collocated(v, rate, ca.DM.zeros(N), elements),
                 *at_end(q[:, -1], v[:, -1])]
    rows = [way(s) for s in times(elements)]
    guess = numpy.concatenate([*(row[0] for row in rows), *(row[1] for row in rows), numpy.zeros(N * count)])
    unknowns, cost = ca.vertcat(ca.vec(q), ca.vec(v), ca.vec(rate)), ca.dot(weights(elements), cost)
    found = solved(unknowns, cost, equations, guess)
    return math.nan if found is None else float(ca.Function("cost", [unknowns], [cost])(found))


def extremal(elements=ELEMENTS):
    """The cost of the extremal that cubics lead to, with costates and accelerations that are zero: x' = H_y, y' = -H_x and
    H_rate = 0. Costates along a quaternion, which change nothing, are zero at the start."""
    q, v, rate, u, q_rate = symbols()
    x, y = ca.vertcat(q, v), ca.SX.sym("y", NQ + N)
    hamiltonian = ca.sumsqr(u) / 2 + ca.dot(y, ca.vertcat(q_rate, rate))
    parts = [ca.vertcat(q_rate, rate), -ca.gradient(hamiltonian, x), ca.gradient(hamiltonian, rate), ca.sumsqr(u) / 2]
    point = ca.Function("point", [x, y, rate], parts, {"cse": True})
    count, first = elements * radau.DEGREE, ca.MX.sym("first", NQ + N)
    x, y, rate = (ca.MX.sym(name, rows, count) for name, rows in (("x", NQ + N), ("y", NQ + N), ("rate", N)))
    x_rate, y_rate, stationary, cost = point.map(count)(x, y, rate)
    start = numpy.concatenate(way(0.0))
    equations = [*collocated(x, x_rate, ca.DM(start), elements), *collocated(y, y_rate, first, elements), ca.vec(stationary),
                 *at_end(x[:NQ, -1], x[NQ:, -1]), ca.dot(first[3:7], ca.DM(start[3:7]))]
    rows = numpy.concatenate([numpy.concatenate(way(s)) for s in times(elements)])
    guess = numpy.concatenate([numpy.zeros(NQ + N), rows, numpy.zeros((NQ + 2 * N) * count)])
    unknowns = ca.vertcat(first, ca.vec(x), ca.vec(y), ca.vec(rate))
    found = solved(unknowns, 0, equations, guess)
    return math.nan if found is None else float(ca.Function("cost", [unknowns], [ca.dot(weights(elements), cost)])(found))


def check(root, costate, _):
    """Solves both; whether the values are reproduced."""
    kept = True
    for name, value, cost in (("a minimum", MINIMUM, minimum()), ("an extremal that is a saddle", SADDLE, extremal())):
        difference = abs(cost - value) / value
        kept &= difference <= WITHIN
        print(f"floating body: turn by 150 deg, {name}: {value:.9g}; collocation: {cost:.9g}, {difference:.1e}: "
              f"{'reproduced' if difference <= WITHIN else 'NOT REPRODUCED'}", flush=True)
    return kept
