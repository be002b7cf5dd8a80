"""The step of examples/problems/rabbit_walk.toml by CasADi and IPOPT, in other coordinates: absolute angles of the five
links of a robot whose foot is pinned, without constraints; the impact in seven coordinates."""

import json
import subprocess

import casadi as ca
import numpy as np

from shell import say

LENGTH, TIME, CLEARANCE, MOST, GRAVITY, FRICTION = 0.5, 0.7, 0.02, 150.0, 9.81, 0.6
INTERVALS, DEGREE = 20, 3
# Relative difference of the costs, and of the impulses.
WITHIN = 1e-6
# Mass, inertia, distance of the centre of mass from the hip or knee, length: torso, femur, tibia.
TORSO, FEMUR, TIBIA = (20.0, 2.22, 0.2, 0.625), (6.8, 1.08, 0.163, 0.4), (3.2, 0.93, 0.128, 0.4)
MASS = TORSO[0] + 2 * (FEMUR[0] + TIBIA[0])
# Angles: torso, femur and tibia of the leg that swings, the same of the one that stands; ahead where the torso leans ahead,
# behind where a leg is behind.
EXCHANGE = [0, 3, 4, 1, 2]


def down(angle, length):
    return ca.vertcat(-ca.sin(angle), -ca.cos(angle)) * length


def bodies(hip, angles):
    """Centres of mass and the feet."""
    t, f1, t1, f2, t2 = ca.vertsplit(angles)
    knees = [hip + down(f1, FEMUR[3]), hip + down(f2, FEMUR[3])]
    centres = [hip - down(t, TORSO[2]), hip + down(f1, FEMUR[2]), knees[0] + down(t1, TIBIA[2])]
    centres += [hip + down(f2, FEMUR[2]), knees[1] + down(t2, TIBIA[2])]
    return centres, knees[0] + down(t1, TIBIA[3]), knees[1] + down(t2, TIBIA[3])


PARTS = [TORSO, FEMUR, TIBIA, FEMUR, TIBIA]


def lagrangian(q, v, centres, angles):
    kinetic, potential = 0, 0
    for (m, inertia, *_), c, i in zip(PARTS, centres, angles):
        rate = ca.jtimes(c, q, v)
        kinetic += 0.5 * m * ca.sumsqr(rate) + 0.5 * inertia * v[i] ** 2
        potential += m * GRAVITY * c[1]
    return kinetic, potential


def guess(s):
    """Linear from pose to pose, the leg that swings bent."""
    begin = np.array([0.1, 0.2, 0.5, -0.5, -0.2])
    end = begin[EXCHANGE]
    bent = np.sin(np.pi * s)
    return begin + s * (end - begin) + np.array([0, -0.3, 0.4, 0, 0]) * bent


