"""Results that are beyond all numbers are errors of their state, in every function of arrays."""

import costate
import numpy as np
import pytest
from conftest import assert_close, load

BIG = 1e200


@pytest.fixture(scope="module")
def arguments(ur5):
    rng = np.random.default_rng(2)
    return {name: rng.normal(size=size) for name, size in [("q", 6), ("v", 6), ("tau", 6), ("y", 12), ("d", 18)]}


@pytest.mark.parametrize("coordinates", ["qv", "qp"])
@pytest.mark.parametrize("verb", ["f", "jacobian", "hessian", "linearise", "contract", "adjoint", "hvp"])
def test_dynamics(ur5, arguments, coordinates, verb):
    names = ["q", "v", "tau"] + ["y"] * (verb in ("hessian", "contract", "adjoint", "hvp")) + ["d"] * (verb == "hvp")
    for states in (1, 40):
        given = {name: np.tile(arguments[name], (states, 1)) for name in names}
        given["v"][states // 2, 3] = BIG
        with pytest.raises(costate.NonFiniteResult, match=r"[vp]\[3\] \(joint 'wrist_1_joint'\) = 1e200") as raised:
            getattr(costate.Dynamics(ur5, coordinates), verb)(*given.values())
        error = raised.value
        assert (error.index, error.joint, error.argument) == ((states // 2,), "wrist_1_joint", coordinates[1])
        with pytest.warns(costate.StateWarning, match=f"1 of {states} states"):
            found = getattr(costate.Dynamics(ur5, coordinates, on_error="nan"), verb)(*given.values())
        found = found if isinstance(found, tuple) else (found,)
        good = np.arange(states) != states // 2
        for part in found:
            assert np.isnan(part[states // 2]).all() and np.isfinite(part[good]).all()


def test_products_that_overflow_are_noticed_on_lanes(ur5, arguments):
    given = [np.tile(arguments[name], (40, 1)) for name in ("q", "v", "tau", "y")]
    given[3][7] = 1e308
    with pytest.raises(costate.NonFiniteResult, match=r"y\[0\]") as raised:
        costate.Dynamics(ur5).adjoint(*given)
    assert raised.value.index == (7,)


@pytest.mark.parametrize("scheme", ["rk4", "semi_implicit_euler", "midpoint"])
def test_steps_agree_about_it(ur5, arguments, scheme):
    step = costate.Step(costate.Dynamics(ur5), scheme, 1e-3)
    q, v, tau = arguments["q"], np.full(6, BIG), arguments["tau"]
    with pytest.raises((costate.NonFiniteResult, costate.StepNotSolved) if scheme == "midpoint" else costate.NonFiniteResult):
        step.f(q, v, tau)


def test_methods_of_the_robot_agree_about_it(ur5, arguments):
    dynamics, q, v = costate.Dynamics(ur5), arguments["q"], np.full(6, BIG)
    for call in (
        lambda: dynamics.rnea(q, v, v),
        lambda: dynamics.aba(q, v, v),
        lambda: dynamics.energy(q, v),
        lambda: dynamics.frame("tool0").acceleration(q, v, v),
    ):
        with pytest.raises(costate.NonFiniteResult):
            call()
    assert_close(dynamics.momentum(q, v) / BIG, dynamics.crba(q) @ np.ones(6), 1e-12)  # large, and finite


def test_constraints_agree_about_it():
    fivebar = costate.Robot.builder("arm").revolute("a", axis=[0, 0, 1], mass=1, com=[1, 0, 0])
    robot = fivebar.revolute("b", on="a", xyz=[1, 0, 0], axis=[0, 0, 1], mass=1, com=[1, 0, 0]).build()
    with pytest.raises(costate.NonFiniteResult):
        costate.ConstrainedDynamics(robot).f([0.1, 0.2], [BIG, 0], [0, 0])


def test_threads_are_a_whole_number(ur5):
    for threads in (-1, 0, True, 2.0, 100_000, 2**70, "two"):
        with pytest.raises(costate.ArgumentError, match="from 1 to 4096") as raised:
            costate.Dynamics(ur5, threads=threads)
        assert raised.value.argument == "threads"
    assert costate.Dynamics(ur5, threads=np.int64(2)).threads == 2


def test_codegen_has_the_limit_that_its_message_advises():
    humanoid = load("humanoid32.urdf")
    with pytest.raises(costate.CodegenError, match=r"Raise the limit \(limit=") as raised:
        costate.codegen(humanoid, "y_f_xx")
    assert "--" not in str(raised.value)
    small = costate.Robot.builder("cart").prismatic("rail", axis=[1, 0, 0], mass=2).build()
    with pytest.raises(costate.CodegenError):
        costate.codegen(small, "y_f_xx", limit=1)
    assert costate.codegen(small, "y_f_xx", limit=100_000) == costate.codegen(small, "y_f_xx")


def test_messages_speak_of_python(ur5):
    with pytest.raises(costate.RobotError, match="robot.frame_names lists the names"):
        costate.Dynamics(ur5).frame("nowhere at all")
    assert repr(costate.Robot.builder("arm").revolute("a", mass=1).frame("tip", "a")) == (
        "RobotBuilder('arm', joints=['a'], frames=['tip'])"
    )


def test_names_of_frames_that_occur_twice(ur5):
    assert ur5.frame_names.count("world") == 2
    for name in ("world", "link:world"):
        assert np.array_equal(costate.Dynamics(ur5).frame(name).pose(np.zeros(6))[1], np.zeros(3))
