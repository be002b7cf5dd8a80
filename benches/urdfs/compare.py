#!/usr/bin/env python3
"""All URDFs of a folder by costate and by Pinocchio: mass matrix, gravity load, forward dynamics. See docs/urdfs.md.

Pinocchio computes with the independent joints of the whole model; where joints mimic others, `q_all = G q + b` is read
from the file here, and M = G' M_all G, g = G' g_all, a = M^-1 (u - G' h_all), since Pinocchio has no forward dynamics for
its own mimic joints. The base is fixed, and friction is off, in both. Joints at which costate calls M singular are
locked at 0 in both.
"""

import argparse
import json
import random
import re
import subprocess
import sys
import sysconfig
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pinocchio as pin

STATES = 5
DOCUMENT = Path(__file__).resolve().parents[2] / "docs/urdfs.md"
BEGIN, END = "<!-- table: begin -->\n", "<!-- table: end -->"


class Costate:
    """The command line."""

    def __init__(self, program):
        self.program = program

    def run(self, *arguments, lines=()):
        text = "\n".join(map(json.dumps, lines))
        done = subprocess.run([self.program, *arguments], input=text, capture_output=True, text=True)
        if done.returncode:
            raise RuntimeError(done.stderr.strip().splitlines()[-1].removeprefix("error: "))
        return [json.loads(line) for line in done.stdout.splitlines()]

    def info(self, path):
        return self.run("info", path, "--json")[0]

    def compute(self, path, states, locked):
        """M, g and a of each state (q, v, u), with some joints locked at 0."""
        lock = [word for name in locked for word in ("--lock", f"{name}=0")]
        rest = [{"q": q, "v": [0.0] * len(q), "u": [0.0] * len(q)} for q, _, _ in states]
        moving = [{"q": q, "v": v, "u": u} for q, v, u in states]
        hamiltonian = self.run("eval", path, *lock, "--coordinates", "hamiltonian", "--force", lines=rest)
        lagrangian = self.run("eval", path, *lock, "--coordinates", "lagrangian", "--force", lines=moving)
        n = len(states[0][0])
        # At rest without actuation dp/dt is the gravity load with the opposite sign.
        return [(np.array(h["M"]), -np.array(h["f"][n:]), np.array(l["qdd"])) for h, l in zip(hamiltonian, lagrangian)]


def mimics(path):
    """Of each joint that mimics another one: its name, ratio, offset. Mimics of fixed joints are left out."""
    found, fixed = {}, set()
    for joint in ElementTree.parse(path).getroot().findall("joint"):
        mimic = joint.find("mimic")
        if joint.get("type") == "fixed":
            fixed.add(joint.get("name"))
        elif mimic is not None:
            ratio, offset = (float(mimic.get(key, default)) for key, default in (("multiplier", 1), ("offset", 0)))
            found[joint.get("name")] = mimic.get("joint"), ratio, offset
    return {name: mimic for name, mimic in found.items() if mimic[0] not in fixed}


class Pinocchio:
    """The whole model, with the map from the independent joints that are not locked."""

    def __init__(self, path, independent):
        self.model = pin.buildModelFromUrdf(str(path))
        self.data = self.model.createData()
        dependent = mimics(path)
        order = {name: k for k, name in enumerate(independent)}
        self.g, self.b = np.zeros((self.model.nv, len(order))), np.zeros(self.model.nv)
        for joint, name in zip(self.model.joints[1:], self.model.names[1:]):
            ratio, offset, seen = 1.0, 0.0, set()
            while name in dependent and name not in seen:
                seen.add(name)
                name, r, b = dependent[name]
                ratio, offset = ratio * r, ratio * b + offset
            self.b[joint.idx_v] = offset
            if name in order:
                self.g[joint.idx_v, order[name]] = ratio
        self.is_whole = not dependent and len(order) == self.model.nv

    def position(self, q):
        positions, found = self.g @ q + self.b, pin.neutral(self.model)
        for joint in self.model.joints[1:]:
            x = positions[joint.idx_v]
            # A joint without limits has the coordinates (cos q, sin q).
            found[joint.idx_q:joint.idx_q + joint.nq] = [np.cos(x), np.sin(x)] if joint.nq == 2 else x
        return found

    def compute(self, q, v, u):
        q_all, v_all = self.position(q), self.g @ v
        m = np.triu(pin.crba(self.model, self.data, q_all))
        m = self.g.T @ (m + np.triu(m, 1).T) @ self.g
        gravity = self.g.T @ pin.computeGeneralizedGravity(self.model, self.data, q_all)
        if not self.is_whole:
            bias = self.g.T @ pin.nonLinearEffects(self.model, self.data, q_all, v_all)
            return m, gravity, np.linalg.solve(m, np.array(u) - bias)
        order = np.argmax(self.g, axis=1)
        a = pin.aba(self.model, self.data, q_all, v_all, np.array(u)[order])
        return m, gravity, self.g.T @ a


