"""L(q, v) of a chain or tree as CasADi expressions, and other symbolic models, from harness/describe.py."""

import casadi as ca
import numpy


def clean(matrix):
    """A constant without the rounding of cos(pi/2) and without its zeros."""
    matrix = numpy.array(matrix, dtype=float)
    for exact in (-1.0, 0.0, 1.0):
        matrix[abs(matrix - exact) < 1e-14] = exact
    return ca.sparsify(ca.DM(matrix))


def turned(axis):
    """A rotation that takes z to the axis."""
    axis = numpy.array(axis) / numpy.linalg.norm(axis)
    if abs(axis[2] - 1) < 1e-14:
        return numpy.eye(3)
    other = numpy.eye(3)[numpy.argmin(abs(axis))]
    x = numpy.cross(other, axis)
    x /= numpy.linalg.norm(x)
    return numpy.stack([x, numpy.cross(axis, x), axis], axis=1)


class Links:
    """Constants in frames turned so that every joint axis is z: fixed rotation and translation, mass, mass times centre of
    mass, inertia about the origin."""

    def __init__(self, robot):
        self.n = robot.n
        self.gravity = clean(robot.gravity)
        turns = [numpy.eye(3)]
        self.links = []
        for kind, parent, axis, rotation, translation, mass, lever, inertia in robot.joints:
            turn = turned(axis)
            turns.append(turn)
            back = turns[parent].T
            c = turn.T @ lever
            about = turn.T @ inertia @ turn + mass * (c @ c * numpy.eye(3) - numpy.outer(c, c))
            slides = kind.startswith("JointModelP")
            self.links.append((slides, parent, clean(back @ rotation @ turn), clean(back @ translation), mass,
                               clean(mass * c), clean(about)))


def about_z(q):
    c, s = ca.cos(q), ca.sin(q)
    r = ca.SX(3, 3)
    r[0, 0], r[0, 1], r[1, 0], r[1, 1], r[2, 2] = c, -s, s, c, 1
    return r


def z(value):
    vector = ca.SX(3, 1)
    vector[2] = value
    return vector


def lagrangian(links, q, v):
    """L = 1/2 v'Mv - V, in body frames: velocities and gravity are carried from parent to child."""
    w, o, g, height = [ca.SX(3, 1)], [ca.SX(3, 1)], [ca.SX(links.gravity)], [ca.SX(0)]
    total = 0
    for i, (slides, parent, r, t, mass, mc, inertia) in enumerate(links.links):
        wp, op, gp = w[parent], o[parent], g[parent]
        back = r.T if slides else about_z(q[i]).T @ r.T
        offset = t + r @ z(q[i]) if slides else t
        wi = back @ wp
        oi = back @ (op + ca.cross(wp, offset))
        if slides:
            oi += z(v[i])
        else:
            wi += z(v[i])
        gi = back @ gp
        hi = height[parent] + ca.dot(gp, offset)
        w.append(wi), o.append(oi), g.append(gi), height.append(hi)
        total += mass * (ca.dot(oi, oi) / 2 + hi) + ca.dot(oi, ca.cross(wi, mc)) + ca.dot(wi, inertia @ wi) / 2
        total += ca.dot(gi, mc)
    return total


