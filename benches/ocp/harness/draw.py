"""What every task begins with: a robot at rest at a random configuration, to be at rest at another one."""

import math
from dataclasses import dataclass

import numpy

import shapes
from task import Task

# Where a joint has no position limits it turns within these (rad); a prismatic one within a metre.
SPAN = {"revolute": 2.0, "continuous": 2.0, "prismatic": 0.5}
# Starts and ends lie in the middle of the range, this share of it.
MIDDLE = 0.7
# Largest distance of a joint in parts of its middle range, and in rad or m.
DISTANCE, FARTHEST = 0.6, 1.5
# Size of a torque (N m) where neither the file nor the motion gives one.
LEAST_TORQUE = 1e-3
GRID = numpy.linspace(0, 1, 201)
# The peer's motion without limits: elements of its mesh, and iterations; a draw that needs more is not taken.
ELEMENTS, ITERATIONS = 15, 150
MANY = 8
# Torques of straight motions are judged with ramps of half a cosine over these shares of the time.
RAMPS = (0.2, 0.3, 0.4, 0.5)


@dataclass
class Draw:
    """A random number generator, the robot, and the peer's functions."""
    rng: numpy.random.Generator
    robot: object
    peer: object
    name: str
    kind: str
    # Whether the peer did not find the motion without limits.
    peer_failed: bool = False

    def ends(self):
        low, high = [], []
        for joint, lower, upper in zip(self.robot.joints, self.robot.limits("lower"), self.robot.limits("upper")):
            span = SPAN[joint["type"]]
            lower, upper = max(lower, -2 * math.pi), min(upper, 2 * math.pi)
            if not (math.isfinite(lower) and math.isfinite(upper)) or upper - lower >= 4 * math.pi - 0.1:
                lower, upper = -span, span
            middle, half = (lower + upper) / 2, MIDDLE * (upper - lower) / 2
            low.append(middle - half), high.append(middle + half)
        low, high = numpy.array(low), numpy.array(high)
        start = self.rng.uniform(low, high)
        step = numpy.minimum(DISTANCE * (high - low), FARTHEST)
        end = numpy.clip(start + self.rng.uniform(-step, step), low, high)
        return round_to(start), round_to(end)

    def effort_limits(self):
        """Those of the file, infinite where there is none."""
        return numpy.array(self.robot.limits("effort"))

    def free_task(self, shortest=0.5, longest=1.5, **changes):
        """Effort with weights 1/size^2 of each torque: the limit of the file, or the peak of a straight motion."""
        start, end = self.ends()
        duration = round(self.rng.uniform(shortest, longest), 2)
        one = numpy.ones(self.robot.n)
        task = Task(self.name, self.kind, self.robot, start, end, duration, one, one)
        peak = self.straight(task, shapes.cubic)[1]
        size = numpy.where(numpy.isfinite(self.effort_limits()), self.effort_limits(), peak)
        size = round_to(numpy.maximum(size, max(LEAST_TORQUE, 1e-3 * size.max())))
        task = task.but(torque_size=size, effort=round_to(1 / size**2, 6), **changes)
        if not self.robot.source.bounded:
            return task
        return self.bounded(task, self.straight(task, shapes.ramps(RAMPS[0]))[1])

    def bounded(self, task, peak):
        """With torques bounded by limits of the file, or by 1.5 times these peaks."""
        limits = self.effort_limits()
        bounds = round_to(numpy.where(numpy.isfinite(limits), limits, 1.5 * peak + 1e-3 * task.torque_size))
        return task.but(u_min=-bounds, u_max=bounds)

    def straight(self, task, shape, duration=None):
        """Peaks of rates and torques of a straight motion."""
        q, v, a = shapes.motion(shape, task.q_start, task.q_last, duration or task.duration, GRID)
        return abs(v).max(0), abs(self.peer.torques(task, q, v, a)).max(0)

    def unlimited(self, task):
        """The peer's motion of a task without limits; None if it finds none. For more than MANY joints, where it may search
        for minutes and light links whirl, a stand-in: the straight motion with rates and torques of twice their size."""
        if self.robot.n <= MANY:
            answer = self.peer.solve(task, ELEMENTS, **{"ipopt.max_iter": ITERATIONS})
            if not answer.solved:
                self.peer_failed = True
                return None
            motion = answer.motion
            way = numpy.array([motion.at(s * task.duration)[0][: self.robot.n] for s in GRID[::4]])
            return Unlimited(abs(motion.v).max(0), abs(motion.u).max(0), motion.q.min(0), motion.q.max(0), way)
        rates, torques = self.straight(task, shapes.cubic)
        way = shapes.motion(shapes.cubic, task.q_start, task.q_end, task.duration, GRID[::4])[0]
        return Unlimited(2 * rates, 2 * torques, way.min(0) - 0.1, way.max(0) + 0.1, way)


@dataclass
class Unlimited:
    """Peaks of rates and torques of a motion without limits, the range of its positions, and positions along it."""
    rates: numpy.ndarray
    torques: numpy.ndarray
    low: numpy.ndarray
    high: numpy.ndarray
    way: numpy.ndarray


def round_to(values, digits=3):
    """To this number of digits: tasks must not depend on the last ones of a solver."""
    values = numpy.asarray(values, dtype=float)
    return numpy.array([float(f"{value:.{digits}g}") for value in values.ravel()]).reshape(values.shape)


def between(low, high, share):
    return low + share * (high - low)
