"""costate's answer to a task, by its command line."""

import json
import os
import resource
import subprocess

import numpy

import problem_file
from motion import Quartic, Sampled
from peer import Answer

# Keys of the JSON that may hold the time of the solver (s), the best first.
SECONDS = ("solve_cpu_time", "solve_time")
SOLVED = ("converged", "converged_smoothed")


class Ours:
    def __init__(self, cache, costate, peer, tolerance, limit, arguments):
        """`tolerance` is None for the options that the command has by default."""
        self.folder = cache / "tasks" / ("default" if tolerance is None else f"{tolerance:g}")
        self.folder.mkdir(parents=True, exist_ok=True)
        self.costate, self.peer, self.tolerance = costate, peer, tolerance
        self.limit, self.arguments = limit, list(arguments)
        self.understands_limits = None

    def write(self, task, starts=None):
        if self.understands_limits is None:
            self.understands_limits = self._probe(task)
        file = self.folder / (f"{task.name}.toml" if starts is None else f"{task.name}_{starts}_starts.toml")
        file.write_text(problem_file.text(task, self.understands_limits, self.tolerance, starts))
        return file

    def _probe(self, task):
        """Whether this costate knows the table `[limits]`; one that does not names it as unknown."""
        file = self.folder / "probe.toml"
        simple = task.but(from_robot=False, tool=None, q_min=None, q_max=None, q_end=task.q_start + 0.1, obstacles=[])
        file.write_text(problem_file.text(simple, True, self.tolerance))
        done = self._run(file, 1.0)
        return not (done.returncode == 2 and "limits" in done.stderr)

    def _run(self, file, limit, times=1):
        command = [self.costate, "optimize", file, "--json", "--time-limit", str(limit), *self.arguments]
        if times > 1:
            command += ["--repeat", str(times)]
        one_core = {**os.environ, "RAYON_NUM_THREADS": "1"}
        return subprocess.run(command, capture_output=True, text=True, check=False, env=one_core)

    def solve(self, task, times=1, starts=None):
        """Solved so many times in one process; the first time compiles the dynamics of the robot."""
        file = self.write(task, starts)
        before = children_seconds()
        done = self._run(file, self.limit, times)
        process = children_seconds() - before
        if done.returncode not in (0, 3) or not done.stdout.strip():
            reason = (done.stderr.strip().splitlines() or ["no output"])[0]
            reason = reason.replace(str(file), file.name).removeprefix("error: ")
            return Answer("costate", f"refused: {reason[:100]}", False, numpy.nan, numpy.nan, 0, process, process)
        found = json.loads(done.stdout)
        seconds = next((found[key] for key in SECONDS if found.get(key) is not None), process)
        motion = self.motion(task, found["trajectory"]) if found["trajectory"].get("t") else None
        cost = numpy.nan if found["cost"] is None else found["cost"]
        duration = numpy.nan if found["final_time"] is None else found["final_time"]
        return Answer("costate", found["status"], done.returncode == 0, cost, duration, found["newton_iterations"], seconds,
                      process, motion)

    def motion(self, task, trajectory):
        t, q, v, u = (numpy.array(trajectory[key], dtype=float) for key in ("t", "q", "v", "u"))
        torques = lambda *z: self.peer.torques(task, *z)
        if Quartic.suits(t):
            # Without its torques: they are cut to their limits.
            return Quartic(t, q, v, torques)
        one = lambda *z: torques(*(numpy.array(row)[None] for row in z))[0]
        return Sampled(t, q, v, self.peer.accelerations(task, q, v, u), u, one)


def children_seconds():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime
