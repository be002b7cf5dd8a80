"""Steps of a planar biped with soles as in examples/problems/seven_link_walk.toml by CasADi and IPOPT, in other coordinates: the
foot that stands is ground, six angles of joints are left, without constraints; the impact of the robot in the air has nine
rates."""

import casadi as ca
import numpy as np

from steps import Walker

LENGTH, TIME, CLEARANCE, MOST, GRAVITY, FRICTION = 0.4, 0.6, 0.02, 200.0, 9.81, 0.6
# The first mesh.
INTERVALS = 40
HEEL, TOE, ANKLE, THIGH, SHANK = -0.0665, 0.125, 0.06825, 0.42875, 0.4305
# Links: trunk, thigh, shank and foot of the leg that swings, the same of the one that stands. Angles are zero upright; ahead
# where the trunk leans ahead, behind where a leg is behind, down where a foot points down.
NAMES = ["trunk", "thigh", "shank", "foot", "other_thigh", "other_shank", "other_foot"]
MASSES, INERTIAS = ([trunk, *leg, *leg] for trunk, leg in ((47.46, [7.0, 3.255, 1.015]), (2.966, [0.1342, 0.0550, 0.00464])))
MASS = sum(MASSES)

# Angles of joints by angles of links: trunk, then hip, knee and ankle of each leg. The last link is on the ground, where its
# angle is zero; the first six joints are positions then, and the others have motors.
JOINTS = np.eye(7) - np.eye(7)[:, [0, 0, 1, 2, 0, 4, 5]].T * (np.arange(7) > 0)[:, None]
LINKS = np.linalg.inv(np.vstack([JOINTS[:6], np.eye(7)[6]]))[:, :6]
# Joints whose angles are the positions at the start of the next step.
EXCHANGE = [0, 4, 5, 6, 1, 2]
LOWER, UPPER = np.array([-0.3, -1.5, 0.2, -1.0, -1.5, 0.2, -1.0]), np.array([0.3, 1.0, 2.0, 1.0, 1.0, 2.0, 1.0])


def of(**links):
    """A place from the hips: (x, z) in the frames of links, all rows of zeros but these."""
    return np.array([links.get(name, (0, 0)) for name in NAMES]).T


KNEES = {"thigh": (0, -THIGH)}, {"other_thigh": (0, -THIGH)}
ANKLES = KNEES[0] | {"shank": (0, -SHANK)}, KNEES[1] | {"other_shank": (0, -SHANK)}
CENTRES = [of(trunk=(0, 0.3155)),
           of(thigh=(0, -0.1856)), of(**KNEES[0], shank=(0, -0.1864)), of(**ANKLES[0], foot=(0.0625, -0.0341)),
           of(other_thigh=(0, -0.1856)), of(**KNEES[1], other_shank=(0, -0.1864)), of(**ANKLES[1], other_foot=(0.0625, -0.0341))]
SWINGS, STANDS = of(**ANKLES[0]), of(**ANKLES[1])
# Heel and toe of the foot that swings.
CORNERS = [of(**ANKLES[0], foot=(x, -ANKLE)) for x in (HEEL, TOE)]


def place(of, a):
    """x and z, in the angles of links."""
    x, z = ca.DM(of[0]), ca.DM(of[1])
    return ca.vertcat(ca.dot(x, ca.cos(a)) + ca.dot(z, ca.sin(a)), ca.dot(z, ca.cos(a)) - ca.dot(x, ca.sin(a)))


def rate(of, a, w):
    x, z = ca.DM(of[0]), ca.DM(of[1])
    along, up = ca.cos(a) * w, ca.sin(a) * w
    return ca.vertcat(ca.dot(z, along) - ca.dot(x, up), -ca.dot(z, up) - ca.dot(x, along))


def cone(friction, force, about_ankle):
    """Positive inside of the friction cone; and the loads of toe and heel, of the force of the ground and its moment about the
    ankle above it."""
    # The sum of x times load.
    turn = -ANKLE * force[0] - about_ankle
    loads = ca.vertcat(turn - HEEL * force[1], TOE * force[1] - turn) / (TOE - HEEL)
    return ca.vertcat(friction * force[1] - force[0], friction * force[1] + force[0], loads)


def heights(a, length, clearance):
    """Of heel and toe of the foot that swings above their parabolas."""
    feet = (place(corner, a) - place(STANDS, a) + ca.vertcat(0, ANKLE) for corner in CORNERS)
    return ca.vertcat(*(foot[1] - clearance * (1 - ((foot[0] - x) / length) ** 2) for foot, x in zip(feet, (HEEL, TOE))))


