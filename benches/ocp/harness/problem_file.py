"""A task as a problem file of `costate optimize`."""

import numpy

import obstacles
from model import Model


def number(value):
    return "inf" if value == numpy.inf else "-inf" if value == -numpy.inf else repr(float(value))


def numbers(values):
    return "[" + ", ".join(number(value) for value in values) + "]"


def matrix(rows):
    return "[" + ", ".join(numbers(row) for row in rows) + "]"


def table(name, *lines):
    return [f"[{name}]", *lines, ""]


def text(task, understands_limits, tolerance, starts=None):
    """The file; without the table `[limits]` for a costate that has none, if the task needs none; without options of the
    solver if the tolerance is None."""
    robot = task.robot
    rows = []
    if robot.source.armature:
        armature = ", ".join(f"{joint} = {value}" for joint, value in robot.source.armature.items())
        rows += table("robot", f'file = "{robot.path}"', f"armature = {{ {armature} }}")
    else:
        rows += [f'robot = "{robot.path}"', ""]
    rows += table("start", f"q = {numbers(task.q_start)}")
    rows += end(task)
    rows += table("time", *(["free = true", f"guess = {task.duration!r}"] if task.free else [f"final = {task.duration!r}"]))
    cost = [f"time = {task.time_weight!r}"] if task.time_weight else []
    rows += table("cost", *cost, *([f"effort = {numbers(task.effort)}"] if task.effort.any() else []))
    limits, bounds = limits_of(task)
    if bounds:
        rows += table("bounds", *bounds)
    if limits or understands_limits:
        rows += table("limits", f"from_robot = {str(task.from_robot).lower()}", *limits)
    if understands_limits and tolerance is not None:
        rows += table("solver", 'method = "direct"', "polish = false", 'machine_code = "at_once"',
                      'verify = "factors"', f"tolerance = {tolerance!r}", *([f"starts = {starts}"] if starts else []))
    return "\n".join(rows + obstacles_of(task))


def end(task):
    if task.tool is None:
        return table("end", f"q = {numbers(task.q_end)}")
    joint, point = task.robot.source.tool
    names = ", ".join(f'"{row["name"]}"' for row in task.robot.joints)
    position = numbers(numpy.inf if value is None else value for value in task.tool.position)
    rows = table("end", f"q = {numbers(task.q_guess)}", f"q_free = [{names}]")
    tool = [f'frame = "joint:{joint}"', f"offset = {numbers(point)}", f"xyz = {position}"]
    if task.tool.rotation is not None:
        tool.append(f"rotation = {matrix(task.tool.rotation)}")
    return rows + table("end.tool", *tool)


def obstacles_of(task):
    """Spheres in space, and the robot's own ones."""
    rows = []
    for centre, radius in task.obstacles:
        rows += table("[obstacle]", 'kind = "sphere"', f"xyz = {numbers(centre)}", f"radius = {radius!r}")
    if not task.obstacles:
        return rows
    own = obstacles.spheres_of(Model(task.robot))
    for k, (joint, point) in enumerate(own):
        name = task.robot.joints[joint]["name"]
        rows += table("[collision.capsule]", f'name = "{name} {k}"', f'frame = "joint:{name}"',
                      f"from = {numbers(point)}", f"radius = {task.own_radius!r}")
    return rows


def limits_of(task):
    """Lines of `[limits]` and of `[bounds]`. With the limits of the robot's file only what it lacks is written."""
    lists = {key: getattr(task, key) for key in ("q_min", "q_max", "v_max", "a_max")}
    if task.from_robot:
        lists["torque_max"] = task.u_max
        for key, own in (("q_min", "lower"), ("q_max", "upper"), ("v_max", "velocity"), ("torque_max", "effort")):
            known = numpy.isfinite(task.robot.limits(own))
            lists[key] = numpy.where(known, -numpy.inf if key == "q_min" else numpy.inf, lists[key])
    limits = [f"{key} = {numbers(values)}" for key, values in lists.items() if numpy.isfinite(values).any()]
    if task.from_robot:
        return limits, []
    finite = numpy.isfinite(task.u_max).any()
    return limits, [f"u_min = {numbers(task.u_min)}", f"u_max = {numbers(task.u_max)}"] if finite else []