def by_pinocchio(path):
    """What Pinocchio makes of a file that costate refuses: whether it reads it, and whether M is regular."""
    try:
        model = pin.buildModelFromUrdf(str(path), mimic=True)
    except ValueError:
        return "Pinocchio refuses it, too"
    if not model.nv:
        return "Pinocchio: 0 degrees of freedom"
    m = np.triu(pin.crba(model, model.createData(), pin.neutral(model)))
    values = np.linalg.eigvalsh(m + np.triu(m, 1).T)
    return f"Pinocchio: eigenvalues of M from {values[0]:.0e} to {values[-1]:.0e}"


def first_clause(refusal, path):
    """Without the remedy and the path."""
    return str(refusal).split(";")[0].split(" (the base")[0].replace(f"{path}:", "line ").replace(str(path), "the file")


def states(info, name, locked):
    """Positions within the limits (+-pi rad, +-1 m without), the first 0; velocities and actuation of order 1."""
    source = random.Random(name)
    free = [joint for joint in info["joints"] if joint["mimic"] is None and joint["name"] not in locked]

    def position(joint):
        lower, upper = joint["limits"]["lower"], joint["limits"]["upper"]
        reach = np.pi if joint["type"] == "revolute" else 1.0
        return source.uniform(*((lower, upper) if None not in (lower, upper) and lower < upper else (-reach, reach)))

    vector = lambda: [source.uniform(-1, 1) for _ in free]
    return [([position(joint) if number else 0.0 for joint in free], vector(), vector()) for number in range(STATES)]


def difference(found, expected):
    """The largest difference in all states, relative to the largest entry in all states."""
    found, expected = np.stack(found), np.stack(expected)
    size = abs(expected).max(initial=0.0)
    return abs(found - expected).max(initial=0.0) / (size or 1.0)


def compare(costate, path):
    """Cells of a row: joints, mimics, result, differences of M, g and a, largest condition of M."""
    try:
        info = costate.info(path)
    except RuntimeError as refusal:
        return ["", "", f"refused: {first_clause(refusal, path)} ({by_pinocchio(path)})", "", "", "", ""]
    every, free = info["joints"], [joint["name"] for joint in info["joints"] if joint["mimic"] is None]
    counts = [str(len(every)), str(len(every) - len(free))]
    locked = []
    while True:
        names = [name for name in free if name not in locked]
        given = states(info, path.name, locked)
        try:
            found = costate.compute(path, given, locked)
            break
        except RuntimeError as refusal:
            singular = re.search("singular at joint '(.*?)'", str(refusal))
            if not singular or singular[1] not in names:
                return [*counts, f"loaded; {first_clause(refusal, path)} ({by_pinocchio(path)})", "", "", "", ""]
            locked.append(singular[1])
    reference = Pinocchio(path, names)
    expected = [reference.compute(*state) for state in given]
    worst = [difference([f[k] for f in found], [e[k] for e in expected]) for k in range(3)]
    condition = max(np.linalg.cond(m) for m, _, _ in expected)
    rounding = 1e-15 * condition
    result = "equal" if max(worst) <= 1e-12 else "DIFFERS"
    if max(worst[:2]) <= 1e-12 < worst[2] <= rounding:
        # What rounding of M alone can change says something about a only if it is small.
        result = "equal but for rounding" if rounding <= 1e-6 else "M and gravity equal, and M nearly singular"
    if locked:
        result += f" with {', '.join(locked)} locked: M is singular there ({by_pinocchio(path)})"
    return [*counts, result, *(f"{x:.0e}" for x in worst), f"{condition:.0e}"]


def table(costate, folder):
    files = sorted(folder.rglob("*.urdf"), key=lambda path: path.relative_to(folder).as_posix())
    lines = ["| file | joints | mimic others | result | M | gravity | a | condition of M |", "|---|--:|--:|---|--:|--:|--:|--:|"]
    equal = 0
    for path in files:
        name = path.relative_to(folder).as_posix()
        cells = compare(costate, path)
        equal += cells[2].startswith("equal")
        print(name, *cells, file=sys.stderr, flush=True)
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return f"{equal} of {len(files)} files are equal.\n\n" + "\n".join(lines) + "\n"


def options(description):
    """The program, the folder of the files, and whether the document is written."""
    arguments = argparse.ArgumentParser(description=description)
    arguments.add_argument("--costate", required=True, help="the program")
    arguments.add_argument("--folder", type=Path, help="of URDF files; that of the package if absent")
    arguments.add_argument("--write", action="store_true", help="replace the table of docs/urdfs.md")
    arguments = arguments.parse_args()
    installed = Path(sysconfig.get_path("purelib")) / "cmeel.prefix/share/example-robot-data/robots"
    return Costate(arguments.costate), arguments.folder or installed, arguments.write


def replace(text, begin, end):
    """Puts a table between these lines of the document."""
    document = DOCUMENT.read_text()
    before, after = document.split(begin)[0], document.split(end)[1]
    DOCUMENT.write_text(before + begin + text + end + after)


def main():
    costate, folder, write = options(__doc__)
    text = table(costate, folder)
    replace(text, BEGIN, END) if write else print(text, end="")


if __name__ == "__main__":
    main()