def solve():
    """The cost of a step, and the impulse of the landing (N s)."""
    # On the ground: five angles.
    a, w, acc, tau = ca.SX.sym("a", 5), ca.SX.sym("w", 5), ca.SX.sym("acc", 5), ca.SX.sym("tau", 4)
    hip = -(down(a[3], FEMUR[3]) + down(a[4], TIBIA[3]))
    centres, swing, stance = bodies(hip, a)
    kinetic, potential = lagrangian(a, w, centres, range(5))
    p = ca.gradient(kinetic, w)
    left = ca.jtimes(p, w, acc) + ca.jtimes(p, a, w) - ca.gradient(kinetic - potential, a)
    # Hip and knee of the leg that swings, then of the other one; of relative angles.
    relative = ca.vertcat(a[1] - a[0], a[2] - a[1], a[3] - a[0], a[4] - a[3])
    right = ca.jtimes(relative, a, tau, True)
    equations = ca.Function("equations", [a, w, acc, tau], [left - right])
    com = sum(part[0] * c for part, c in zip(PARTS, centres)) / MASS
    com_rate = ca.jtimes(com, a, w)
    force = MASS * (ca.jtimes(com_rate, a, w) + ca.jtimes(com_rate, w, acc) + ca.vertcat(0, GRAVITY))
    forces = ca.Function("forces", [a, w, acc], [force])
    foot = ca.Function("foot", [a], [swing])
    knees = ca.Function("knees", [a], [ca.vertcat(relative[1], relative[3])])
    hips = ca.Function("hips", [a, w], [hip, ca.jtimes(hip, a, w)])

    # In the air: the hip and five angles.
    q, v, before = ca.SX.sym("q", 7), ca.SX.sym("v", 7), ca.SX.sym("before", 7)
    all_centres, q_swing, _ = bodies(q[:2], q[2:])
    mass = ca.hessian(lagrangian(q, v, all_centres, range(2, 7))[0], v)[0]
    jacobian = ca.jacobian(q_swing, q)
    impulse = ca.SX.sym("impulse", 2)
    impact = ca.Function("impact", [q, before, v, impulse], [mass @ (v - before) - jacobian.T @ impulse, jacobian @ v])

    tau_points = np.array(ca.collocation_points(DEGREE, "legendre"))
    places = np.append(0, tau_points)
    C, D, B = ca.collocation_coeff(list(tau_points))
    opti = ca.Opti()
    h = TIME / INTERVALS
    cost = 0
    a_k, w_k = opti.variable(5), opti.variable(5)
    a_0, w_0 = a_k, w_k
    opti.set_initial(a_k, guess(0))
    opti.set_initial(w_k, (guess(1) - guess(0)) / TIME)
    opti.subject_to(foot(a_0) == ca.vertcat(-LENGTH, 0))
    for k in range(INTERVALS):
        a_c, w_c = opti.variable(5, DEGREE), opti.variable(5, DEGREE)
        u = opti.variable(4, DEGREE)
        for j in range(DEGREE):
            s = (k + tau_points[j]) / INTERVALS
            opti.set_initial(a_c[:, j], guess(s))
            opti.set_initial(w_c[:, j], (guess(1) - guess(0)) / TIME)
        A, W = ca.horzcat(a_k, a_c), ca.horzcat(w_k, w_c)
        a_rate, w_rate = A @ C / h, W @ C / h
        opti.subject_to(ca.vec(a_rate - w_c) == 0)
        for j in range(DEGREE):
            opti.subject_to(equations(a_c[:, j], w_c[:, j], w_rate[:, j], u[:, j]) == 0)
            f = forces(a_c[:, j], w_c[:, j], w_rate[:, j])
            opti.subject_to(FRICTION * f[1] - f[0] >= 0)
            opti.subject_to(FRICTION * f[1] + f[0] >= 0)
            place = foot(a_c[:, j])
            opti.subject_to(place[1] - CLEARANCE * (1 - (place[0] / LENGTH) ** 2) >= 0)
            opti.subject_to(knees(a_c[:, j]) >= 0)
            opti.subject_to(opti.bounded(-MOST, u[:, j], MOST))
            cost += h * B[j] * 0.5 * ca.sumsqr(u[:, j])
        a_k, w_k = opti.variable(5), opti.variable(5)
        s = (k + 1) / INTERVALS
        opti.set_initial(a_k, guess(s))
        opti.set_initial(w_k, (guess(1) - guess(0)) / TIME)
        opti.subject_to(a_k == A @ D)
        opti.subject_to(w_k == W @ D)
    opti.subject_to(a_0 == a_k[EXCHANGE])
    hip_T, hip_rate = hips(a_k, w_k)
    after, jump = opti.variable(7), opti.variable(2)
    opti.set_initial(after, np.append([0.7, 0], (guess(1) - guess(0)) / TIME))
    law, sticks = impact(ca.vertcat(hip_T, a_k), ca.vertcat(hip_rate, w_k), after, jump)
    opti.subject_to(law == 0)
    opti.subject_to(sticks == 0)
    opti.subject_to(w_0 == after[2:][EXCHANGE])
    opti.subject_to(FRICTION * jump[1] - jump[0] >= 0)
    opti.subject_to(FRICTION * jump[1] + jump[0] >= 0)
    opti.minimize(cost)
    opti.solver("ipopt", {"print_time": False}, {"print_level": 0, "tol": 1e-10, "max_iter": 3000, "sb": "yes"})
    solution = opti.solve()
    return solution.value(cost), solution.value(jump)


def check(root, costate, _):
    """Whether costate finds the same step."""
    command = [costate, "optimize", root / "examples/problems/rabbit_walk.toml", "--json"]
    found = json.loads(subprocess.run(command, capture_output=True, text=True, check=False).stdout)
    cost, jump = solve()
    [impulse] = found["gait"]["impulses"]
    away = [abs(found["cost"] / cost - 1), np.abs(np.array(impulse)[[0, 2]] - jump).max() / np.abs(jump).max()]
    kept = found["status"] == "converged" and away[0] <= WITHIN and away[1] <= 100 * WITHIN
    say(f"a step of RABBIT: {found['cost']:.9f}, {cost:.9f} in other coordinates; impulses differ by {away[1]:.0e}: "
        f"{'agree' if kept else 'DIFFER'}")
    return kept
