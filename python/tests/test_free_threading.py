"""Objects that threads share: what is made on first use, edits, builders, time steps, motions, with and without the lock.

On an interpreter without the lock (3.14t) these calls run at the same time.
"""

import pickle
import subprocess
import sys
import sysconfig
import threading

import costate
import numpy as np
import pytest
from conftest import load

THREADS = 8


def at_once(work) -> list:
    """What a function of a number returned in threads that begin together; the error of one is raised."""
    barrier, found, failed = threading.Barrier(THREADS), [None] * THREADS, []

    def run(number: int) -> None:
        try:
            barrier.wait()
            found[number] = work(number)
        except BaseException as error:  # noqa: BLE001
            failed.append(error)

    threads = [threading.Thread(target=run, args=(number,)) for number in range(THREADS)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for error in failed:
        raise error
    return found


@pytest.mark.skipif(not sysconfig.get_config_var("Py_GIL_DISABLED"), reason="an interpreter with a lock")
def test_the_lock_stays_off():
    code = "import sys, costate; print(sys._is_gil_enabled())"
    done = subprocess.run([sys.executable, "-W", "error", "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "False\n"


@pytest.mark.parametrize("coordinates", ["qv", "qp"])
def test_what_is_made_on_first_use_is_made_once(coordinates, ur5, random):
    q, v, tau, y = *random.normal(size=(3, 100, 6)), random.normal(size=12)
    verbs = {"f": (q, v, tau), "jacobian": (q, v, tau), "contract": (q, v, tau, y), "crba": (q,), "momentum": (q, v)}
    expected = {verb: getattr(costate.Dynamics(ur5, coordinates), verb)(*given) for verb, given in verbs.items()}
    shared = costate.Dynamics(ur5, coordinates)
    names = [*verbs, *verbs]
    for verb, found in zip(names, at_once(lambda k: getattr(shared, names[k])(*verbs[names[k]]))):
        parts = [(each,) if isinstance(each, np.ndarray) else each for each in (found, expected[verb])]
        assert all((ours == theirs).all() for ours, theirs in zip(*parts, strict=True)), verb


def test_steps_frames_and_loops_are_shared(ur5, random):
    q, v, tau = random.normal(size=(3, 100, 6))
    dynamics = costate.Dynamics(ur5)
    step, frame = costate.Step(dynamics, "rk4", 0.01), dynamics.frame("tool0")
    linkage = costate.ConstrainedDynamics(load("four_bar.toml"))
    calls = [
        lambda: step.f(q, v, tau), lambda: frame.jacobian(q), lambda: linkage.f(q[:, :3], v[:, :3], tau[:, :3]),
        lambda: linkage.close(q[:, :3] * 0.1 + [1.0, -0.6, -2.0], ["crank"]),
    ]  # fmt: skip
    for k, found in enumerate(at_once(lambda k: calls[k % 4]())):
        assert (found == calls[k % 4]()).all() and np.isfinite(found).all()


def test_robots_are_changed_and_pickled_at_once(ur5):
    def work(number: int) -> costate.Robot:
        for _ in range(20):
            changed = pickle.loads(pickle.dumps(ur5)).with_payload("tool0", 1.0 + number).add_frame("tip", "tool0")
            assert pickle.loads(pickle.dumps(changed)) == changed and hash(changed) == hash(ur5)
        return changed

    for number, robot in enumerate(at_once(work)):
        assert robot == ur5.with_payload("tool0", 1.0 + number).add_frame("tip", "tool0")


def test_a_builder_takes_each_joint_or_refuses_it():
    builder = costate.Robot.builder("fan")

    def work(number: int) -> int:
        taken = 0
        for k in range(50):
            try:
                builder.revolute(f"joint_{number}_{k}", mass=1, com=[1, 0, 0])
                taken += 1
            except RuntimeError:  # Another thread uses it in this moment.
                pass
        return taken

    taken = sum(at_once(work))
    assert builder.build().n == taken > 0


def test_solves_run_beside_each_other():
    arm = load("two_link.toml")
    task = {"start": [0, 0], "end": [1.5, 1.0], "time": 1.0, "cost": [1, 1]}
    problem = costate.Problem(arm, **task)
    alone = problem.solve()
    for solution in at_once(lambda _: problem.solve(threads=1)):
        assert solution.status == alone.status and abs(solution.cost - alone.cost) < 1e-9 * alone.cost
        assert pickle.loads(pickle.dumps(solution)) == solution
