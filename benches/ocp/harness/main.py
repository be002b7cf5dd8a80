"""The whole comparison; started by benches/ocp/run."""

import argparse
import functools
import hashlib
import json
import os
import re
import subprocess
from importlib.metadata import version
from pathlib import Path

import agreement
import derivatives
import fatrop
import freely
import gait_times
import in_phases
import in_space
import inside
import judged
import measures
import points
import robots
import same_mesh
import sensitivities
import tables
import tasks
import values
import walking
from classes import CLASSES
from comparison import DEFAULT, Comparison
from judge import Judge
from ours import Ours
from peer import Peer
from record import Record, read
from same_mesh import SameMesh, forms
from shell import compilers, first_line, say, stop
from solvers import LOOSE, MIDDLE, TIGHT, Ipopt

ROOT = Path(__file__).resolve().parents[3]
# Of --values.
PARTS = {part.__name__: part for part in (derivatives, judged, same_mesh, values, sensitivities, in_space, in_phases, walking,
                                          freely)}


def arguments():
    parser = argparse.ArgumentParser(prog="benches/ocp/run", description="costate optimize beside FATROP and IPOPT")
    parser.add_argument("--cache", type=Path, required=True, help=argparse.SUPPRESS)
    parser.add_argument("--write", action="store_true", help="write the tables of BENCHMARKS.md")
    parser.add_argument("--classes", nargs="*", default=list(CLASSES), choices=CLASSES, metavar="CLASS",
                        help="of " + ", ".join(f"{kind} ({title})" for kind, (title, _) in CLASSES.items()))
    parser.add_argument("--robots", nargs="*", default=list(robots.ALL), choices=robots.ALL, metavar="ROBOT",
                        help="of " + ", ".join(robots.ALL))
    parser.add_argument("--tasks", type=int, default=18, help="tasks a class, taken in turn from the robots (18)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--elements", type=int, default=20, help="elements of the peer's mesh, 3 Radau points each (20)")
    parser.add_argument("--tolerances", nargs="+", type=float, default=[1e-4, 1e-5, 1e-6, 1e-7], metavar="TOLERANCE",
                        help="of costate, two or more, the loosest first: relative error of the cost (1e-4 1e-5 1e-6 1e-7)")
    parser.add_argument("--repeats", type=int, default=3, help="rounds: each side solves once in the first one, three times "
                        "in each of the others; the least time counts (3)")
    parser.add_argument("--time-limit", type=float, default=60.0, help="of each solver (s, 60)")
    parser.add_argument("--interpreted", action="store_true", help="also the peer without compiled functions")
    parser.add_argument("--inside", action="store_true",
                        help="also the peer with costate's own functions inside (always with --write)")
    parser.add_argument("--mesh", action="store_true",
                        help="also the peer on costate's transcription and last mesh (always with --write)")
    parser.add_argument("--add-mesh", action="store_true", help="no new figures but those of --mesh, beside costate's of the "
                        "same run; they are added to the figures there are, whose options hold")
    parser.add_argument("--no-best", dest="best", action="store_false", help="do not look for the best cost on finer meshes")
    parser.add_argument("--costate", type=Path, help="its command line; built from this folder if not given")
    parser.add_argument("--costate-arguments", nargs="*", default=[], metavar="ARGUMENT",
                        help="further arguments of `costate optimize`, without their dashes: strict, method=direct")
    parser.add_argument("--only-write-tasks", action="store_true", help="write the problem files and stop")
    parser.add_argument("--values", nargs="*", choices=PARTS, metavar="PART",
                        help="check the peer and the judge by derivatives and known values, and stop; only these of "
                        + ", ".join(PARTS))
    parser.add_argument("--walking", action="store_true",
                        help="only steps of a walking robot, by both sides; --write writes their tables")
    parser.add_argument("--gaits", nargs="*", choices=[gait.problem for gait in gait_times.GAITS.values()], metavar="PROBLEM",
                        help="of --walking only these of " + ", ".join(gait.problem for gait in gait_times.GAITS.values()))
    parser.add_argument("--from", dest="source", type=Path, metavar="FILE", help="no run: report the figures in FILE")
    options = parser.parse_args()
    if len(options.tolerances) < 2 or options.tolerances != sorted(set(options.tolerances), reverse=True):
        parser.error("--tolerances: give two or more, each smaller than the one before")
    return options


def build():
    """The release build of the command line."""
    say("cargo build: costate-cli")
    # With the features of the main command, whose libraries need not be compiled again.
    command = ["cargo", "build", "--release", "--locked", "-q", "--bin", "costate"]
    if subprocess.run(command, cwd=ROOT, check=False).returncode:
        stop("cargo cannot build costate-cli")
    return Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release/costate"


def describe(options, costate):
    info = Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").exists() else ""
    model = re.search(r"model name\s*:\s*(.*)", info)
    return {
        "machine": f"{model.group(1) if model else 'unknown'}, one core",
        "compilers": [first_line(c, "--version") for _, c, _ in compilers()],
        "packages": {name: version(name) for name in ("casadi", "numpy", "scipy")},
        "costate": first_line(costate, "--version"),
        "seed": options.seed,
        "elements": options.elements,
        "tolerances": options.tolerances,
        "peer_tolerances": [TIGHT, MIDDLE, LOOSE],
        "repeats": options.repeats,
        # What else the figures depend on: an interrupted run goes on only where all of it is the same.
        "options": {key: getattr(options, key) for key in ("classes", "robots", "tasks", "time_limit", "best", "inside",
                                                           "mesh", "interpreted", "costate_arguments")},
        "binary": hashlib.sha256(costate.read_bytes()).hexdigest()[:12],
    }


