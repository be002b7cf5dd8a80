"""Ctrl-C, other threads and the end of the interpreter during a solve, in processes of their own."""

import os
import signal
import subprocess
import sys
import textwrap
import threading
import time

import costate
import pytest
from conftest import ROBOTS

# Takes much longer than any test waits: sixty starts of an arm that goes round a post, to many digits.
LONG = f"""
import costate, signal, threading, time, sys, os
# Shells let what they start in the background ignore it.
signal.signal(signal.SIGINT, signal.default_int_handler)
problem = costate.Problem.from_file({str(ROBOTS.parent / "examples/problems/panda_reach.toml")!r})
options = dict(starts=60, tolerance=1e-9, threads=2)
def ready(step, told=[]):
    if not told:
        told.append(1)
        print("ready", flush=True)
"""


def start(code: str) -> subprocess.Popen:
    """A process that has begun to solve."""
    command = [sys.executable, "-W", "ignore", "-c", LONG + textwrap.dedent(code)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout is not None and process.stdout.readline() == "ready\n", process.communicate()[1]
    return process


def ended(process: subprocess.Popen, seconds: float = 60) -> tuple[str, str]:
    try:
        return process.communicate(timeout=seconds)
    finally:
        process.kill()


posix = pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")


@posix
def test_an_interrupt_raises_with_the_best_motion():
    process = start(
        """
        try:
            problem.solve(progress=ready, **options)
        except costate.Interrupted as interrupted:
            assert isinstance(interrupted, KeyboardInterrupt)
            print(interrupted.solution.status, len(interrupted.solution.t) > 1)
        """
    )
    process.send_signal(signal.SIGINT)
    out, err = ended(process)
    assert process.returncode == 0, err
    assert out == "cancelled True\n"


@posix
def test_an_interrupt_returns_the_best_motion_where_that_is_asked_for():
    process = start(
        """
        solution = problem.solve(progress=ready, on_interrupt="return", **options)
        print(solution.status)
        solution = problem.solve(time_limit=0.001)  # it goes on
        print(solution.status)
        """
    )
    process.send_signal(signal.SIGINT)
    out, err = ended(process)
    assert process.returncode == 0 and out == "cancelled\ntime_limit\n", err


@posix
def test_an_interrupt_that_nobody_catches_ends_the_process():
    process = start("problem.solve(progress=ready, **options)")
    process.send_signal(signal.SIGINT)
    _, err = ended(process)
    assert process.returncode != 0 and "Interrupted: interrupted: cancelled" in err


@posix
def test_an_interrupt_of_the_main_thread_leaves_a_solve_on_another_one_alone():
    process = start(
        """
        ended = threading.Event()
        def work():
            print(problem.solve(progress=ready, time_limit=2.0, **options).status, flush=True)
            ended.set()
        threading.Thread(target=work).start()
        try:
            ended.wait()
        except KeyboardInterrupt:
            print("interrupt", flush=True)
        ended.wait()
        """
    )
    process.send_signal(signal.SIGINT)
    out, err = ended(process)
    lines = out.split()
    # However it ends: it was not cancelled.
    assert process.returncode == 0 and lines[0] == "interrupt" and lines[1:] != ["cancelled"] and len(lines) == 2, (out, err)


@pytest.mark.parametrize("progress", ["None", "ready"])
def test_the_interpreter_ends_while_another_thread_solves(progress):
    for _ in range(3):
        process = start(
            f"""
            if {progress} is None:
                print("ready", flush=True)
            work = lambda: problem.solve(progress={progress}, **options)
            thread = threading.Thread(target=work, daemon=True)
            thread.start()
            time.sleep(0.3)
            """
        )
        _, err = ended(process)
        assert process.returncode == 0 and err == ""


def test_other_threads_run_while_a_problem_is_solved():
    problem = costate.Problem.from_file(ROBOTS.parent / "examples/problems/ur5_reach.toml")
    thread, ticks = threading.Thread(target=problem.solve), 0
    thread.start()
    while thread.is_alive():
        time.sleep(0.001)
        ticks += 1
    assert ticks > 3


def test_one_problem_on_several_threads():
    problem = costate.Problem.from_file(ROBOTS.parent / "examples/problems/two_link.toml")
    found = []
    threads = [threading.Thread(target=lambda: found.append(problem.solve(polish=False))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 4 and all(solution == found[0] for solution in found)
