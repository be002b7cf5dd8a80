"""What arguments are refused, and how errors name them."""

import os
import pickle
import threading
import time

import costate
import numpy as np
import pytest
from conftest import ROBOTS, assert_close, load, pendulum

DYNAMICS = {
    "f": ("q", "v", "tau"),
    "jacobian": ("q", "v", "tau"),
    "hessian": ("q", "v", "tau", "y"),
    "linearise": ("q", "v", "tau"),
    "contract": ("q", "v", "tau", "y"),
    "adjoint": ("q", "v", "tau", "y"),
    "hvp": ("q", "v", "tau", "y", "d"),
}
ROBOT = {
    "aba": ("q", "v", "tau"),
    "rnea": ("q", "v", "a"),
    "rnea_jacobian": ("q", "v", "a"),
    "rnea_hessian": ("q", "v", "a", "w"),
    "crba": ("q",),
    "energy": ("q", "v"),
    "momentum": ("q", "v"),
    "velocity": ("q", "p"),
    "centre_of_mass": ("q",),
    "centroidal_momentum": ("q", "v"),
}
FRAME = {
    "pose": ("q",),
    "jacobian": ("q",),
    "jacobian_rate": ("q", "v"),
    "twist": ("q", "v"),
    "acceleration": ("q", "v", "a"),
    "position_hessian": ("q", "w"),
}


def methods(robot):
    """Every method on arrays, with the names and lengths of its arguments."""
    n = robot.n
    lengths = {"y": 2 * n, "d": 3 * n}
    for coordinates in ("qv", "qp"):
        dynamics = costate.Dynamics(robot, coordinates)
        steps = ["rk4", "midpoint", "semi_implicit_euler" if coordinates == "qv" else "verlet"]
        owners = [(dynamics, {**DYNAMICS, **ROBOT})]
        owners += [(costate.Step(dynamics, name, 1e-3), {**DYNAMICS, "dt_derivative": ("q", "v", "tau")}) for name in steps]
        for owner, verbs in owners:
            for verb, names in verbs.items():
                yield getattr(owner, verb), [(name, lengths.get(name, n)) for name in names]
        for verb, names in FRAME.items():
            frame = dynamics.frame(f"joint:{robot.joint_names[-1]}")
            yield getattr(frame, verb), [(name, 3 if name == "w" else n) for name in names]


def coordinates_of(method) -> str:
    """Those of the state of a method of dynamics or of a step."""
    owner = method.__self__
    return getattr(getattr(owner, "dynamics", owner), "coordinates", "qv")


@pytest.mark.parametrize("states", [None, 40])
def test_one_rule_for_numbers_that_are_not_finite(states, random):
    """Each entry of each argument of each method is looked at, whether or not the result depends on it."""
    robot = load("two_link.toml")
    leading = () if states is None else (states,)
    for method, arguments in methods(robot):
        given = [0.3 * random.normal(size=(*leading, length)) for _, length in arguments]
        method(*given)
        for k, (name, length) in enumerate(arguments):
            for entry in range(length):
                bad = [part.copy() for part in given]
                at = (*(17 for _ in leading), entry)
                bad[k][at] = np.nan if entry % 2 else np.inf
                with pytest.raises(costate.NonFiniteState) as raised:
                    method(*bad)
                error = raised.value
                in_space = name == "w" and length == 3
                # Momenta have their own name, that of the parameter is v.
                momenta = name == "v" and method.__name__ in {*DYNAMICS, "dt_derivative"} and coordinates_of(method) == "qp"
                name = "p" if momenta else name
                assert error.argument == name, method
                assert error.joint == (None if in_space else robot.joint_names[entry % 2]), method
                assert error.index == at[:-1] and f"{name}[{entry}]" in str(error), method


def test_the_first_argument_is_named_and_nan_is_a_choice(random):
    robot = load("two_link.toml")
    bad = np.full(4, np.nan)
    with pytest.raises(costate.NonFiniteState, match=r"^q\[0\]"):
        costate.Dynamics(robot).hvp(bad[:2], bad[:2], bad[:2], bad, np.full(6, np.nan))
    quiet = costate.Dynamics(robot, on_error="nan")
    y = np.ones((30, 4))
    y[3, 0] = np.nan  # y_q, on which the Hessian in velocities does not depend
    with pytest.warns(costate.StateWarning, match="1 of 30"):
        found = quiet.hessian(*random.normal(size=(3, 2)), y)
    assert np.isnan(found[3]).all() and np.isfinite(np.delete(found, 3, axis=0)).all()


def test_steps_beyond_all_numbers_are_not_a_fault_of_arguments():
    step = costate.Step(costate.Dynamics(pendulum()), "rk4", 1e300)
    with pytest.raises(costate.NonFiniteResult, match="'hinge' is beyond all numbers.*shorter step") as raised:
        step.f([0.0], [1e200], [0.0])
    assert raised.value.joint == "hinge" and raised.value.argument is None


