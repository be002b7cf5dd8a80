"""Peers on costate's last mesh, from the peer's first guess: IPOPT solves what costate solves there, in two forms of its program.

`--values` checks that both then find the same motions where no limit is active: those of the same program."""

import tempfile
from pathlib import Path

import numpy

import judge
import robots
from eliminated import Eliminated
from motion import Quartic
from ours import Ours
from peer import Answer, Peer
from quartics import Quartics
from solvers import LIMIT, Ipopt
from task import Task

# Tolerance of costate that the check's meshes are of, and the relative difference of costs that it allows.
TOLERANCE, WITHIN = 1e-4, 1e-8
# Costs of the two forms that differ by less count as equal, relative.
NEAR = 1e-4


def forms(build, solver):
    """Peers with costate's own transcription. Neither of the two forms of the program is always the faster one."""
    return [Peer(build, solver, form) for form in (Quartics, Eliminated)]


class SameMesh:
    """Peers that are given costate's answer. All are solved, and the answer is that of the fastest one whose cost is not above
    the others'."""

    def __init__(self, *peers):
        self.peers = peers

    def prepare(self, task):
        for peer in self.peers:
            peer.prepare(task)

    def solve(self, task, answer, times=1):
        mesh = mesh_of(answer)
        if mesh is None:
            return Answer("peer", "no mesh of costate", False, numpy.nan, numpy.nan, 0, 0.0, 0.0)
        answers = [peer.solve(task, None, mesh=mesh, times=times) for peer in self.peers]
        least = min((answer.cost for answer in answers if answer.solved), default=numpy.nan)
        kept = [answer for answer in answers if answer.solved and answer.cost <= least + NEAR * abs(least)]
        return min(kept or answers, key=lambda answer: answer.seconds)


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
    kept, peers = True, forms(peer.build, Ipopt())
    with tempfile.TemporaryDirectory() as folder:
        ours = Ours(Path(folder), costate, peer, TOLERANCE, LIMIT, [])
        for task in tasks(root, costate):
            answer = ours.solve(task)
            mesh = mesh_of(answer)
            for form in peers if mesh is not None else []:
                found = form.solve(task, None, mesh=mesh)
                costs = [judge.cost(task, side.motion) for side in (answer, found)]
                difference = abs(costs[1] / costs[0] - 1) if found.solved else numpy.inf
                kept &= difference <= WITHIN
                print(f"{task.name}: costate {costs[0]:.10g}; peer, {form.transcription.__name__}, on its mesh of "
                      f"{len(mesh) - 1} intervals {costs[1]:.10g}, {difference:.1e}: "
                      f"{'right' if difference <= WITHIN else 'WRONG'}", flush=True)
            if mesh is None:
                print(f"{task.name}: costate {answer.status}: NOT SOLVED", flush=True)
                kept = False
    return kept