def the_peer(options):
    return Peer(functools.partial(points.build, options.cache), Ipopt(options.time_limit))


def on_meshes(options, first):
    return {measures.MESH: SameMesh(*forms(first.points, Ipopt(options.time_limit)))}


def check_robots(options, costate, first):
    for name in options.robots:
        difference = agreement.check(costate, first, robots.read(ROOT, costate, name))
        say(f"{name}: inverse dynamics of both agree: {difference:.0e}")


def add_meshes(options, costate, file):
    """Figures of the peer on costate's meshes, added to those in `file`."""
    figures = read(file)
    head = figures[0]
    for key in ("classes", "robots", "tasks", "time_limit", "costate_arguments"):
        setattr(options, key, head["options"][key])
    options.seed, options.tolerances, options.elements = head["seed"], head["tolerances"], head["elements"]
    if head["binary"] != describe(options, costate)["binary"]:
        stop(f"{file} is of another build of costate")
    first = the_peer(options)
    check_robots(options, costate, first)
    ours = Ours(options.cache, costate, first, options.tolerances[0], options.time_limit,
                [f"--{text}" for text in options.costate_arguments])
    comparison = Comparison({}, {measures.OURS: ours}, on_meshes(options, first), Judge(first), options)
    rows = {row["task"]: row for row in measures.of(figures)}
    record = Record(file.with_name("meshes.jsonl"), describe(options, costate))
    names = (options.classes, options.robots, options.tasks, options.seed)
    for task in tasks.make(ROOT, costate, first, *names, record.tasks()):
        sides = comparison.beside(task)
        record.add({"task": task.name, "sides": sides})
        report(task.name, sides)
    for added in record.close():
        if added.get("task") in rows:
            new = {label: side for label, side in added["sides"].items() if label != measures.OURS}
            rows[added["task"]]["sides"] |= new
    head["mesh_added"] = True
    file.write_text("".join(json.dumps(row) + "\n" for row in figures))
    return figures


def report(name, sides):
    told = (f"{label} {side['status'][:40]} {side['ms']:.1f} ms" for label, side in sides.items())
    say(f"{name}: {'; '.join(told)}")


def run(options, costate, file):
    first = the_peer(options)
    # The same program to looser tolerances.
    looser = {"middle": MIDDLE, "loose": LOOSE}
    others = {"peer": first}
    others |= {label: Peer(first.points, Ipopt(options.time_limit, tolerance)) for label, tolerance in looser.items()}
    if options.inside:
        own = lambda robot, spheres: inside.build(options.cache, costate, robot, spheres, first.points(robot, spheres))
        others["peer_ours"] = Peer(own, Ipopt(options.time_limit))
    if options.interpreted:
        others["interpreted"] = Peer(points.interpreted, Ipopt(options.time_limit))
    peers, meshes = fatrop.sides(first.points, options.time_limit)
    peers |= {label: (peer, options.elements) for label, peer in others.items()}
    meshes |= on_meshes(options, first) if options.mesh else {}
    further = [f"--{text}" for text in options.costate_arguments]
    ours = {label: Ours(options.cache, costate, first, tolerance, options.time_limit, further)
            for label, tolerance in [*measures.tolerances(options.tolerances).items(), (DEFAULT, None)]}
    check_robots(options, costate, first)
    comparison = Comparison(peers, ours, meshes, Judge(first), options)
    drawn = functools.partial(tasks.make, ROOT, costate, first, options.classes, options.robots, options.tasks,
                              options.seed)
    if options.only_write_tasks:
        for task in drawn():
            print(*(side.write(task) for side in ours.values()))
        return []
    record = Record(file, describe(options, costate))
    for task in drawn(record.tasks()):
        row = comparison.run(task)
        record.add(row)
        report(task.name, row["sides"])
    return record.close()


def walk(options, costate):
    head = describe(options, costate)
    packages = ", ".join(f"{name} {number}" for name, number in head["packages"].items())
    machine = f"{head['machine']}; {'; '.join(head['compilers'])}; {packages}; {head['costate']}.\n"
    for name, gait in gait_times.GAITS.items():
        if gait.problem in (options.gaits or [gait.problem]):
            table = gait_times.text(gait, ROOT, options.cache, costate, options) + machine
            print(table)
            if options.write:
                tables.put(ROOT / "BENCHMARKS.md", {name: table})


def main():
    options = arguments()
    options.inside |= options.write
    options.mesh |= options.write
    if options.source is None:
        costate = (options.costate or build()).resolve()
        if options.values is not None:
            kept = [PARTS[name].check(ROOT, costate, the_peer(options)) for name in options.values or PARTS]
            raise SystemExit(0 if all(kept) else 1)
        if options.walking:
            return walk(options, costate)
        file = options.cache / "figures.jsonl"
        figures = (add_meshes if options.add_mesh else run)(options, costate, file)
        if options.only_write_tasks:
            return
        print(f"figures: {file}")
    else:
        figures = [json.loads(line) for line in options.source.read_text().splitlines()]
    tables.print_all(figures)
    if options.write:
        tables.write(ROOT / "BENCHMARKS.md", figures)


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        stop("interrupted; the same command goes on after the tasks that are finished")
