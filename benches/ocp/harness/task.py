"""One motion to be found: ends, cost, limits, obstacles."""

from dataclasses import dataclass, field, replace

import casadi as ca
import numpy

from model import Model


@dataclass
class Tool:
    """Where the tool must end: position (m, a coordinate that is None is free) and, unless None, rotation matrix."""
    position: tuple
    rotation: object = None


@dataclass
class Task:
    name: str
    kind: str
    robot: object
    q_start: numpy.ndarray
    q_end: numpy.ndarray | None
    duration: float
    effort: numpy.ndarray
    torque_size: numpy.ndarray
    free: bool = False
    time_weight: float = 0.0
    # End of the first guess where the tool is given.
    q_guess: numpy.ndarray | None = None
    tool: Tool | None = None
    q_min: numpy.ndarray | None = None
    q_max: numpy.ndarray | None = None
    v_max: numpy.ndarray | None = None
    a_max: numpy.ndarray | None = None
    u_min: numpy.ndarray | None = None
    u_max: numpy.ndarray | None = None
    # Whether limits are those of the robot's file, as far as it has them.
    from_robot: bool = False
    # (centre, radius) of each (m).
    obstacles: list = field(default_factory=list)
    # The radius of each sphere of the robot (m).
    own_radius: float = 0.0
    # Draws that were made for it, this one included, and those among them that were thrown away because the peer did not find
    # the motion without limits.
    draws: int = 1
    peer_failed: int = 0

    def __post_init__(self):
        infinite = numpy.full(self.n, numpy.inf)
        for name, missing in (("q_min", -infinite), ("q_max", infinite), ("v_max", infinite), ("a_max", infinite),
                              ("u_min", -infinite), ("u_max", infinite)):
            if getattr(self, name) is None:
                setattr(self, name, missing)
        self.v_start, self.v_end = numpy.zeros(self.n), numpy.zeros(self.n)

    @property
    def n(self):
        return self.robot.n

    @property
    def q_last(self):
        """Where the first guess ends."""
        return self.q_end if self.q_end is not None else self.q_guess

    def but(self, **changes):
        return replace(self, **changes)

    @property
    def obstacles_flat(self):
        """Centre and sum of the radii of each obstacle, one after the other."""
        return [number for centre, radius in self.obstacles for number in (*centre, radius + self.own_radius)]

    def end_conditions(self, q):
        """What is zero at the end, besides what is given of q and v: position of the tool, rotation vector times sine."""
        if self.tool is None:
            return ca.SX(0, 1)
        rotation, position = Model(self.robot).tool(q)
        rows = [position[i] - value for i, value in enumerate(self.tool.position) if value is not None]
        if self.tool.rotation is not None:
            turn = ca.SX(ca.DM(self.tool.rotation)).T @ rotation
            rows += [(turn[k, j] - turn[j, k]) / 2 for j, k in ((1, 2), (2, 0), (0, 1))]
        return ca.vertcat(*rows)

    @property
    def end_rows(self):
        return self.end_conditions(ca.SX.sym("q", self.n)).numel()
