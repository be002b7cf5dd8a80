"""The peer on costate's transcription and mesh: IPOPT solves what costate solves on its last mesh, from the peer's first guess.

`--values` checks that both then find the same motions where no limit is active: those of the same program."""

import tempfile
from pathlib import Path

import numpy

import judge
import robots
from motion import Quartic
from ours import Ours
from peer import Answer, Peer
from quartics import Quartics
from task import Task

# Tolerance of costate that the check's meshes are of, and the relative difference of costs that it allows.
TOLERANCE, WITHIN = 1e-4, 1e-8
LIMIT = 60.0


class SameMesh:
    """A peer that is given costate's answer."""

    def __init__(self, build, limit, tolerance):
        self.peer = Peer(build, limit, tolerance, Quartics)

    def points_of(self, task):
        return self.peer.points_of(task)

    def solve(self, task, answer, times=1):
        mesh = mesh_of(answer)
        if mesh is None:
            return Answer("peer", "no mesh of costate", False, numpy.nan, numpy.nan, 0, 0.0, 0.0)
        return self.peer.solve(task, None, mesh=mesh, times=times)


def mesh_of(answer):
    """Nodes of costate's motion in parts of its time; none where it does not solve the task."""
    if not answer.solved or not isinstance(answer.motion, Quartic):
        return None
    return answer.motion.knots / answer.motion.knots[-1]


def tasks(root, costate):
    """Motions without limits: a given time, a free one, and of six joints with rotors."""
    two, ur5 = (robots.read(root, costate, name) for name in ("two_link", "ur5_armature"))
    turn = Task("quarter_turn", "check", two, numpy.zeros(2), numpy.full(2, numpy.pi / 2), 1.0, numpy.ones(2),
                numpy.full(2, 10.0))
    yield turn
    yield turn.but(name="quarter_turn_free_time", free=True, time_weight=100.0)
    sizes = numpy.array([150.0, 150.0, 150.0, 28.0, 28.0, 28.0])
    yield Task("ur5", "check", ur5, numpy.array([0.0, -1.6, 1.8, -1.8, -1.57, 0.0]),
               numpy.array([1.0, -1.0, 1.2, -1.5, -1.0, 0.5]), 1.0, 1 / sizes**2, sizes)


def check(root, costate, peer):
    """Whether costs agree, by the judge's quadrature of both motions, at all of these tasks."""
    kept, same = True, SameMesh(peer.build, LIMIT, 1e-8)
    with tempfile.TemporaryDirectory() as folder:
        ours = Ours(Path(folder), costate, peer, TOLERANCE, LIMIT, [])
        for task in tasks(root, costate):
            answer = ours.solve(task)
            found = same.solve(task, answer)
            if not (answer.solved and found.solved):
                print(f"{task.name}: {answer.status}; peer on costate's mesh {found.status}: NOT SOLVED", flush=True)
                kept = False
                continue
            costs = [judge.cost(task, side.motion) for side in (answer, found)]
            difference = abs(costs[1] / costs[0] - 1)
            kept &= difference <= WITHIN
            print(f"{task.name}: costate {costs[0]:.10g}; peer on its mesh of {len(mesh_of(answer)) - 1} intervals "
                  f"{costs[1]:.10g}, {difference:.1e}: {'right' if difference <= WITHIN else 'WRONG'}", flush=True)
    return kept
