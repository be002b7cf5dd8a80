"""The classes of tasks. Each function draws one task, or gives None where the draw does not suit: then another is drawn.

Every task is feasible by construction: a smooth straight motion (with a detour, for obstacles) meets all its limits,
and limits are set between that motion and the optimum without them, so that they are active."""

import casadi as ca
import numpy

import obstacles
import shapes
from draw import GRID, RAMPS, between, round_to
from model import Model
from task import Tool

# Limits stand this share of the way from the feasible motion's peak to that of the free optimum.
SHARE = (0.25, 0.75)
# Least excess of the free optimum over a limit, in parts of the limit, for a limit to count as active.
ACTIVE = 0.02
# What the feasible motion keeps from a limit.
MARGIN = 1.02
# A free optimum may whirl a light wrist round at hundreds of rad/s: its peaks count up to this many times those of the
# feasible motion.
LARGEST = 3.0


def effort(draw):
    return draw.free_task(from_robot=False)


def bounded_torques(draw):
    """Bounds between the peaks of the feasible motion with the gentlest ramps and those of the free optimum."""
    task = draw.free_task()
    found = draw.unlimited(task)
    if found is None:
        return None
    peaks = found.torques
    bounds = torque_bounds(draw, task, peaks)
    if not (peaks > (1 + ACTIVE) * bounds).any():
        return None
    return task.but(u_min=-bounds, u_max=bounds)


def torque_bounds(draw, task, peaks):
    every = (draw.straight(task, shapes.ramps(share))[1] for share in RAMPS)
    feasible = min(every, key=lambda found: (found / peaks).max())
    return limits_between(draw, MARGIN * feasible + 1e-3 * task.torque_size, peaks)


def limits_between(draw, feasible, peaks):
    """Between the peaks of both motions, or just above the feasible one's where they are the larger ones."""
    share = draw.rng.uniform(*SHARE, len(peaks))
    limits = between(feasible, numpy.minimum(peaks, LARGEST * feasible), share)
    return round_to(numpy.where(peaks > feasible, limits, 1.1 * feasible))


def least_time(draw):
    """Bounds: limits of the file, or 1.5 times the torques of the straight motion; it keeps them in the guessed time."""
    task = draw.free_task()
    task = draw.bounded(task, draw.straight(task, shapes.cubic)[1])
    duration = task.duration
    for _ in range(20):
        if (draw.straight(task, shapes.cubic, duration)[1] <= 0.98 * task.u_max).all():
            return task.but(effort=numpy.zeros(task.n), time_weight=1.0, free=True, duration=round(duration, 3))
        duration *= 1.2
    return None


def time_and_effort(draw):
    """Weight of time: three times effort over duration; for a mass without gravity the guess would be the best duration."""
    task = draw.free_task()
    q, v, a = shapes.motion(shapes.cubic, task.q_start, task.q_end, task.duration, GRID)
    u = draw.peer.torques(task, q, v, a)
    spent = float((task.effort * u**2).sum(1).mean() / 2)
    return task.but(free=True, time_weight=float(round_to(3 * spent)))


def rates(draw):
    """Limits between the rates of the feasible motion and those of the free optimum."""
    task = draw.free_task()
    found = draw.unlimited(task)
    if found is None:
        return None
    peaks = found.rates
    feasible = numpy.maximum(MARGIN * draw.straight(task, shapes.ramps(RAMPS[0]))[0], 1e-2)
    limits = limits_between(draw, feasible, peaks)
    return task.but(v_max=limits) if (peaks > (1 + ACTIVE) * limits).any() else None


def positions(draw):
    """Limits between the ends, which a straight motion never leaves, and how far the free optimum goes beyond them."""
    task = draw.free_task()
    found = draw.unlimited(task)
    if found is None:
        return None
    low, high = numpy.minimum(task.q_start, task.q_end), numpy.maximum(task.q_start, task.q_end)
    beyond_low, beyond_high = low - found.low, found.high - high
    share = draw.rng.uniform(*SHARE, task.n)
    least = 0.02
    q_min = numpy.where(beyond_low > least, low - share * beyond_low, low - least - 0.1)
    q_max = numpy.where(beyond_high > least, high + share * beyond_high, high + least + 0.1)
    if not ((beyond_low > least) | (beyond_high > least)).any():
        return None
    # Outwards, so that the ends stay inside.
    return task.but(q_min=numpy.floor(1e4 * q_min) / 1e4, q_max=numpy.ceil(1e4 * q_max) / 1e4)


