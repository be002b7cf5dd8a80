"""Spheres in space against spheres on the robot: at the origins of the joints beyond the first two, and at the tool."""

import casadi as ca
import numpy

# Radius of a robot's spheres (m) in parts of its reach, the distance of its tool from its base at q = 0 along the links.
SHARE = 0.04


def reach(model):
    """Sum of the distances from joint to joint along the way to the tool (m)."""
    lengths = [numpy.linalg.norm(joint["placement"]["xyz"]) for joint in model.robot.joints]
    return sum(lengths[i] for i in carriers(model)) + numpy.linalg.norm(model.robot.source.tool[1])


def carriers(model):
    """Joints on the way from the base to the tool."""
    i, found = model.robot.index(model.robot.source.tool[0]), []
    while i is not None:
        found.append(i)
        i = model.parents[i]
    return found[::-1]


def spheres_of(model):
    """(joint, point in its frame) of every sphere: links of no length get none of their own."""
    found = []
    for i in carriers(model)[2:]:
        if numpy.linalg.norm(model.robot.joints[i]["placement"]["xyz"]) > 0.05:
            found.append((i, (0.0, 0.0, 0.0)))
    joint, point = model.robot.source.tool
    return found + [(model.robot.index(joint), point)]


def centres(model, q):
    frames = model.frames(q)
    return [frames[i][1] + frames[i][0] @ ca.SX(ca.DM(point)) for i, point in spheres_of(model)]


def clearances(model, q, par, count):
    """(d^2 - r^2)/(2 r) of every obstacle and every sphere of the robot, d the distance of centres, r the sum of radii (m):
    the distance of the surfaces where they touch, and smooth everywhere. `par` holds centre and r of each obstacle."""
    found = []
    for k in range(count):
        centre, r = par[4 * k: 4 * k + 3], par[4 * k + 3]
        found += [(ca.sumsqr(own - centre) - r * r) / (2 * r) for own in centres(model, q)]
    return ca.vertcat(*found) if found else ca.SX(0, 1)