def torques(links, q, v, a):
    """Inverse dynamics by the recursive Newton-Euler algorithm, in body frames."""
    n = links.n
    w, dw, acc, frames = [ca.SX(3, 1)], [ca.SX(3, 1)], [-ca.SX(links.gravity)], [None]
    force, moment = [None], [None]
    for i, (slides, parent, r, t, mass, mc, inertia) in enumerate(links.links):
        wp, dwp, ap = w[parent], dw[parent], acc[parent]
        turn = r if slides else r @ about_z(q[i])
        back = turn.T
        offset = t + r @ z(q[i]) if slides else t
        wi, dwi = back @ wp, back @ dwp
        ai = back @ (ap + ca.cross(dwp, offset) + ca.cross(wp, ca.cross(wp, offset)))
        if slides:
            ai += z(a[i]) + 2 * ca.cross(wi, z(v[i]))
        else:
            dwi += z(a[i]) + ca.cross(wi, z(v[i]))
            wi = wi + z(v[i])
        w.append(wi), dw.append(dwi), acc.append(ai), frames.append((turn, offset))
        force.append(mass * ai + ca.cross(dwi, mc) + ca.cross(wi, ca.cross(wi, mc)))
        moment.append(inertia @ dwi + ca.cross(wi, inertia @ wi) + ca.cross(mc, ai))
    tau = [None] * n
    for i in reversed(range(n)):
        slides, parent = links.links[i][:2]
        f, m = force[i + 1], moment[i + 1]
        tau[i] = f[2] if slides else m[2]
        if parent:
            turn, offset = frames[i + 1]
            force[parent] += turn @ f
            moment[parent] += turn @ m + ca.cross(offset, turn @ f)
    return ca.vertcat(*tau)


class Factor:
    """M = L'DL from the last joint to the first (no fill-in on a tree), L unit lower triangular."""

    def __init__(self, m):
        n = m.shape[0]
        m = ca.SX(m)
        self.n, self.inverse_d, self.lower = n, [None] * n, ca.SX(n, n)
        for k in reversed(range(n)):
            self.inverse_d[k] = 1 / m[k, k]
            for i in range(k):
                self.lower[k, i] = m[k, i] * self.inverse_d[k]
            for i in range(k):
                for j in range(i + 1):
                    m[i, j] -= self.lower[k, i] * m[k, j]

    def solve(self, b):
        b = ca.SX(b)
        for k in reversed(range(self.n)):
            for i in range(k):
                b[i, :] -= self.lower[k, i] * b[k, :]
        for k in range(self.n):
            b[k, :] *= self.inverse_d[k]
            for i in range(k):
                b[k, :] -= self.lower[k, i] * b[i, :]
        return b

    def inverse(self):
        """M^-1, each pair of entries computed once."""
        inverse = ca.SX(self.n, self.n)
        for k in range(self.n):
            for j in range(k + 1):
                entry = self.inverse_d[k] if j == k else 0
                for i in range(k):
                    entry -= self.lower[k, i] * inverse[i, j]
                inverse[k, j] = inverse[j, k] = entry
        return inverse


def symmetric(m):
    """A symmetric matrix without the second computation of its lower half."""
    return ca.triu2symm(ca.triu(m))


def mass_matrix(links, q):
    """M by the composite rigid body algorithm, in body frames."""
    n = links.n
    frames, composite = [None], [None]
    for i, (slides, parent, r, t, mass, mc, inertia) in enumerate(links.links):
        turn = ca.SX(r) if slides else r @ about_z(q[i])
        offset = t + r @ z(q[i]) if slides else ca.SX(t)
        frames.append((turn, offset, parent))
        composite.append([ca.SX(mass), ca.SX(mc), ca.SX(inertia)])
    m = ca.SX(n, n)
    for j in reversed(range(1, n + 1)):
        mass, mc, inertia = composite[j]
        slides = links.links[j - 1][0]
        axis = z(1)
        if slides:
            force, moment = mass * axis, ca.cross(mc, axis)
        else:
            force, moment = ca.cross(axis, mc), inertia[:, 2]
        i = j
        while True:
            m[i - 1, j - 1] = m[j - 1, i - 1] = force[2] if links.links[i - 1][0] else moment[2]
            turn, offset, parent = frames[i]
            if not parent:
                break
            force, moment = turn @ force, turn @ moment
            moment += ca.cross(offset, force)
            i = parent
        turn, offset, parent = frames[j]
        if parent:
            mc = turn @ mc
            inertia = turn @ inertia @ turn.T
            cross = ca.dot(mc, offset)
            outer = mc @ offset.T
            shift = 2 * cross + mass * ca.dot(offset, offset)
            inertia += shift * ca.SX.eye(3) - outer - outer.T - mass * offset @ offset.T
            composite[parent][0] += mass
            composite[parent][1] += mc + mass * offset
            composite[parent][2] += inertia
    return m
