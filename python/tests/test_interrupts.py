"""Ctrl-C during batches, comparisons and solving again, in processes of their own."""

import os
import signal
import subprocess
import sys
import textwrap
import time

import pytest
from conftest import ROBOTS

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")

HEAD = f"""
import costate, numpy as np, signal, sys, threading, time, warnings
warnings.simplefilter("ignore")
ur5, humanoid = (costate.Robot.from_file({str(ROBOTS)!r} + name) for name in ("/ur5.urdf", "/humanoid32.urdf"))
"""


def interrupted(code: str, after: float = 0.7) -> str:
    """What a program prints that is interrupted a while after it said that it is ready."""
    command = [sys.executable, "-c", HEAD + textwrap.dedent(code)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None and process.stdout.readline() == "ready\n", process.communicate()[1]
        time.sleep(after)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == 0, err
    return out


# Batches of broadcast states, which take many seconds and little memory.
@pytest.mark.parametrize(
    ("owner", "verb", "states", "threads"),
    [
        ("dynamics", "hvp", 400_000, 1),
        ("dynamics", "hvp", 400_000, 2),
        ("costate.Step(costate.Dynamics(ur5, threads=1), 'rk4', 1e-2)", "hvp", 1_000_000, 1),
        ("dynamics.frame(humanoid.frame_names[-1])", "acceleration", 4_000_000, 1),
    ],
)
def test_a_batch_ends_with_what_was_reached(owner, verb, states, threads):
    out = interrupted(
        f"""
        dynamics = costate.Dynamics(humanoid, threads={threads})
        owner = {owner}
        n = 6 if isinstance(owner, costate.Step) else humanoid.n
        lengths, shape = ((n, n, 2 * n, 3 * n), (3 * n,)) if {verb!r} == "hvp" else ((n, n), (6,))
        rest = [np.full(k, 0.1) for k in lengths]
        q = np.broadcast_to(np.linspace(-0.5, 0.5, n), ({states}, n))
        out = np.empty(({states}, *shape))
        first = owner.{verb}(q[:64], *rest)
        print("ready", flush=True)
        try:
            owner.{verb}(q, *rest, out=out)
            print("not interrupted")
        except costate.Interrupted as caught:
            done = int(str(caught).split()[2])
            assert caught.reached is out and caught.solution is None and 0 < done < {states}, done
            assert np.isfinite(out[:done]).all() and np.isnan(out[done:]).all()
            # The object is as good as before.
            assert (out[:64] == first).all() and (owner.{verb}(q[:64], *rest) == first).all()
            print("interrupted")
        """,
        0.5,
    )
    assert out == "interrupted\n"


def test_what_the_handler_of_a_user_raises_is_raised():
    out = interrupted(
        """
        class Stop(Exception): pass
        def handler(number, frame): raise Stop
        signal.signal(signal.SIGINT, handler)
        q, y, d = np.zeros((500_000, humanoid.n)), np.ones(2 * humanoid.n), np.ones(3 * humanoid.n)
        dynamics = costate.Dynamics(humanoid, threads=1)
        dynamics.hvp(q[:20], q[0], q[0], y, d)
        print("ready", flush=True)
        try:
            dynamics.hvp(q, q[0], q[0], y, d)
            print("not interrupted")
        except Stop:
            print("stopped")
        """
    )
    assert out == "stopped\n"


def test_a_handler_that_does_not_raise_stops_nothing():
    out = interrupted(
        """
        seen = []
        signal.signal(signal.SIGINT, lambda number, frame: seen.append(time.perf_counter()))
        q, y, d = np.zeros((100_000, humanoid.n)), np.ones(2 * humanoid.n), np.ones(3 * humanoid.n)
        dynamics = costate.Dynamics(humanoid, threads=1)
        dynamics.hvp(q[:20], q[0], q[0], y, d)
        print("ready", flush=True)
        found = dynamics.hvp(q, q[0], q[0], y, d)
        end = time.perf_counter()
        # The signal came during the call, which is whole.
        assert np.isfinite(found).all() and len(seen) == 1 and seen[0] < end, (seen, end)
        print("whole")
        """,
        0.1,
    )
    assert out == "whole\n"


@pytest.mark.parametrize("how", ["signal.raise_signal(number)", "os.kill(os.getpid(), number)", "_thread.interrupt_main()"])
def test_signals_of_other_threads_reach_a_batch(how):
    """The handler runs on the main thread within the batch, and the batch goes on."""
    code = f"""
        import os, _thread
        number, seen, sent = signal.SIGINT, [], []
        signal.signal(number, lambda number, frame: seen.append(time.perf_counter()))
        q, y, d = np.zeros((100_000, humanoid.n)), np.ones(2 * humanoid.n), np.ones(3 * humanoid.n)
        dynamics = costate.Dynamics(humanoid, threads=1)
        dynamics.hvp(q[:20], q[0], q[0], y, d)
        def send():
            time.sleep(0.2)
            sent.append(time.perf_counter())
            {how}
        thread = threading.Thread(target=send)
        thread.start()
        found = dynamics.hvp(q, q[0], q[0], y, d)
        end = time.perf_counter()
        thread.join()
        assert np.isfinite(found).all() and len(seen) == 1
        assert seen[0] - sent[0] < max(0.5 * (end - sent[0]), 0.2), (seen[0] - sent[0], end - sent[0])
        print("within")
        """
    done = subprocess.run([sys.executable, "-c", HEAD + textwrap.dedent(code)], capture_output=True, text=True, timeout=60)
    assert done.stdout == "within\n", done.stderr


def test_a_comparison_ends_with_the_states_that_were_compared():
    out = interrupted(
        """
        import costate._check as module
        costate.check(ur5, 1)
        compare = module._compare
        def told(*given):  # The states are made: a slow machine takes long for that.
            print("ready", flush=True)
            return compare(*given)
        module._compare = told
        try:
            costate.check(ur5, 5_000)
            print("not interrupted")
        except costate.Interrupted as caught:
            report = caught.reached
            assert isinstance(report, costate.CheckReport) and report.passed and 0 < report.states < 5_000
            print("interrupted")
        """
    )
    assert out == "interrupted\n"


def test_a_comparison_ends_within_a_state():
    """A state of this chain takes many seconds; the call does not wait for it."""
    out = interrupted(
        """
        builder = costate.Robot.builder("chain")
        for k in range(80):
            on = {"on": f"joint_{k - 1}"} if k else {}
            builder.revolute(f"joint_{k}", axis=[k % 2, 1 - k % 2, 0], xyz=[0, 0, 0.1], mass=1, com=[0, 0, 0.05], **on)
        chain = builder.build()
        print("ready", flush=True)
        try:
            costate.check(chain, 1)
            print("not interrupted")
        except costate.Interrupted as caught:
            report = caught.reached
            assert (report.states, report.comparisons, report.passed) == (0, [], False)
            print("interrupted")
        """,
        0.5,
    )
    assert out == "interrupted\n"


RESOLVE = f"""
problem = costate.Problem.from_file({str(ROBOTS.parent / "examples/problems/panda_reach.toml")!r})
motion = problem.resolve(nodes=1501, tolerance=1e-12, machine_code="never")
"""


@pytest.mark.parametrize("how", ["raise", "return"])
def test_solving_again_ends_with_the_best_motion(how):
    out = interrupted(
        RESOLVE.replace("\n", "\n        ")
        + f"""
        print("ready", flush=True)
        try:
            found = motion.solve(on_interrupt={how!r})
        except costate.Interrupted as caught:
            assert {how!r} == "raise"
            found = caught.reached
        assert found.status == "cancelled" and found.iterations >= 1, found
        q, v, a = motion.state([0.0, motion.final_time])
        assert np.isfinite(motion.torques(0.1)).all() and np.isfinite(a).all()
        assert motion.solve(steps=1).status in ("iterations", "no_progress", "solved")
        print("best")
        """
    )
    assert out == "best\n"


def test_a_handler_that_uses_what_it_interrupts_is_told():
    out = interrupted(
        RESOLVE.replace("\n", "\n        ")
        + """
        def handler(number, frame):
            try:
                repr(motion)
            except RuntimeError as error:
                print("told" if "handler of a signal" in str(error) else error)
            raise KeyboardInterrupt
        signal.signal(signal.SIGINT, handler)
        print("ready", flush=True)
        assert motion.solve(on_interrupt="return").status == "cancelled"
        print(motion.final_time > 0)
        """
    )
    assert out == "told\nTrue\n"
