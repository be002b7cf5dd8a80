"""Everything that is compiled, each competitor a shared library behind peers/peer.h."""

import os
import subprocess
from dataclasses import dataclass
from pathlib import Path

import generated
import machine
import pinocchio as pinocchio_package
import symbolic
from compiling import build_once, compile_c
from machine import say

FLAGS = {"native": "-C target-cpu=native", "baseline": ""}
PEERS = ("pinocchio", "casadi", "costate", "generated")

# So that g++ takes the many small functions of Eigen into their callers, as clang++ does by itself.
GCC_INLINES = ("--param inline-unit-growth=3000 --param large-unit-insns=10000000 --param large-function-growth=10000 "
               "--param large-function-insns=100000 --param max-inline-insns-single=2000 --param max-inline-insns-auto=500")
BOOST = ("-DBOOST_MPL_LIMIT_LIST_SIZE=30 -DBOOST_MPL_LIMIT_VECTOR_SIZE=30 -DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS "
         "-DBOOST_FUSION_INVOKE_MAX_ARITY=12")


@dataclass
class Competitor:
    label: str
    flags: str
    library: Path
    file: Path


@dataclass
class Built:
    driver: Path
    competitors: list


def build(root, cache, robot, peers, kinds, flags):
    """The driver and the competitors for one robot."""
    sources = root / "benches/peers/peers"
    driver = build_once(cache, "driver", [machine.compilers()[0][1], "-O2", "-std=c11", sources / "driver.c", "-ldl"],
                        [sources / "driver.c", sources / "peer.h"])
    competitors = []
    if "pinocchio" in peers:
        competitors += pinocchio(cache, sources, robot)
    if "casadi" in peers:
        competitors += casadi(cache, sources, robot, kinds)
    if "costate" in peers:
        competitors += costate(root, cache, robot, flags)
    if "generated" in peers:
        competitors += [Competitor(*row, robot.urdf) for row in generated.build(root, cache, sources, robot)]
    return Built(driver, competitors)


def pinocchio(cache, sources, robot):
    """By every compiler there is: headers only, so that the flags reach all of it. Contacts are a file of their own: a
    compiler takes minutes for them."""
    source = "contacts" if robot.stands else "pinocchio"
    prefix = Path(pinocchio_package.__file__).resolve().parents[4]
    # Both hold the version of what is included.
    headers = [prefix / "include/pinocchio/config.hpp", Path(machine.eigen(), "Eigen/src/Core/util/Macros.h")]
    include = ["-isystem", prefix / "include", "-isystem", machine.eigen(), "-I", sources]
    found = []
    for name, _, cpp in machine.compilers():
        # With these g++ takes more than five minutes and 3 GB for contacts.
        raised = name == "gcc" and source == "pinocchio"
        flags = "-O3 -march=native -DNDEBUG" + (f" {GCC_INLINES}" if raised else "")
        command = [cpp, "-std=c++17", *flags.split(), *BOOST.split(), "-w", "-fPIC", "-shared", *include,
                   sources / f"{source}.cpp"]
        inputs = (sources / file for file in (f"{source}.cpp", "model.hpp", "joints.hpp", "peer.h"))
        library = build_once(cache, f"{source}-{name}.so", command, [*headers, *inputs])
        found.append(Competitor(f"pinocchio-{name}", flags.split(" --param")[0] + (", inlining raised" if raised else ""),
                                library, robot.model))
    return found


def casadi(cache, sources, robot, kinds):
    """Each form by every compiler, with and without -ffast-math; orders whose code is too long are left out."""
    found = []
    for form, orders in symbolic.write(robot, robot.folder / "casadi", kinds).items():
        define = [f"-DFORM={form}", *(["-DLAGRANGIAN"] if form.endswith("lagrangian") else [])]
        for name, c, _ in machine.compilers():
            for fast in ("", " -ffast-math"):
                # Code of this length takes a compiler minutes: one way to compile it is enough.
                if form.startswith("user") and fast == "":
                    continue
                flags = f"-O3 -march=native{fast}"
                library = compile_c(cache, f"{robot.name}-{form}-{name}{'-fast' if fast else ''}.so", c, flags, define,
                                    sources / "casadi.c", orders, sources / "peer.h")
                if library:
                    found.append(Competitor(f"casadi-{name}{'-fast' if fast else ''}", flags, library, robot.urdf))
    return found


def costate(root, cache, robot, flags):
    """The library at the flags of this processor and at those that every processor of its kind understands."""
    found = []
    for kind in flags:
        label, rustflags = f"costate-{kind}", FLAGS[kind]
        target = cache / label
        say(f"cargo build: {label}")
        environment = {**os.environ, "RUSTFLAGS": rustflags, "CARGO_TARGET_DIR": str(target)}
        done = subprocess.run(["cargo", "build", "--release", "--locked", "-q", "-p", "costate-peers"], cwd=root,
                              env=environment, check=False)
        if done.returncode:
            machine.stop("cargo cannot build costate-peers")
        library = next(path for path in (target / "release").glob("*costate_peers.*") if path.suffix in (".so", ".dylib"))
        found.append(Competitor(label, f"release, one unit a crate{', ' + rustflags if rustflags else ''}", library, robot.urdf))
    return found
