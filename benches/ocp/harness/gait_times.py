"""Times of steps of walking robots: costate beside CasADi and IPOPT in the other coordinates of walking.py and soles.py. Started
by `benches/ocp/run --walking`."""

import contextlib
import json
import os
import re
import subprocess
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median

import casadi as ca
import numpy as np

import markdown
import soles
import steps
import walking
from comparison import LONG, TIMES
from ours import SECONDS, SOLVED
from points import library
from shell import say
from solvers import LOOSE, TIGHT, Ipopt
from steps import Step
from tables import spread

# So many steps beside that of the example.
DRAWN = 7
# Of costate; equal intervals and tolerances of the peer.
TOLERANCES = 1e-3, 1e-4, 1e-5, 1e-6, 1e-7
INTERVALS = 5, 10
# The last ones have the best cost known, with a tolerance of their own.
FINEST, EXACT = 80, 1e-10
# Errors of the cost at which times are compared, relative.
ERRORS = 1e-3, 1e-4, 1e-5, 1e-6
# A cost that differs by more is that of another motion, relative.
SAME = 1e-2
# What is asked for: this many times faster at each error in the median, and costs that agree to this.
GOAL, AGREE = 10, 1e-6
# Of whole programs in C, which take minutes with more.
FLAGS = "-O1 -march=native"
# Of one core.
ONE_CORE = {**os.environ, "RAYON_NUM_THREADS": "1"}
SOLVER = '[solver]\nmethod = "direct"\npolish = false\nmachine_code = "at_once"\nverify = "factors"\ntolerance = {:g}\n'


@dataclass(frozen=True)
class Gait:
    """A robot of the peer, the example of costate, the size of its step, and the ranges of lengths (m) and speeds (m/s) that are
    drawn. `plain` equal intervals are not compiled. Where limits begin and end to be active the best cost needs a finer mesh:
    `settles`."""
    problem: str
    walker: object
    size: tuple
    lengths: tuple
    speeds: tuple
    plain: int
    settles: bool


GAITS = {
    "ocp walking": Gait("rabbit_walk", walking.rabbit, (walking.LENGTH, walking.TIME), (0.3, 0.6), (0.4, 1.0), walking.INTERVALS, False),
    "ocp walking on soles": Gait("seven_link_walk", soles.biped, (soles.LENGTH, soles.TIME), (0.3, 0.5), (0.4, 0.9), 20, True),
}


@dataclass
class Side:
    """A solver with its options: `solve` gets a task and how often, and gives an answer."""
    name: str
    is_ours: bool
    solve: object
    answers: dict = field(default_factory=dict)


@dataclass
class Answer:
    """CPU seconds of the least of several calls."""
    solved: bool
    status: str
    cost: float
    seconds: float
    iterations: int
    intervals: int


def draw(gait, seed):
    """Lengths and durations of steps, that of the example first."""
    rng = np.random.default_rng(seed)
    drawn = [(rng.uniform(*gait.lengths), rng.uniform(*gait.speeds)) for _ in range(DRAWN)]
    return [gait.size, *((round(length, 3), round(length / speed, 3)) for length, speed in drawn)]


def replaced(pattern, text, file):
    file, count = re.subn(pattern, text, file, flags=re.MULTILINE)
    assert count == 1, pattern
    return file


