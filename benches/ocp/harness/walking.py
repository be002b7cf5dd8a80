"""Steps of RABBIT as in examples/problems (rabbit_walk.toml, rabbit_double_support.toml) by CasADi and IPOPT, in other
coordinates: absolute angles of the five links of a robot whose foot is pinned, without constraints; the impact in seven
coordinates."""

import casadi as ca
import numpy as np

import soles
import steps
from shell import say, stop
from steps import DEGREE, PARTS, QUIET, Step, Walker, found_by

LENGTH, TIME, CLEARANCE, MOST, GRAVITY, FRICTION = 0.5, 0.7, 0.02, 150.0, 9.81, 0.6
INTERVALS = 20
# Relative difference of the costs, and of the impulses.
WITHIN = 1e-6
# Mass, inertia, distance of the centre of mass from the hip or knee, length: torso, femur, tibia.
TORSO, FEMUR, TIBIA = (20.0, 2.22, 0.2, 0.625), (6.8, 1.08, 0.163, 0.4), (3.2, 0.93, 0.128, 0.4)
MASS = TORSO[0] + 2 * (FEMUR[0] + TIBIA[0])
# Angles: torso, femur and tibia of the leg that swings, the same of the one that stands; ahead where the torso leans ahead,
# behind where a leg is behind.
EXCHANGE = [0, 3, 4, 1, 2]


# Places are sums of multiples of (sin, cos) of the angles: of the hip from the foot that stands, of the centres of mass and of
# the foot that swings from the hip.
UNIT = [ca.DM(row) for row in np.eye(5)]
HIP = FEMUR[3] * UNIT[3] + TIBIA[3] * UNIT[4]
CENTRES = [TORSO[2] * UNIT[0]]
for femur, tibia in ((1, 2), (3, 4)):
    CENTRES += [-FEMUR[2] * UNIT[femur], -FEMUR[3] * UNIT[femur] - TIBIA[2] * UNIT[tibia]]
FOOT = -FEMUR[3] * UNIT[1] - TIBIA[3] * UNIT[2]


def place(of, a):
    return ca.vertcat(ca.dot(of, ca.sin(a)), ca.dot(of, ca.cos(a)))


def rate(of, a, w):
    return ca.vertcat(ca.dot(of, ca.cos(a) * w), -ca.dot(of, ca.sin(a) * w))


def acceleration(of, a, w, acc):
    along, down = ca.cos(a) * acc - ca.sin(a) * w**2, ca.sin(a) * acc + ca.cos(a) * w**2
    return ca.vertcat(ca.dot(of, along), -ca.dot(of, down))


def cone(x, z):
    """Both are positive inside of the friction cone."""
    return ca.vertcat(FRICTION * z - x, FRICTION * z + x)


LINKS = [TORSO, FEMUR, TIBIA, FEMUR, TIBIA]


def guess(s, length):
    """Linear from pose to pose, the leg that swings bent; a row for each part s of the step."""
    s = np.asarray(s)[:, None]
    begin = np.array([0.1, 0.2, 0.5, -0.5, -0.2]) * [1, *[length / LENGTH] * 4]
    return begin + s * (begin[EXCHANGE] - begin) + np.array([0, -0.3, 0.4, 0, 0]) * np.sin(np.pi * s)


def on_the_ground(a, w, acc, tau):
    """The force on the robot at its foot, what the five equations of motion miss, by virtual work, and the angles of the
    knees."""
    force, left = ca.vertcat(0, 0), ca.vertcat(*(part[1] for part in LINKS)) * acc
    for (m, *_), centre in zip(LINKS, CENTRES):
        push = m * (acceleration(HIP + centre, a, w, acc) + ca.vertcat(0, GRAVITY))
        left += (HIP + centre) * (ca.cos(a) * push[0] - ca.sin(a) * push[1])
        force += push
    # Hip and knee of the leg that swings, then of the other one; of relative angles.
    relative = ca.vertcat(a[1] - a[0], a[2] - a[1], a[3] - a[0], a[4] - a[3])
    return force, left - ca.jtimes(relative, a, tau, True), ca.vertcat(relative[1], relative[3])


def rabbit():
    """The robot for a step."""
    # On the ground, by virtual work: five angles.
    a, w, acc, tau, reach = (ca.SX.sym(name, count) for name, count in
                            (("a", 5), ("w", 5), ("acc", 5), ("tau", 4), ("reach", 1)))
    force, missing, knees = on_the_ground(a, w, acc, tau)
    swing = place(HIP + FOOT, a)
    height = swing[1] - CLEARANCE * (1 - (swing[0] / reach) ** 2)
    limits = ca.vertcat(cone(force[0], force[1]), height, knees)
    point = ca.Function("point", [a, w, acc, tau, reach], [missing, limits], {"cse": True})

    # In the air: the hip and five angles.
    v, before, impulse = ca.SX.sym("v", 7), ca.SX.sym("before", 7), ca.SX.sym("impulse", 2)
    rates = [v[:2] + rate(centre, a, v[2:]) for centre in CENTRES]
    kinetic = sum(m / 2 * ca.sumsqr(one) + inertia / 2 * v[2 + i] ** 2
                  for i, ((m, inertia, *_), one) in enumerate(zip(LINKS, rates)))
    mass, sticks = ca.hessian(kinetic, v)[0], v[:2] + rate(FOOT, a, v[2:])
    law = mass @ (v - before) - ca.jtimes(sticks, v, impulse, True)
    impact = ca.Function("impact", [a, before, v, impulse], [law, sticks])

    def ends(length, start, end, after, jump):
        (a_0, w_0), (a_T, w_T) = start, end
        law, sticks = impact(a_T, ca.vertcat(rate(HIP, a_T, w_T), w_T), after, jump)
        return ([place(HIP + FOOT, a_0) - ca.vertcat(-length, 0), a_0 - a_T[EXCHANGE], law, sticks,
                 w_0 - after[2:][EXCHANGE]], [cone(jump[0], jump[1])])

    none = np.full(5, np.inf)
    return Walker("RABBIT", 4, MOST, -none, none, 7, 2, point, ends, guess,
                  lambda length, time, rates: np.append([length / time, 0], rates))


