"""Batches over lanes: time steps, frames and momenta of many states are those of one after the other."""

import costate
import numpy as np
import pytest
from conftest import assert_close, load, pendulum

SCHEMES = [("rk4", "qv"), ("rk4", "qp"), ("midpoint", "qv"), ("midpoint", "qp"), ("verlet", "qp"),
           ("semi_implicit_euler", "qv")]  # fmt: skip
STEP = {
    "f": "q v tau", "jacobian": "q v tau", "hessian": "q v tau y", "linearise": "q v tau", "contract": "q v tau y",
    "adjoint": "q v tau y", "hvp": "q v tau y d", "dt_derivative": "q v tau",
}  # fmt: skip
BODY = {"momentum": "q v", "velocity": "q v", "centre_of_mass": "q", "centroidal_momentum": "q v"}
FRAME = {
    "pose": "q", "jacobian": "q", "jacobian_rate": "q v", "twist": "q v", "acceleration": "q v tau",
    "position_hessian": "q w",
}  # fmt: skip


def results(found) -> tuple:
    return found if isinstance(found, tuple) else (found,)


def compare(method, given, relative=1e-11) -> None:
    """A batch of as many states as there are, and each of them alone."""
    many = results(method(*given))
    for k in range(len(given[0])):
        for found, expected in zip(many, results(method(*(part[k] for part in given))), strict=True):
            assert_close(found[k], expected, relative)


def states(random, n, names, count):
    lengths = {"y": 2 * n, "d": 3 * n, "w": 3}
    return [random.normal(size=(count, lengths.get(name, n))) for name in names.split()]


@pytest.mark.parametrize(("scheme", "coordinates"), SCHEMES)
def test_steps(puma, random, scheme, coordinates):
    step = costate.Step(costate.Dynamics(puma, coordinates), scheme, 5e-3)
    for verb, names in STEP.items():
        given = states(random, puma.n, names, 18)
        # The equation of the implicit scheme is solved to a tolerance.
        compare(getattr(step, verb), given, 1e-8 if scheme == "midpoint" else 1e-10)


@pytest.mark.parametrize("axes", ["local", "world", "local_world_aligned"])
@pytest.mark.parametrize("file", ["ur5.urdf", "humanoid32.urdf"])
def test_frames(random, file, axes):
    robot = load(file)
    frame = costate.Dynamics(robot).frame(robot.frame_names[-1], axes)
    for verb, names in FRAME.items():
        compare(getattr(frame, verb), states(random, robot.n, names, 19))


@pytest.mark.parametrize("file", ["ur5.urdf", "puma560.toml", "humanoid32.urdf"])
def test_momenta_and_centres(random, file):
    robot = load(file)
    dynamics = costate.Dynamics(robot)
    for verb, names in BODY.items():
        compare(getattr(dynamics, verb), states(random, robot.n, names, 21), 1e-10)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_bad_state_beside_good_ones(ur5, random, bad):
    dynamics = costate.Dynamics(ur5, on_error="nan")
    step, frame = costate.Step(dynamics, "rk4", 1e-2), dynamics.frame("tool0")
    cases = [(step, STEP, name) for name in STEP] + [(dynamics, BODY, name) for name in BODY]
    cases += [(frame, FRAME, name) for name in FRAME]
    for owner, verbs, name in cases:
        given = states(random, 6, verbs[name], 70)
        expected = results(getattr(owner, name)(*given))
        for which, part in enumerate(given):
            at = 3 + 13 * which
            part[at, -1] = bad
        with pytest.warns(costate.StateWarning, match=f"{len(given)} of 70 states"):
            found = results(getattr(owner, name)(*given))
        good = np.ones(70, dtype=bool)
        good[[3 + 13 * which for which in range(len(given))]] = False
        for array, other in zip(found, expected, strict=True):
            assert np.isnan(array[~good]).all() and np.isfinite(array[good]).all()
            # Neighbours of a bad state are computed alone.
            size = np.abs(other).max()
            assert np.abs(array[good] - other[good]).max() <= 1e-11 * size
    q = np.zeros((40, 6))
    q[11, 2] = bad
    with pytest.raises(costate.NonFiniteState) as raised:
        costate.Dynamics(ur5).frame("tool0").pose(q)
    assert raised.value.index == (11,) and raised.value.joint == ur5.joint_names[2]


def test_threads_change_nothing(ur5, random):
    alone, together = (costate.Dynamics(ur5, threads=threads) for threads in (1, 4))
    q, v, tau = random.normal(size=(3, 5001, 6))
    for owner in (lambda of: costate.Step(of, "rk4", 1e-2).jacobian, lambda of: of.momentum):
        given = (q, v, tau)[: 3 if owner(alone).__name__ == "jacobian" else 2]
        assert (owner(alone)(*given) == owner(together)(*given)).all()


def test_a_robot_with_one_joint(random):
    robot = pendulum()
    step = costate.Step(costate.Dynamics(robot), "rk4", 1e-2)
    compare(step.contract, states(random, 1, "q v tau y", 33))
