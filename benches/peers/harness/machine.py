"""The machine, the compilers and what they are found with."""

import glob
import os
import re
import shutil
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path


def stop(message):
    """Ends the comparison, `peers` or another one, by the name of its folder."""
    sys.exit(f"{Path(sys.argv[0]).resolve().parents[1].name}: {message}")


def say(message):
    print(message, file=sys.stderr, flush=True)


def newest(name):
    """`clang` or the newest `clang-19`, ...; None where there is none."""
    numbered = [path for folder in os.get_exec_path() for path in glob.glob(f"{folder}/{name}-[0-9]*")]
    numbered = [path for path in numbered if re.fullmatch(rf"{re.escape(name)}-\d+", Path(path).name)]
    numbered.sort(key=lambda path: int(path.rsplit("-", 1)[1]))
    return numbered[-1] if numbered else shutil.which(name)


COMPILERS = {"gcc": ("gcc", "g++"), "clang": ("clang", "clang++")}
chosen = list(COMPILERS)


def compilers():
    """(name, C compiler, C++ compiler) of what is installed and chosen."""
    found = [(name, *map(newest, COMPILERS[name])) for name in chosen]
    found = [row for row in found if row[1] and row[2]]
    if not found:
        stop("no C++ compiler: install gcc and g++, or clang (Debian: apt-get install g++ clang)")
    return found


def eigen():
    """Folder of the headers of Eigen 3.4."""
    for folder in filter(None, (os.environ.get("EIGEN3_INCLUDE"), "/usr/include/eigen3", "/usr/local/include/eigen3")):
        if Path(folder, "Eigen/Core").exists():
            return folder
    stop("the headers of Eigen are missing (Debian: apt-get install libeigen3-dev); or set EIGEN3_INCLUDE to them")


def first_line(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()[0]


def describe(options):
    """What stands at the head of the figures."""
    info = Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").exists() else ""
    model = re.search(r"model name\s*:\s*(.*)", info)
    flags = re.search(r"flags\s*:\s*(.*)", info)
    sets = [name for name in ("avx2", "fma", "avx512f") if flags and name in flags.group(1).split()]
    return {
        "machine": f"{model.group(1) if model else 'unknown'}, {os.cpu_count()} cores, {' '.join(sets)}",
        "compilers": [first_line(c, "--version") for _, c, _ in compilers()] + [first_line("rustc", "--version")],
        "packages": {name: version(name) for name in ("pin", "casadi")},
        "states": options.states,
        "batches": options.batches * options.rounds,
        "milliseconds": options.milliseconds,
    }
