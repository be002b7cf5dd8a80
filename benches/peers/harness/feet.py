"""Links that stand on the ground: where, and states in which they do."""

from dataclasses import dataclass

import numpy
import pinocchio

LINKS = ("left_ankle_roll_link", "right_ankle_roll_link")
# The pose whose feet are the places on the ground: knees bent.
BENT = {"hip_pitch": -0.4, "knee": 0.8, "ankle_pitch": -0.4}


@dataclass
class Foot:
    link: str
    frame: int
    joint: int
    in_joint: pinocchio.SE3
    in_world: pinocchio.SE3


class Feet:
    """Of a model whose first joint is a free flyer; without any, states stay as they are."""

    def __init__(self, model, links):
        self.model, self.data = model, model.createData()
        self.bent = pinocchio.neutral(model)
        self.all = []
        if not links:
            return
        for joint in list(model.joints)[1:]:
            name = model.names[joint.id]
            for end, angle in BENT.items():
                if name.endswith(end):
                    self.bent[joint.idx_q] = angle
        pinocchio.framesForwardKinematics(model, self.data, self.bent)
        for link in links:
            frame = model.getFrameId(link)
            of = model.frames[frame]
            self.all.append(Foot(link, frame, of.parentJoint, of.placement, self.data.oMf[frame].copy()))
        # Joints on the way from the free flyer to a foot: they move so that the feet stand.
        self.legs = sorted({joint for foot in self.all for joint in model.supports[foot.joint] if joint > 1})

    def stand(self, q, v, draw):
        """A position and velocity near these in which the feet stand still."""
        if not self.all:
            return q, v
        q = q.copy()
        legs = [self.model.joints[joint] for joint in self.legs]
        q[:7] = pinocchio.integrate(self.model, self.bent, numpy.concatenate([draw(0.06, 6), numpy.zeros(self.model.nv - 6)]))[:7]
        for joint in legs:
            q[joint.idx_q] = self.bent[joint.idx_q] + draw(0.1, 1)[0]
        columns = [joint.idx_v for joint in legs]
        for _ in range(50):
            error, jacobian = self.errors(q)
            if abs(error).max() < 1e-14:
                break
            step = numpy.zeros(self.model.nv)
            step[columns] = -numpy.linalg.lstsq(jacobian[:, columns], error, rcond=None)[0]
            q = pinocchio.integrate(self.model, q, step)
        if abs(error).max() > 1e-12:
            raise RuntimeError("the feet cannot be put on the ground")
        _, jacobian = self.errors(q)
        return q, v - numpy.linalg.pinv(jacobian) @ (jacobian @ v)

    def errors(self, q):
        """Twists from the feet to their places, and the Jacobian of the feet, both in their axes."""
        jacobian = pinocchio.computeJointJacobians(self.model, self.data, q)
        pinocchio.updateFramePlacements(self.model, self.data)
        errors = [pinocchio.log6(foot.in_world.inverse() * self.data.oMf[foot.frame]).vector for foot in self.all]
        jacobian = [pinocchio.getFrameJacobian(self.model, self.data, foot.frame, pinocchio.LOCAL) for foot in self.all]
        return numpy.concatenate(errors), numpy.concatenate(jacobian)
