"""Times of calls from Python: beside Rust, and beside pin, adam and MJX.

``python python/benches/calls.py [ROBOT.urdf] [--states 1000000] [--minutes 25] [--write]``, with a package that was built with
the feature ``timing``; the least of many calls, on one thread where nothing else is said. Rust and Python take turns, call by
call. Rust is the faster of two, in the same build: the same function at the same states without objects of Python
(``Dynamics._seconds``), and ``costate::batch`` as a user of Rust calls it (``Dynamics._batch``). ``--write`` puts the tables
into docs/python_calls.md. Peers are compared where they are installed, and named where they are not: loops over states for
pin, whose calls take one; ``jit`` for adam and MJX, whose derivatives are checked against those of costate before they are
timed (``differentiated``). The command ends after the minutes given: those that are left after the first tables are shared by
the peers, and a program that did not compile or end is told with the time that its package had.
"""

import argparse
import os
import platform
import time
import warnings
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import costate
import numpy as np
from packages import arguments, peers

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "python_calls.md"


def seconds(call, repeats: int = 1) -> float:
    """The mean time of so many calls (s)."""
    start = time.perf_counter()
    for _ in range(repeats):
        call()
    return (time.perf_counter() - start) / repeats


def by_turns(calls: dict, rounds: int, budget: float, best: dict) -> None:
    """The least time that each of some functions returns, called in turns: in so many rounds, more within the budget (s)."""
    end = time.perf_counter() + budget
    order = list(calls)
    while rounds > 0 or time.perf_counter() < end:
        rounds -= 1
        # None is always first after the same other one.
        order.reverse()
        for name in order:
            best[name] = min(best.get(name, float("inf")), calls[name]())


# Calls between two looks at the clock, of one state.
REPEATS = 300
# Memory that batches are timed in.
PLACES = 2


def overhead(robot: costate.Robot) -> str:
    dynamics, rows = costate.Dynamics(robot), []
    for verb in ("f", "aba", "rnea", "linearise", "jacobian", "hessian", "contract", "adjoint"):
        given, method = arguments(robot.n, verb, ()), getattr(dynamics, verb)
        out = method(*given)
        calls = {"Rust": lambda: dynamics._seconds(verb, given, out, REPEATS),
                 "Python": lambda: seconds(lambda: method(*given), REPEATS)}  # fmt: skip
        best = {}
        by_turns(calls, 50, 1.0, best)
        rust, ours = best["Rust"], best["Python"]
        rows.append((ours - rust, f"| `{verb}` | {rust * 1e6:.2f} | {ours * 1e6:.2f} | {(ours - rust) * 1e6:.2f} |"))
    rows.sort(reverse=True)
    return "| one state | Rust (us) | Python (us) | overhead (us) |\n|---|--:|--:|--:|\n" + "\n".join(row for _, row in rows)


def memory(method, given: list):
    """Arrays for the results of a method at these states, whose pages are there."""
    one, states = method(*(array[:1] for array in given)), len(given[0])
    arrays = tuple(np.full((states, *array.shape[1:]), 0.0) for array in (one if isinstance(one, tuple) else (one,)))
    return arrays if isinstance(one, tuple) else arrays[0]


def fits(method, given: list, states: int) -> int:
    """So many states, or a tenth where there is no memory for results of Python, of Rust, and new ones."""
    results = method(*(array[:1] for array in given))
    size = 8 * states * sum(array.size for array in (results if isinstance(results, tuple) else (results,)))
    return states if 3.2 * size < available() else states // 10


def available() -> int:
    """Memory (bytes) that can be had, that of caches of files included where the system tells it."""
    file = Path("/proc/meminfo")
    for line in file.read_text().splitlines() if file.exists() else ():
        if line.startswith("MemAvailable:"):
            return 1024 * int(line.split()[1])
    return os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")


