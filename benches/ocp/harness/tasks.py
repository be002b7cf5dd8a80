"""Random tasks: the same for the same seed, class, robot and number."""

import numpy

import classes
import robots
from draw import Draw
from shell import say

# Draws for one task, at most: many do not suit a class.
DRAWS = 60


def make(root, costate, peer, kinds, names, count, seed, finished=()):
    """`count` tasks a class, taken in turn from the robots, without those that are finished."""
    for kind in kinds:
        for number in range(count):
            robot = robots.read(root, costate, names[number % len(names)])
            name = f"{kind}_{robot.name}_{number // len(names) + 1}"
            if name in finished:
                continue
            task = one(peer, kind, robot, number // len(names), seed, name)
            if task is None:
                say(f"{kind}: {robot.name}: no draw of {DRAWS} suits")
            else:
                yield task


def one(peer, kind, robot, number, seed, name):
    rng = numpy.random.default_rng([seed, ord(kind), robots.ALL.index(robot.name), number])
    failed = 0
    for number in range(DRAWS):
        draw = Draw(rng, robot, peer, name, kind)
        task = classes.CLASSES[kind][1](draw)
        failed += draw.peer_failed
        if task is not None:
            return task.but(draws=number + 1, peer_failed=failed)
    return None
