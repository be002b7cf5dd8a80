"""Inverse dynamics and frames of a robot as CasADi expressions, by the recursion of Newton and Euler in link frames."""

import casadi as ca
import numpy


def clean(matrix):
    """A constant without the rounding of cos(pi/2) and without its zeros, so that expressions stay short."""
    matrix = numpy.array(matrix, dtype=float)
    for exact in (-1.0, 0.0, 1.0):
        matrix[abs(matrix - exact) < 1e-14] = exact
    return ca.SX(ca.sparsify(ca.DM(matrix)))


def about(axis, angle):
    """Rotation about a unit axis."""
    cross = clean([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return ca.SX.eye(3) + ca.sin(angle) * cross + (1 - ca.cos(angle)) * (cross @ cross)


class Model:
    def __init__(self, robot):
        self.robot, self.n = robot, robot.n
        names = [row["name"] for row in robot.joints]
        self.parents = [names.index(row["parent"]) if row["parent"] else None for row in robot.joints]

    def place(self, i, q):
        """Rotation and origin of frame i in its parent's frame."""
        joint = self.robot.joints[i]
        rotation, origin = clean(joint["placement"]["rotation"]), clean(joint["placement"]["xyz"])
        if joint["type"] == "prismatic":
            return rotation, origin + rotation @ clean(joint["axis"]) * q[i]
        return rotation @ about(joint["axis"], q[i]), origin

    def frames(self, q):
        """Rotation and origin of every joint's frame in the world."""
        found = []
        for i, parent in enumerate(self.parents):
            rotation, origin = self.place(i, q)
            if parent is not None:
                outer, start = found[parent]
                rotation, origin = outer @ rotation, start + outer @ origin
            found.append((rotation, origin))
        return found

    def tool(self, q):
        """Rotation of the tool's frame and its origin in the world."""
        joint, point = self.robot.source.tool
        rotation, origin = self.frames(q)[self.robot.index(joint)]
        return rotation, origin + rotation @ clean(point)

    def torques(self, q, v, a):
        """tau(q, v, a), with armature, springs and friction."""
        motion, forces = [], []
        for i, parent in enumerate(self.parents):
            joint = self.robot.joints[i]
            axis, centre, mass = clean(joint["axis"]), clean(joint["com"]), joint["mass"]
            rotation, origin = self.place(i, q)
            outer = motion[parent] if parent is not None else (ca.SX(3, 1), ca.SX(3, 1), -clean(self.robot.gravity))
            spin, turning, rise = outer
            rise = rotation.T @ (rise + ca.cross(turning, origin) + ca.cross(spin, ca.cross(spin, origin)))
            spin, turning = rotation.T @ spin, rotation.T @ turning
            if joint["type"] == "prismatic":
                rise += axis * a[i] + 2 * ca.cross(spin, axis * v[i])
            else:
                turning += axis * a[i] + ca.cross(spin, axis * v[i])
                spin += axis * v[i]
            motion.append((spin, turning, rise))
            inertia = clean(joint["inertia"])
            force = mass * (rise + ca.cross(turning, centre) + ca.cross(spin, ca.cross(spin, centre)))
            moment = inertia @ turning + ca.cross(spin, inertia @ spin) + ca.cross(centre, force)
            forces.append((force, moment))
        tau = ca.SX(self.n, 1)
        for i in reversed(range(self.n)):
            joint, parent = self.robot.joints[i], self.parents[i]
            force, moment = forces[i]
            tau[i] = ca.dot(clean(joint["axis"]), force if joint["type"] == "prismatic" else moment)
            tau[i] += joint["armature"] * a[i] + joint["spring"]["stiffness"] * (q[i] - joint["spring"]["rest"])
            friction = joint["friction"]
            tau[i] += friction["viscous"] * v[i] + friction["coulomb"] * ca.tanh(v[i] / friction["coulomb_velocity"])
            if parent is not None:
                rotation, origin = self.place(i, q)
                outer_force, outer_moment = forces[parent]
                forces[parent] = (outer_force + rotation @ force, outer_moment + rotation @ moment
                                  + ca.cross(origin, rotation @ force))
        for coupling in self.robot.couplings:
            i, j = (self.robot.index(name) for name in coupling["joints"])
            tau[i] += coupling["armature"] * a[j]
            tau[j] += coupling["armature"] * a[i]
        return tau