def on_the_ground(friction, clearance):
    """The equations of motion by virtual work in the angles of six links, and what is positive."""
    q, v, acc, u, length = (ca.SX.sym(name, count) for name, count in
                            (("q", 6), ("v", 6), ("acc", 6), ("u", 6), ("length", 1)))
    a, w, angular = ca.SX.sym("a", 7), ca.SX.sym("w", 7), ca.SX.sym("angular", 7)
    force, left = ca.vertcat(0, 0), ca.DM(INERTIAS) * angular - ca.DM(JOINTS[1:]).T @ u
    for mass, centre in zip(MASSES, CENTRES):
        centre = centre - STANDS
        speed = rate(centre, a, w)
        push = mass * (ca.jtimes(speed, a, w) + ca.jtimes(speed, w, angular) + ca.vertcat(0, GRAVITY))
        left += ca.jtimes(place(centre, a), a, push, True)
        force += push
    # What the foot on the ground misses is the moment of the ground about its ankle.
    limits = ca.vertcat(cone(friction, force, left[6]), heights(a, length, clearance), -a[5] - LOWER[6], UPPER[6] + a[5])
    rows = ca.substitute([left[:6], limits], [a, w, angular], [ca.DM(LINKS) @ x for x in (q, v, acc)])
    return ca.Function("point", [q, v, acc, u, length], rows, {"cse": True})


def landing():
    """The impact in rates of the hips and of all links: what its law and the foot on the ground miss."""
    a, v, before, jump = (ca.SX.sym(name, count) for name, count in (("a", 7), ("v", 9), ("before", 9), ("jump", 3)))
    rates = [v[:2] + rate(centre, a, v[2:]) for centre in CENTRES]
    kinetic = sum(mass / 2 * ca.sumsqr(rate) for mass, rate in zip(MASSES, rates)) + ca.dot(ca.DM(INERTIAS), v[2:] ** 2) / 2
    sticks = ca.vertcat(v[:2] + rate(SWINGS, a, v[2:]), v[2 + NAMES.index("foot")])
    law = ca.hessian(kinetic, v)[0] @ (v - before) - ca.jtimes(sticks, v, jump, True)
    return ca.Function("landing", [a, before, v, jump], [law, sticks])


def guess(s, length):
    """Linear from pose to pose with bent knees, the leg that swings bent more; a row for each part s of the step."""
    s, bend, lean = np.asarray(s)[:, None], 0.3, np.arcsin(length / 2 / (THIGH + SHANK))
    leg = np.array([-bend / 2, bend / 2])
    begin, end = ([0.05, *(side * lean + leg), 0, *(leg - side * lean), 0] for side in (1, -1))
    links = begin + s * (np.array(end) - begin) + np.array([0, -0.3, 0.3, 0.1, 0, 0, 0]) * np.sin(np.pi * s)
    return links @ JOINTS[:6].T


def biped(friction=FRICTION, clearance=CLEARANCE):
    """The robot on ground with this friction, with feet that rise so high halfway (m)."""
    impact, links = landing(), ca.DM(LINKS)
    a, w, length = ca.SX.sym("a", 7), ca.SX.sym("w", 7), ca.SX.sym("length")
    rises = ca.Function("rises", [a, w, length], [ca.jtimes(heights(a, length, clearance), a, w)])

    def ends(length, start, end, after, jump):
        (a_0, w_0), (a_T, w_T) = ((links @ q, links @ v) for q, v in (start, end))
        law, sticks = impact(a_T, ca.vertcat(rate(-STANDS, a_T, w_T), w_T), after, jump)
        zero = [place(SWINGS - STANDS, a_0) - ca.vertcat(-length, 0), start[0] - ca.DM(JOINTS[EXCHANGE]) @ a_T,
                a_T[NAMES.index("foot")], law, sticks, start[1] - ca.DM(JOINTS[EXCHANGE]) @ after[2:]]
        return zero, [cone(friction, jump[:2], jump[2]), rises(a_0, w_0, length), -rises(a_T, w_T, length)]

    return Walker("a biped with soles", 6, MOST, LOWER[:6], UPPER[:6], 9, 3, on_the_ground(friction, clearance), ends, guess,
                  lambda length, time, rates: np.append([length / time, 0], LINKS @ rates))
