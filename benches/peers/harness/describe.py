"""A URDF, read by Pinocchio, as text for peers/pinocchio.cpp and as numbers for the symbolic models of CasADi."""

import random

import numpy
import pinocchio


class Robot:
    """Joints in order: kind, parent (0 is the world), axis, placement, mass, centre of mass, inertia about it."""

    def __init__(self, path):
        self.model = pinocchio.buildModelFromUrdf(str(path))
        self.n = self.model.nv
        self.gravity = self.model.gravity.linear
        self.joints = []
        data = self.model.createData()
        # The joint's own motion vector at q = 0 in its frame.
        pinocchio.computeJointJacobians(self.model, data, numpy.zeros(self.model.nq))
        for i in range(1, self.model.njoints):
            kind = self.model.joints[i].shortname()
            inertia = self.model.inertias[i]
            placement = self.model.jointPlacements[i]
            jacobian = pinocchio.getJointJacobian(self.model, data, i, pinocchio.LOCAL)[:, i - 1]
            slides = "P" in kind.removeprefix("JointModel")[:1]
            axis = jacobian[:3] if slides else jacobian[3:]
            self.joints.append((kind, self.model.parents[i], axis, placement.rotation, placement.translation,
                                inertia.mass, inertia.lever, inertia.inertia))

    def text(self):
        rows = [str(self.n), numbers(self.gravity)]
        for kind, parent, axis, rotation, translation, mass, lever, inertia in self.joints:
            rows += [f"{kind} {parent}", numbers(axis), numbers(rotation), numbers(translation), repr(float(mass)),
                     numbers(lever), numbers(inertia)]
        return "\n".join(rows) + "\n"

    def states(self, count, seed):
        """q, v, p = M v, u, a, y of each state, one a line."""
        rng = random.Random(seed)
        data = self.model.createData()
        draw = lambda size, n: numpy.array([rng.uniform(-size, size) for _ in range(n)])
        lines = []
        for _ in range(count):
            q, v, u, a = draw(3.0, self.n), draw(2.0, self.n), draw(10.0, self.n), draw(5.0, self.n)
            y = draw(1.0, 2 * self.n)
            m = pinocchio.crba(self.model, data, q)
            m = numpy.triu(m) + numpy.triu(m, 1).T
            lines.append(numbers(numpy.concatenate([q, v, m @ v, u, a, y])))
        return "\n".join(lines) + "\n"


def numbers(values):
    return " ".join(repr(float(value)) for value in numpy.asarray(values).flatten())
