"""A URDF, read by Pinocchio, as text for peers/pinocchio.cpp and as numbers for the symbolic models of CasADi."""

import random

import feet
import numpy
import pinocchio


class Robot:
    """Joints in order: kind, parent (0 is the world), axis, placement, mass, centre of mass, inertia about it. Some links
    stand on the ground, each where it is in one pose (feet.py)."""

    def __init__(self, path, standing=()):
        self.model = pinocchio.buildModelFromUrdf(str(path))
        self.nq, self.n = self.model.nq, self.model.nv
        self.gravity = self.model.gravity.linear
        self.feet = feet.Feet(self.model, standing)
        self.joints = []
        data = self.model.createData()
        # The joint's own motion vector at q = 0 in its frame.
        pinocchio.computeJointJacobians(self.model, data, pinocchio.neutral(self.model))
        for i in range(1, self.model.njoints):
            joint = self.model.joints[i]
            kind = joint.shortname()
            inertia = self.model.inertias[i]
            placement = self.model.jointPlacements[i]
            jacobian = pinocchio.getJointJacobian(self.model, data, i, pinocchio.LOCAL)[:, joint.idx_v]
            slides = "P" in kind.removeprefix("JointModel")[:1]
            axis = jacobian[:3] if slides else jacobian[3:]
            self.joints.append((kind, self.model.parents[i], axis, placement.rotation, placement.translation,
                                inertia.mass, inertia.lever, inertia.inertia))

    def text(self):
        rows = [str(len(self.joints)), numbers(self.gravity)]
        for kind, parent, axis, rotation, translation, mass, lever, inertia in self.joints:
            rows += [f"{kind} {parent}", numbers(axis), numbers(rotation), numbers(translation), repr(float(mass)),
                     numbers(lever), numbers(inertia)]
        rows.append(str(len(self.feet.all)))
        for foot in self.feet.all:
            rows.append(str(foot.joint))
            for placement in (foot.in_joint, foot.in_world):
                rows += [numbers(placement.rotation), numbers(placement.translation)]
        return "\n".join(rows) + "\n"

    def stance(self):
        """Of each link that stands: its name, and where it stands (position; roll, pitch and yaw)."""
        places = [(foot.link, foot.in_world) for foot in self.feet.all]
        return "".join(f"{link} {numbers(place.translation)} {numbers(pinocchio.rpy.matrixToRpy(place.rotation))}\n"
                       for link, place in places)

    def states(self, count, seed):
        """q, v, p = M v, u, a, y of each state, one a line."""
        rng = random.Random(seed)
        data = self.model.createData()
        draw = lambda size, n: numpy.array([rng.uniform(-size, size) for _ in range(n)])
        lines = []
        for _ in range(count):
            q, v = self.feet.stand(self.position(draw), draw(2.0, self.n), draw)
            u, a = draw(10.0, self.n), draw(5.0, self.n)
            y = draw(1.0, 2 * self.n)
            m = pinocchio.crba(self.model, data, q)
            m = numpy.triu(m) + numpy.triu(m, 1).T
            lines.append(numbers(numpy.concatenate([q, v, m @ v, u, a, y])))
        return "\n".join(lines) + "\n"

    def position(self, draw):
        """Coordinates of joints within 3 rad or 3 m, quaternions of any direction."""
        parts = []
        for joint in list(self.model.joints)[1:]:
            part = draw(3.0, joint.nv)
            if joint.nq > joint.nv:
                quaternion = draw(1.0, 4)
                part = numpy.concatenate([part[:3], quaternion / numpy.linalg.norm(quaternion)])
            parts.append(part)
        return numpy.concatenate(parts)


def numbers(values):
    return " ".join(repr(float(value)) for value in numpy.asarray(values).flatten())