def on_both_feet(share, first=12, then=40):
    """The cost of a step that begins on both feet, for this part of its duration, with so many intervals in its two phases. The
    foot behind has a force of its own and accelerations that are zero; the other one lands at rest."""
    a, w, acc, tau, behind = (ca.SX.sym(name, count) for name, count in
                              (("a", 5), ("w", 5), ("acc", 5), ("tau", 4), ("behind", 2)))
    force, left, knees = on_the_ground(a, w, acc, tau)
    foot = place(HIP + FOOT, a)
    height, front = foot[1] - CLEARANCE * (1 - (foot[0] / LENGTH) ** 2), force - behind
    swings = ca.Function("swings", [a, w, acc, tau], [left, ca.vertcat(cone(force[0], force[1]), height, knees)])
    rests = ca.vertcat(left - ca.jtimes(foot, a, behind, True), acceleration(HIP + FOOT, a, w, acc))
    cones = ca.vertcat(cone(front[0], front[1]), cone(behind[0], behind[1]), knees)
    stands = ca.Function("stands", [a, w, acc, tau, behind], [rests, cones])

    C, D, B = ca.collocation_coeff(list(PARTS))
    opti, intervals = ca.Opti(), first + then
    count = DEGREE * intervals
    nodes = np.append(np.linspace(0, share, first + 1), np.linspace(share, 1, then + 1)[1:])
    a_n, w_n = opti.variable(5, intervals + 1), opti.variable(5, intervals + 1)
    a_c, w_c, u = opti.variable(5, count), opti.variable(5, count), opti.variable(4, count)
    forces, cost = opti.variable(2, DEGREE * first), 0
    for k, h in enumerate(TIME * np.diff(nodes)):
        own = slice(DEGREE * k, DEGREE * (k + 1))
        A, W = ca.horzcat(a_n[:, k], a_c[:, own]), ca.horzcat(w_n[:, k], w_c[:, own])
        opti.subject_to(ca.vec(A @ C - h * w_c[:, own]) == 0)
        opti.subject_to(a_n[:, k + 1] == A @ D)
        opti.subject_to(w_n[:, k + 1] == W @ D)
        for j in range(DEGREE):
            i = DEGREE * k + j
            state = a_c[:, i], w_c[:, i], (W @ C)[:, j] / h, u[:, i]
            equations, limits = stands(*state, forces[:, i]) if k < first else swings(*state)
            opti.subject_to(equations == 0)
            opti.subject_to(limits >= 0)
            cost += h / 2 * B[j] * ca.sumsqr(u[:, i])
    opti.subject_to(opti.bounded(-MOST, ca.vec(u), MOST))
    opti.subject_to(place(HIP + FOOT, a_n[:, 0]) == ca.vertcat(-LENGTH, 0))
    opti.subject_to(a_n[:, 0] == a_n[EXCHANGE, -1])
    opti.subject_to(w_n[:, 0] == w_n[EXCHANGE, -1])
    opti.subject_to(rate(HIP + FOOT, a_n[:, -1], w_n[:, -1]) == 0)
    opti.minimize(cost)
    opti.solver("ipopt", QUIET)
    places = (nodes[:-1, None] + np.diff(nodes)[:, None] * PARTS).ravel()
    speeds = np.diff(guess([0, 1], LENGTH), axis=0)[0] / TIME
    for angles, rates, at in ((a_n, w_n, nodes), (a_c, w_c, places)):
        opti.set_initial(angles, guess(at, LENGTH).T)
        opti.set_initial(rates, np.tile(speeds, (len(at), 1)).T)
    try:
        return float(opti.solve().value(cost))
    except RuntimeError as error:
        stop(f"a step of RABBIT on both feet: {error}")


def agree(name, found, cost, jump=None):
    """Whether costate has found this cost, and this impulse of the landing."""
    away, told = abs(found["cost"] / cost - 1), ""
    kept = found["status"] == "converged" and away <= WITHIN
    if jump is not None:
        [impulse] = found["gait"]["impulses"]
        apart = np.abs(np.array(impulse)[[0, 2]] - jump[:2]).max() / np.abs(jump[:2]).max()
        kept, told = kept and apart <= 100 * WITHIN, f"; impulses differ by {apart:.0e}"
    say(f"{name}: {found['cost']:.9f}, {cost:.9f} in other coordinates{told}: {'agree' if kept else 'DIFFER'}")
    return kept


def check(root, costate, _):
    """Whether costate finds the same steps."""
    step = Step(rabbit(), INTERVALS)
    cost, jump = step.told(step.solve(LENGTH, TIME))
    kept = agree("a step of RABBIT", found_by(costate, root / "examples/problems/rabbit_walk.toml"), cost, jump)
    cost = on_both_feet(0.2)
    kept &= agree("a step of RABBIT on both feet", found_by(costate, root / "examples/problems/rabbit_double_support.toml"), cost)
    cost, jump = steps.solve(soles.biped(), soles.LENGTH, soles.TIME, soles.INTERVALS)
    kept &= agree("a step with soles", found_by(costate, root / "examples/problems/seven_link_walk.toml"), cost, jump)
    return kept
