"""Whether the peer's model is costate's: accelerations at random states by both."""

import json
import subprocess

import numpy

from shell import stop
from task import Task

STATES = 8
TOLERANCE = 1e-10


def check(costate, peer, robot, seed=1):
    """Largest relative difference of u and tau(q, v, a) with a of `costate eval`; ends the comparison if it is too large."""
    rng = numpy.random.default_rng([seed, robot.n])
    q, v, u = (rng.uniform(-size, size, (STATES, robot.n)) for size in (1.0, 1.0, 10.0))
    lines = "\n".join(json.dumps({"q": list(q[i]), "v": list(v[i]), "u": list(u[i])}) for i in range(STATES))
    command = [costate, "eval", *robot.flags(), "--coordinates", "lagrangian", robot.path]
    done = subprocess.run(command, input=lines, capture_output=True, text=True, check=False)
    if done.returncode:
        stop(f"costate eval failed on {robot.name}: {done.stderr.strip()}")
    a = numpy.array([json.loads(line)["qdd"] for line in done.stdout.splitlines()])
    one = numpy.ones(robot.n)
    tau = peer.torques(Task("agreement", "-", robot, one, one, 1.0, one, one), q, v, a)
    # In parts of the terms whose sum it is: a of a light joint is large.
    m = numpy.array([json.loads(line)["M"] for line in done.stdout.splitlines()])
    size = (abs(m) * abs(a)[:, None, :]).sum(2).max() + abs(u).max()
    difference = float(abs(tau - u).max() / size)
    if not difference <= TOLERANCE:
        stop(f"{robot.name}: inverse dynamics of the peer and of costate differ by {difference:.1e}")
    return difference