@pytest.mark.parametrize("given", ["12", ["1", "2"], [1 + 0j, 2.0], [b"1", b"2"], [True, False], [None, 1.0], [[1.0], 2.0]])
def test_only_numbers_are_converted(given):
    dynamics = costate.Dynamics(load("two_link.toml"))
    with pytest.raises(costate.ArgumentError, match="v is not an array or a sequence of 2 numbers"):
        dynamics.f([0, 0], given, [0, 0])
    assert_close(dynamics.f([0, 0], [1, 2.5], (0, 1)), dynamics.f(np.zeros(2), np.array([1, 2.5]), np.array([0.0, 1])))


def test_the_hint_about_shapes_is_that_of_the_argument():
    robot = load("two_link.toml")
    frame = costate.Dynamics(robot).frame(f"joint:{robot.joint_names[-1]}")
    with pytest.raises(costate.ArgumentError, match=r"w has the shape \[2\], not \(..., 3\).*axes x, y, z"):
        frame.position_hessian(np.zeros(2), np.zeros(2))
    with pytest.raises(costate.ArgumentError, match=r"q has the shape.*joint_names"):
        frame.position_hessian(np.zeros(3), np.zeros(3))


def test_too_large_a_result_is_no_crash():
    dynamics = costate.Dynamics(pendulum())
    q = np.broadcast_to(np.zeros(1), (1 << 40, 1))
    with pytest.raises(MemoryError):
        dynamics.f(q, np.zeros(1), np.zeros(1))
    with pytest.raises((MemoryError, ValueError)):
        dynamics.f(np.broadcast_to(np.zeros(1), (1 << 60, 1)), np.zeros(1), np.zeros(1))
    many = np.broadcast_to(np.zeros(1), (1 << 40, 1, 1))
    with pytest.raises((MemoryError, ValueError, costate.ArgumentError)):
        dynamics.f(many, np.broadcast_to(np.zeros(1), (1 << 40, 1)), np.zeros(1))


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes")
def test_a_file_is_read_once(tmp_path):
    """A pipe gives its text a single time."""
    pipe = tmp_path / "arm.toml"
    os.mkfifo(pipe)
    text = (ROBOTS / "two_link.toml").read_text()
    writer = threading.Thread(target=pipe.write_text, args=(text,))
    writer.start()
    robot = costate.Robot.from_file(pipe)
    writer.join()
    assert pickle.loads(pickle.dumps(robot)) == robot == load("two_link.toml")


def test_compiling_lets_other_threads_run():
    """Python goes on while a quantity is compiled, and the backend does not compile it again."""
    dynamics = costate.Dynamics(load("humanoid32.urdf"))
    beats, done = [], threading.Event()

    def beat():
        while not done.is_set():
            beats.append(time.perf_counter())
            time.sleep(1e-3)

    thread = threading.Thread(target=beat)
    thread.start()
    start = time.perf_counter()
    words = dynamics.backend("contract")
    end = time.perf_counter()
    done.set()
    thread.join()
    # Five beats, unless the machine is so fast that there was no time for them.
    assert sum(start < at < end for at in beats) >= min(5, (end - start) / 0.1), (end - start, len(beats))
    assert dynamics.backend("hessian") == words and "code" in words


def test_equal_steps_have_equal_hashes():
    dynamics = costate.Dynamics(pendulum())
    plus, minus = (costate.Step(dynamics, "rk4", dt) for dt in (0.0, -0.0))
    assert plus == minus and hash(plus) == hash(minus)


def test_the_comparison_names_the_state():
    from costate._costate import _compare

    robot = pendulum()
    good, bad = [[0.1], [0.2], [0.3], [1.0, 2.0]], [[0.1], [0.2], [0.3], [1.0, float("nan")]]
    with pytest.raises(costate.StateError) as raised:
        _compare(robot, [good, good, bad])
    assert raised.value.index == (2,) and "state [2]" in str(raised.value)


def test_limits_that_change_nothing_are_refused():
    with pytest.raises(costate.ArgumentError, match="no limit is given"):
        pendulum().with_limits("hinge")


def test_tables_have_units():
    robot = costate.Robot.builder("mixed").revolute("hinge", mass=1, com=[1, 0, 0], lower=-1, upper=1, velocity=2, effort=3)
    html = robot.prismatic("rail", on="hinge", mass=1, lower=-1, upper=1, velocity=2, effort=3).build()._repr_html_()
    for words in ("-1.0000 rad<", "2.0000 rad/s<", "3.0000 N m<", "1.0000 m<", "2.0000 m/s<", "3.0000 N<"):
        assert words in html

