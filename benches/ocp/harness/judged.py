"""Whether the judge tells what it should, of a motion that is known: a cubic in the time, as costate would print it and as a
collocation has it."""

import numpy

import radau
import robots
import shapes
from judge import Judge
from motion import Collocated, Quartic
from task import Task

# Elements of the collocation, and nodes of unequal intervals.
ELEMENTS, NODES = 40, numpy.array([0.0, 0.1, 0.15, 0.4, 0.6, 0.65, 1.0])
# By this share the largest torque at costate's points exceeds its limit, and that of the range which is told.
OVER = 1e-3
# What is told may be off by this, relative; of the miss with torques held 1e-2, or 1e-7 of the size of the motion.
WITHIN, WITHIN_HELD, ROUNDING = 1e-9, 1e-2, 1e-7


def check(root, costate, peer):
    """Whether everything is as it must be."""
    kept = True
    for name in ("two_link", "puma560"):
        robot = robots.read(root, costate, name)
        one = numpy.ones(robot.n)
        task = Task(name, "check", robot, 0.2 * one, 0.9 * one, 1.3, one, one)
        for what, right in findings(task, peer).items():
            kept &= right
            print(f"judge, {name}: {what}: {'right' if right else 'WRONG'}", flush=True)
    return kept


def findings(task, peer):
    judge, torques = Judge(peer), lambda *z: peer.torques(task, *z)
    at = lambda s: shapes.motion(shapes.cubic, task.q_start, task.q_end, task.duration, s)
    rows = (NODES[:-1, None] + numpy.diff(NODES)[:, None] * Quartic.PLACES).ravel()
    ours = Quartic(rows * task.duration, *at(rows)[:2], torques)
    mesh = numpy.linspace(0, 1, ELEMENTS + 1)
    q, v, a = at((mesh[:-1, None] + radau.POINTS / ELEMENTS).ravel())
    theirs = Collocated(mesh, task.duration, numpy.concatenate([task.q_start, task.v_start]), q, v, torques(q, v, a))
    found, other = judge.judge(task, ours), judge.judge(task, theirs)
    same = abs(found.held - other.held) <= WITHIN_HELD * found.held + ROUNDING
    # Torques of the motion itself, not those that limits leave of it.
    inner = rows.reshape(-1, 5)[:, 1:4].ravel()
    peak = abs(torques(*at(inner))).max(0)
    limited = judge.judge(task.but(u_min=-peak / (1 + OVER), u_max=peak / (1 + OVER)), ours)
    rate = abs(v).max(0)
    fast = judge.judge(task.but(v_max=rate / (1 + OVER)), theirs)
    cut = judge.judge(task.but(u_min=-0.5 * peak, u_max=0.5 * peak), ours)
    return {
        f"gap {found.gap:.0e}, of the collocation {other.gap:.0e}": found.gap < 1e-9 and other.gap < 1e-5,
        f"miss with torques held {found.held:.2e}, of the collocation {other.held:.2e}": same and found.held > 0,
        f"a limit exceeded by {limited.at_points:.2e} of its range at points": abs(limited.at_points / (OVER / 2) - 1) < WITHIN,
        f"a limit of rates exceeded by {fast.states:.2e} of its range":
            abs(fast.states / (OVER / 2) - 1) < 1e-3 and fast.between == fast.states and limited.states == 0.0,
        f"with half of the torques miss {cut.held:.4e}, gap {cut.cut:.4e}":
            cut.held > 1e-2 and abs(cut.held - cut.cut) < WITHIN_HELD * cut.cut and found.cut == found.gap == cut.gap,
        f"cost {found.cost:.8g}, of the collocation {other.cost:.8g}": abs(found.cost - other.cost) < 1e-6 * found.cost,
    }