def batches(robot: costate.Robot, states: int) -> str:
    """Beside Rust, with results in memory that is there and in new memory."""
    rows = []
    for threads in (1, len(os.sched_getaffinity(0))):
        dynamics = costate.Dynamics(robot, threads=threads)
        for verb in ("f", "linearise", "adjoint", "hessian", "contract"):
            given, method = arguments(robot.n, verb, (states,)), getattr(dynamics, verb)
            count = fits(method, given, states)
            given = [array[:count] for array in given]
            there, new = {}, {}
            # How fast memory is depends on where it is: each side has the best of several places.
            for _ in range(PLACES):
                out, batch = memory(method, given), dynamics._batch(verb, count, threads)
                by_turns({"the same": lambda: dynamics._seconds(verb, given, out, 1),
                          "batch": lambda: batch.seconds(fresh=False),
                          "Python": lambda: seconds(lambda: method(*given, out=out))}, 3, 1.5, there)  # fmt: skip
                del out
                if new:
                    continue
                by_turns({"the same": lambda: dynamics._seconds(verb, given, None, 1),
                          "batch": lambda: batch.seconds(fresh=True),
                          "Python": lambda: seconds(lambda: method(*given))}, 2, 0.0, new)  # fmt: skip
                del batch
            cells, ratios = [], []
            for times in (there, new):
                same, rust, ours = times["the same"], times["batch"], times["Python"]
                ratios.append(ours / min(same, rust))
                cells.extend(f"{time / count * 1e9:.0f}" for time in (same, rust, ours))
                cells.append(f"{ratios[-1]:.2f}")
            rows.append((ratios[0], f"| `{verb}` | {count:.0e} | {threads} | {' | '.join(cells)} |"))
            print(rows[-1][1], flush=True)
    rows.sort(reverse=True)
    head = "| batch (ns a state) | states | threads | the same in Rust | `batch` in Rust | Python with `out=` | ratio "
    head += "| new: the same in Rust | `batch` in Rust | Python | ratio |\n|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n"
    return head + "\n".join(row for _, row in rows)


def machine() -> str:
    """The processor, and the versions of the packages that are compared."""
    file = Path("/proc/cpuinfo")
    info = file.read_text() if file.exists() else ""
    names = [line.partition(":")[2].strip() for line in info.splitlines() if line.startswith("model name")]
    vectors = "with AVX-512" if "avx512f" in info else "without AVX-512"
    found = [f"{(names or [platform.processor()])[0]}, {len(os.sched_getaffinity(0))} cores, {vectors}",
             f"Python {platform.python_version()}"]  # fmt: skip
    for name in ("numpy", "pin", "adam-robotics", "mujoco-mjx", "jax"):
        try:
            found.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            continue
    return "; ".join(found)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("robot", nargs="?", type=Path, default=ROOT / "robots" / "ur5.urdf")
    parser.add_argument("--states", type=int, default=1_000_000)
    parser.add_argument("--minutes", type=float, default=25, help="after which the command ends; other packages share the rest")
    parser.add_argument("--write", action="store_true", help=f"write the tables into {PAGE.name}")
    given = parser.parse_args()
    end = time.monotonic() + 60 * given.minutes
    if not hasattr(costate.Dynamics, "_seconds"):
        raise SystemExit('build it first by: pip install ./python --config-settings=build-args="--features timing"')
    warnings.simplefilter("ignore", costate.RobotWarning)
    robot = costate.Robot.from_file(given.robot)
    parts = [f"{robot.name}, n = {robot.n}; {machine()}"]
    for part in (lambda: overhead(robot), lambda: batches(robot, given.states), lambda: peers(robot, given.robot, end)):
        parts.append(part())
        print(parts[-1], flush=True)
    text = "\n\n".join(parts) + "\n"
    if given.write:
        page = PAGE.read_text()
        before, rest = page.split("<!-- times: begin -->\n")
        PAGE.write_text(f"{before}<!-- times: begin -->\n{text}<!-- times: end -->{rest.split('<!-- times: end -->')[1]}")


if __name__ == "__main__":
    main()