def ours(gait, root, cache, costate, tolerance):
    """costate with this tolerance: the file of the example, with another size of the step and another solver."""
    example = (root / f"examples/problems/{gait.problem}.toml").read_text().split("[solver]")[0]
    example = example.replace("../../robots", str(root / "robots"))
    folder = cache / "tasks"
    folder.mkdir(parents=True, exist_ok=True)

    def solve(task, times):
        length, duration = task
        text = replaced("^final = .*$", f"final = {duration!r}", replaced("^length = .*$", f"length = {length!r}", example))
        file = folder / f"{gait.problem}_{length:g}_{duration:g}_{tolerance:g}.toml"
        file.write_text(text + SOLVER.format(tolerance))
        command = [costate, "optimize", file, "--json", "--repeat", str(times)]
        done = subprocess.run(command, capture_output=True, text=True, check=False, env=ONE_CORE)
        found = json.loads(done.stdout)
        seconds = next(found[key] for key in SECONDS if found.get(key) is not None)
        return Answer(found["status"] in SOLVED, found["status"], found["cost"], seconds, found["newton_iterations"],
                      found["nodes"] // 5)

    return Side(f"costate, {tolerance:g}", True, solve)


def compiled(cache, step, name, options):
    """A solver with all functions that IPOPT calls compiled."""
    solver = ca.nlpsol(name, "ipopt", step.nlp, options)
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        text = Path(solver.generate_dependencies(f"{name}.c")).read_text()
    return ca.nlpsol(name, "ipopt", str(library(cache, name, text, FLAGS)), options)


def theirs(gait, cache, intervals, tolerance, is_compiled=True):
    """The peer on so many intervals."""
    step = Step(gait.walker(), intervals)
    # Multipliers of parameters need the gradient that is switched off.
    options = {**Ipopt.OPTIONS, **Ipopt(tolerance=tolerance).tolerances(), "ipopt.tol": tolerance, "calc_lam_p": False}
    name = f"{gait.problem}_{intervals}"
    solver = compiled(cache, step, name, options) if is_compiled else ca.nlpsol(name, "ipopt", step.nlp, options)

    def solve(task, times):
        arguments, seconds = step.arguments(*task), np.inf
        for _ in range(times):
            begin = time.process_time()
            found = solver(**arguments)
            seconds = min(seconds, time.process_time() - begin)
        status = solver.stats()
        return Answer(status["return_status"] in Ipopt.SOLVED, status["return_status"], float(found["f"]), seconds,
                      status["iter_count"], intervals)

    form = "" if is_compiled else ", interpreted"
    return Side(f"peer, {intervals} intervals, {tolerance:g}{form}", False, solve)


def solve(sides, task, repeats):
    """In turn, so that whatever slows the machine down slows all."""
    for number in range(repeats):
        for side in sides:
            earlier = side.answers.get(task)
            if earlier and (earlier.seconds > LONG or not earlier.solved):
                continue
            answer = side.solve(task, TIMES if number else 1)
            if earlier is None or answer.seconds < earlier.seconds:
                side.answers[task] = answer
    told = (f"{side.name} {answer.status} {answer.cost:.9g} {1e3 * answer.seconds:.1f} ms"
            for side in sides for answer in [side.answers[task]])
    say(f"a step of {task[0]} m in {task[1]} s: {'; '.join(told)}")


def cheapest(sides, task, finest):
    """The best cost known: that of the finest mesh, unless another side has found a much cheaper motion on a mesh that is not
    the roughest one."""
    costs = [answer.cost for side in sides for answer in [side.answers[task]]
             if answer.solved and answer.intervals > INTERVALS[0]]
    return min(costs) if min(costs) < (1 - SAME) * finest else finest


def error(answer, best):
    """Of the cost, relative; a cost below the best one is an error too."""
    return abs(answer.cost / best - 1) if answer.solved else np.inf


def fastest(sides, task, best, most):
    """Seconds of the fastest answer with no more than this error; infinite where there is none."""
    return min((answer.seconds for side in sides for answer in [side.answers[task]] if error(answer, best) <= most),
               default=np.inf)


def verdicts(own, other, tasks, best):
    rows = []
    solved = [[task for task in tasks if all(side.answers[task].solved for side in sides)] for sides in (own, other)]
    kept = set(solved[0]) >= set(solved[1])
    rows.append(["solves what the peer solves, with each tolerance and mesh",
                 f"{len(solved[0])} of {len(tasks)}, peer {len(solved[1])}", kept])
    found = [[task for task in tasks if any(error(side.answers[task], best[task]) < SAME for side in sides)]
             for sides in (own, other)]
    rows.append(["finds the cheapest motion known, with any tolerance or mesh",
                 f"{len(found[0])} of {len(tasks)}, peer {len(found[1])}", len(found[0]) == len(tasks)])
    away = max(error(own[-1].answers[task], best[task]) for task in found[0])
    rows.append([f"costs of the same motions agree with the peer's to {AGREE:g}, at the last tolerance", f"{away:.0e}",
                 away <= AGREE])
    for most in ERRORS:
        times = [[fastest(sides, task, best[task], most) for task in tasks] for sides in (own, other)]
        ratios = [there / here for here, there in zip(*times) if np.isfinite([here, there]).all()]
        only = [sum(np.isfinite(here) and not np.isfinite(there) for here, there in zip(*pair)) for pair in (times, times[::-1])]
        alone = "".join(f"; {who} alone on {count}" for who, count in zip(("costate", "peer"), only) if count)
        rows.append([f"{GOAL} times faster to a cost within {most:g}", f"{spread(ratios, '{:.1f}')}{alone}",
                     bool(ratios) and median(ratios) >= GOAL and not only[1]])
    return markdown.table(["goal", "measured", "verdict"], [[*row[:2], "kept" if row[2] else "**missed**"] for row in rows])


def table(sides, tasks, best):
    rows = []
    for side in sides:
        done = [(task, side.answers[task]) for task in tasks if side.answers[task].solved]
        errors = [found for task, answer in done if (found := error(answer, best[task])) < SAME]
        rows.append([side.name, f"{len(done)} of {len(tasks)}", len(errors), spread([1e3 * answer.seconds for _, answer in done], "{:.1f}"),
                     spread([answer.iterations for _, answer in done], "{:.0f}"),
                     spread([answer.intervals for _, answer in done], "{:.0f}"),
                     f"{median(errors):.0e}, {max(errors):.0e}" if errors else "-"])
    return markdown.table(["solver, tolerance", "solved", "the cheapest", "CPU ms, median (quartiles)", "iterations", "intervals",
                     "error of the cost, median, worst"], rows)


def sizes(sides, tasks, best):
    """A row for each step."""
    rows = []
    for task in tasks:
        length, duration = task
        cells = [f"{1e3 * side.answers[task].seconds:.1f} ({error(side.answers[task], best[task]):.0e})"
                 if side.answers[task].solved else side.answers[task].status for side in sides]
        rows.append([f"{length:g}", f"{length / duration:.3f}", f"{best[task]:.6f}", *cells])
    return markdown.table(["length, m", "speed, m/s", "best cost", *(side.name for side in sides)], rows)


def finest_of(gait, cache):
    """The cost of a task by the peer as exactly as it can be had."""
    if gait.settles:
        walker = gait.walker()
        return lambda task: steps.solve(walker, *task, FINEST)[0]
    side = theirs(gait, cache, FINEST, EXACT, False)
    return lambda task: side.solve(task, 1).cost


def text(gait, root, cache, costate, options):
    """Verdicts and tables."""
    tasks = draw(gait, options.seed)
    own = [ours(gait, root, cache, costate, tolerance) for tolerance in TOLERANCES]
    other = [theirs(gait, cache, count, tolerance) for count in INTERVALS for tolerance in (LOOSE, TIGHT)]
    plain = theirs(gait, cache, gait.plain, TIGHT, False)
    finest = finest_of(gait, cache)
    best = {}
    for task in tasks:
        finest_cost = finest(task)
        say(f"a step of {task[0]} m in {task[1]} s, {FINEST} intervals of the peer: {finest_cost:.9f}")
        solve([*own, *other, plain], task, options.repeats)
        best[task] = cheapest([*own, *other, plain], task, finest_cost)
    return (verdicts(own, other, tasks, best) + "\n" + table([*own, *other, plain], tasks, best) + "\n"
            + sizes([own[1], own[-1], other[-1]], tasks, best)
            + f"\n{len(tasks)} steps, that of the example first, seed {options.seed}; best costs by the peer on {FINEST} "
              f"intervals{', halved until the cost settles' if gait.settles else ''}, tolerance {EXACT:g}, unless a side finds another, cheaper motion; the least of {1 + TIMES * (options.repeats - 1)} calls of both sides.\n")
