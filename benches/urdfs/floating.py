#!/usr/bin/env python3
"""All URDFs of a folder on a floating base, by costate and by Pinocchio: mass matrix, forward dynamics and its derivatives.

The base is a joint with a quaternion in both: `costate eval --floating-base`, and a free flyer. Derivatives are those in
the tangent space on the right. Files whose joints mimic others are left out, as Pinocchio has no forward dynamics for
them. See docs/urdfs.md.
"""

import random
import re
import sys

import numpy as np
import pinocchio as pin

from compare import STATES, difference, mimics, options, replace

QUANTITIES = ("M", "a", "a_q, a_v", "a_u")
BEGIN, END = "<!-- floating: begin -->\n", "<!-- floating: end -->"
# What is called equal: of M and a, and of derivatives in parts of rounding times the condition of M.
EQUAL, ROUNDING = 1e-12, 1e-15


def symmetric(upper):
    """A symmetric matrix by the half that Pinocchio fills."""
    upper = np.triu(upper)
    return upper + np.triu(upper, 1).T


def states(model, name):
    """Positions within the limits, the base anywhere; velocities and actuation of order 1."""
    source = random.Random(name)
    vector = lambda count: np.array([source.uniform(-1, 1) for _ in range(count)])
    for _ in range(STATES):
        q = pin.integrate(model, pin.neutral(model), vector(model.nv))
        for joint in list(model.joints)[2:]:
            lower, upper = model.lowerPositionLimit[joint.idx_q], model.upperPositionLimit[joint.idx_q]
            if joint.nq == 1 and lower < upper and upper - lower < 100.0:
                q[joint.idx_q] = source.uniform(lower, upper)
        yield q, vector(model.nv), vector(model.nv)


def by_pinocchio(model, data, q, v, u):
    m = symmetric(pin.crba(model, data, q))
    a = pin.aba(model, data, q, v, u)
    a_q, a_v, a_u = pin.computeABADerivatives(model, data, q, v, u)
    return m, a, np.hstack([a_q, a_v]), symmetric(a_u)


def angles(model, q):
    """q with one angle for a joint without limits, in place of its cosine and sine."""
    entries = []
    for joint in list(model.joints)[1:]:
        own = q[joint.idx_q:joint.idx_q + joint.nq]
        entries += [np.arctan2(own[1], own[0])] if (joint.nq, joint.nv) == (2, 1) else list(own)
    return entries


def by_costate(costate, path, model, given):
    """The same; joints in the order of Pinocchio, which `costate info` has in another one."""
    info = costate.run("info", path, "--floating-base", "--json")[0]
    names = [joint["name"] for joint in info["joints"] if not joint["name"].startswith("root_joint")]
    order = {name: number for number, name in enumerate(list(model.names)[2:])}
    if sorted(names) != sorted(order):
        raise RuntimeError("joints of other names")
    place = [order[name] for name in names]
    to_v = np.array([*range(6), *(6 + number for number in place)])
    to_q = np.array([*range(7), *(7 + number for number in place)])
    lines = [{"q": np.array(angles(model, q))[to_q].tolist(), "v": v[to_v].tolist(), "u": u[to_v].tolist()} for q, v, u in given]
    back = np.argsort(to_v)
    found = costate.run("eval", path, "--floating-base", "--coordinates", "lagrangian", "--force", lines=lines)
    for answer in found:
        n = len(back)
        m, a = np.array(answer["M"])[np.ix_(back, back)], np.array(answer["qdd"])[back]
        blocks = np.array(answer["qdd_z"]).reshape(n, 3, n)[np.ix_(back, range(3), back)]
        yield m, a, np.hstack([blocks[:, 0], blocks[:, 1]]), blocks[:, 2]


def compare(costate, path):
    """Cells of a row; nothing for a file without a robot."""
    try:
        model = pin.buildModelFromUrdf(str(path), pin.JointModelFreeFlyer())
    except ValueError:
        return None
    if mimics(path):
        return [str(model.nv), "joints mimic others", "", "", "", "", ""]
    data, given = model.createData(), list(states(model, path.name))
    try:
        found = list(by_costate(costate, path, model, given))
    except RuntimeError as refusal:
        reason = re.sub(r"^line \d+: ", "", str(refusal).split(";")[0].replace(str(path), "the file"))
        return [str(model.nv), f"refused: {reason}", "", "", "", "", ""]
    expected = [by_pinocchio(model, data, *state) for state in given]
    worst = [difference([f[k] for f in found], [e[k] for e in expected]) for k in range(len(QUANTITIES))]
    condition = max(np.linalg.cond(m) for m, *_ in expected)
    rounding = max(EQUAL, ROUNDING * condition)
    result = "equal" if max(worst) <= EQUAL else "equal but for rounding" if worst[0] <= EQUAL and max(worst) <= rounding else "DIFFERS"
    return [str(model.nv), result, *(f"{x:.0e}" for x in worst), f"{condition:.0e}"]


def table(costate, folder):
    files = sorted(folder.rglob("*.urdf"), key=lambda path: path.relative_to(folder).as_posix())
    head = ["file", "n", "result", *QUANTITIES, "condition of M"]
    lines = ["| " + " | ".join(head) + " |", "|---|--:|---|--:|--:|--:|--:|--:|"]
    counts = [0, 0]
    for path in files:
        cells = compare(costate, path)
        if cells is None:
            continue
        name = path.relative_to(folder).as_posix()
        print(name, *cells, file=sys.stderr, flush=True)
        counts[0] += cells[1].startswith("equal")
        counts[1] += cells[2] != ""
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return f"{counts[0]} of {counts[1]} robots are equal.\n\n" + "\n".join(lines) + "\n"


if __name__ == "__main__":
    costate, folder, write = options(__doc__)
    text = table(costate, folder)
    replace(text, BEGIN, END) if write else print(text)