def robot_limits(draw):
    """All limits of the robot's file, T from 0.5 to 3 s, and limits between the straight motion's and 1.5 times it where the
    file has none; every second task has unit weights, as somebody writes who tries the robot for the first time."""
    task = draw.free_task(0.5, 3.0)
    speed, torque = draw.straight(task, shapes.ramps(0.3))
    v_limit, u_limit = (numpy.array(draw.robot.limits(key)) for key in ("velocity", "effort"))
    for _ in range(12):
        if (speed <= 0.95 * v_limit).all() and (torque <= 0.95 * u_limit).all():
            break
        # Half the way, the same time.
        task = task.but(q_end=round_to(between(task.q_start, task.q_end, 0.7)))
        speed, torque = draw.straight(task, shapes.ramps(0.3))
    else:
        return None
    share = draw.rng.uniform(1.05, 1.5, task.n)
    v_max = numpy.where(numpy.isfinite(v_limit), v_limit, round_to(share * speed + 1e-2))
    u_max = numpy.where(numpy.isfinite(u_limit), u_limit, round_to(share * torque + 1e-2 * task.torque_size))
    weights = task.effort if draw.rng.random() < 0.5 else numpy.ones(task.n)
    return task.but(v_max=v_max, u_min=-u_max, u_max=u_max, q_min=numpy.array(draw.robot.limits("lower")),
                    q_max=numpy.array(draw.robot.limits("upper")), effort=weights, from_robot=True)


def tool_pose(draw):
    """The tool's pose at a random configuration; the first guess ends at another one nearby. Arms of six joints and more are
    given position and orientation, others and the biped's foot the position, the two-link arm its two coordinates."""
    task = draw.free_task()
    q = ca.SX.sym("q", task.n)
    rotation, position = ca.Function("tool", [q], list(Model(draw.robot).tool(q)))(task.q_end)
    position = [float(value) for value in round_to(numpy.array(position).ravel(), 6)]
    if task.n == 2:
        position[2] = None
    oriented = task.n in (6, 7)
    guess = round_to(task.q_end + draw.rng.uniform(-0.2, 0.2, task.n))
    return task.but(q_end=None, q_guess=guess, tool=Tool(tuple(position), numpy.array(rotation) if oriented else None))


def around_obstacles(draw):
    """A sphere on the way of the free optimum's tool; a straight motion with a random detour passes it."""
    task = draw.free_task()
    found = draw.unlimited(task)
    if found is None:
        return None
    model = Model(draw.robot)
    q = ca.SX.sym("q", task.n)
    centres = ca.Function("centres", [q], [ca.horzcat(*obstacles.centres(model, q))])
    reach = obstacles.reach(model)
    own = float(round_to(obstacles.SHARE * reach, 2))
    at = lambda motion: numpy.array([numpy.array(centres(row)).T for row in motion])
    free = at(found.way)
    tool = free[draw.rng.integers(len(free) * 2 // 5, len(free) * 3 // 5), -1]
    direction = draw.rng.normal(size=3)
    if task.n == 2:
        direction[2] = 0.0
    # The sphere's centre is beside the tool's way; its surface reaches over it by a part of its radius.
    radius = float(round_to(draw.rng.uniform(0.08, 0.15) * reach, 2))
    centre = round_to(tool + direction / numpy.linalg.norm(direction) * draw.rng.uniform(0.2, 0.7) * radius)
    distance = lambda ways: numpy.linalg.norm(ways - centre, axis=2).min() - radius - own
    if distance(free) > -0.02 * reach or distance(free[[0, -1]]) < 0.02 * reach:
        return None
    for _ in range(20):
        detour = shapes.bump(draw.rng.uniform(-1.0, 1.0, task.n), task.duration, GRID)
        straight = shapes.motion(shapes.cubic, task.q_start, task.q_end, task.duration, GRID)
        q, v, a = (one + more for one, more in zip(straight, detour))
        if distance(at(q)) > 0.01 * reach:
            if draw.robot.source.bounded:
                task = draw.bounded(task, abs(draw.peer.torques(task, q, v, a)).max(0))
            return task.but(obstacles=[(tuple(map(float, centre)), radius)], own_radius=own)
    return None


CLASSES = {
    "a": ("effort", effort),
    "b": ("effort, bounded torques", bounded_torques),
    "c": ("least time, bounded torques", least_time),
    "d": ("time and effort", time_and_effort),
    "e": ("rate limits active", rates),
    "f": ("position limits active", positions),
    "g": ("all limits of the robot", robot_limits),
    "h": ("tool pose at the end", tool_pose),
    "i": ("spheres in the way", around_obstacles),
}
