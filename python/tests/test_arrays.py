"""Arguments and results: layouts, broadcasting, bad states, threads, memory."""

import sys
import threading
import tracemalloc
import warnings

import costate
import numpy as np
import pytest
from conftest import assert_close


@pytest.fixture
def dynamics(ur5):
    return costate.Dynamics(ur5)


@pytest.mark.parametrize("count", [1, 3, 15, 16, 17, 18, 19, 67, 1001])
@pytest.mark.parametrize("coordinates", ["qv", "qp"])
def test_a_batch_is_one_state_after_the_other(ur5, random, count, coordinates):
    dynamics = costate.Dynamics(ur5, coordinates)
    q, v, tau = random.normal(size=(3, count, 6))
    y, d = random.normal(size=(count, 12)), random.normal(size=(count, 18))
    calls = {
        "f": (q, v, tau),
        "linearise": (q, v, tau),
        "contract": (q, v, tau, y),
        "adjoint": (q, v, tau, y),
        "hvp": (q, v, tau, y, d),
        "rnea": (q, v, tau),
        "crba": (q,),
        "energy": (q, v),
        "momentum": (q, v),
    }
    for name, arguments in calls.items():
        method = getattr(dynamics, name)
        many = method(*arguments)
        for k in {0, count // 2, count - 1}:
            one = method(*(argument[k] for argument in arguments))
            for found, expected in zip(*((of,) if isinstance(of, np.ndarray) else of for of in (many, one))):
                assert found.dtype == np.float64 and found.flags.c_contiguous
                assert_close(found[k], expected, 1e-11)


def test_leading_axes_are_broadcast_as_by_numpy(dynamics, random):
    q, v, tau = random.normal(size=(5, 1, 6)), random.normal(size=(3, 6)), random.normal(size=6)
    found = dynamics.jacobian(q, v, tau)
    assert found.shape == (5, 3, 12, 18)
    assert_close(found[4, 1], dynamics.jacobian(q[4, 0], v[1], tau), 1e-12)
    whole = np.broadcast_arrays(q, v, tau)
    assert_close(found, dynamics.jacobian(*(np.ascontiguousarray(part) for part in whole)), 1e-15)
    assert dynamics.jacobian(*whole).shape == found.shape  # views with steps of zero
    assert dynamics.f(np.zeros((0, 6)), v[0], tau).shape == (0, 12)
    assert dynamics.f(np.zeros((2, 1, 1, 6)), v, tau).shape == (2, 1, 3, 12)
    with pytest.raises(costate.ArgumentError, match="broadcast") as raised:
        dynamics.f(np.zeros((2, 6)), np.zeros((3, 6)), tau)
    assert raised.value.argument == "v"


def test_views_are_read_where_they_are(dynamics, random):
    x = random.normal(size=(50, 12))
    tau = np.zeros(6)
    expected = dynamics.f(x[:, :6].copy(), x[:, 6:].copy(), tau)
    assert_close(dynamics.f(x[:, :6], x[:, 6:], tau), expected, 1e-15)
    assert_close(dynamics.f(x[::-2, :6], x[::-2, 6:], tau), expected[::-2], 1e-12)
    bytes_ = np.zeros(6 * 8 + 1, dtype=np.uint8)
    unaligned = bytes_[1:].view(np.float64)
    unaligned[:] = x[0, :6]
    assert not unaligned.flags.aligned
    assert_close(dynamics.f(unaligned, x[0, 6:], tau), expected[0], 1e-12)


def test_sequences_are_converted(dynamics):
    zero = [0] * 6
    assert_close(dynamics.f(zero, (0.0,) * 6, zero), dynamics.f(*np.zeros((3, 6))), 1e-15)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (np.zeros((6, 4)).T, r"Fortran order.*ascontiguousarray\(v\)"),
        (np.zeros(12)[::2], "one after the other"),
        (np.zeros(6, dtype=np.float32), r"float32, not float64; pass v.astype\(float\)"),
        (np.zeros(6, dtype=int), "int64, not float64"),
        (np.zeros(6, dtype=">f8"), "not float64"),
        (np.zeros(7), r"shape \[7\], not \(..., 6\)"),
        (np.zeros(()), "shape"),
        (np.zeros((1,) * 9 + (6,)), "10 axes"),
        ("six", "not an array or a sequence of 6 numbers"),
        (None, "v"),
        ([0.0] * 5, r"\(..., 6\)"),
    ],
)
def test_what_does_not_fit_is_refused(dynamics, given, words):
    with pytest.raises(costate.ArgumentError, match=words) as raised:
        dynamics.f(np.zeros(6), given, np.zeros(6))
    assert raised.value.argument == "v" and isinstance(raised.value, ValueError)


def bad_states(random):
    """Seventy states of which two are not finite."""
    q = random.normal(size=(7, 10, 6))
    v = random.normal(size=(7, 10, 6))
    q[2, 3, 4], v[5, 0, 1] = np.nan, np.inf
    return q, v


def test_bad_states_raise_with_their_index(dynamics, random):
    q, v = bad_states(random)
    with pytest.raises(costate.NonFiniteState, match=r"state \[2, 3\]: q\[4\] \(joint 'wrist_2_joint'\)") as raised:
        dynamics.jacobian(q, v, np.zeros(6))
    error = raised.value
    assert (error.index, error.joint, error.argument) == ((2, 3), "wrist_2_joint", "q")
    with pytest.raises(costate.NonFiniteState, match="tau") as raised:
        dynamics.f(np.zeros(6), np.zeros(6), np.full(6, np.nan))
    assert raised.value.index == () and raised.value.argument == "tau"


def test_bad_states_are_rows_of_nan(ur5, random):
    q, v = bad_states(random)
    dynamics = costate.Dynamics(ur5, on_error="nan")
    with pytest.warns(costate.StateWarning, match=r"2 of 70 states.*\[2, 3\]"):
        f, jacobian = dynamics.linearise(q, v, np.zeros(6))
    bad = np.zeros((7, 10), dtype=bool)
    bad[2, 3] = bad[5, 0] = True
    assert np.isnan(f[bad]).all() and np.isnan(jacobian[bad]).all()
    assert np.isfinite(f[~bad]).all() and np.isfinite(jacobian[~bad]).all()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(costate.StateWarning):
            dynamics.f(np.full(6, np.nan), np.zeros(6), np.zeros(6))


def test_a_singular_mass_matrix_names_its_joint():
    builder = costate.Robot.builder("gimbal")
    builder.revolute("z", axis=[0, 0, 1]).revolute("y", on="z", axis=[0, 1, 0])
    builder.revolute("x", on="y", axis=[1, 0, 0], mass=1, inertia=[0.2, 0.3, 0.4])
    robot = builder.build()
    dynamics = costate.Dynamics(robot)
    q = np.zeros((20, 3))
    q[11, 1] = np.pi / 2
    with pytest.raises(costate.SingularMassMatrix) as raised:
        dynamics.f(q, np.zeros(3), np.zeros(3))
    assert raised.value.index == (11,) and raised.value.joint in robot.joint_names
    assert np.isfinite(dynamics.rnea(q, np.zeros(3), np.zeros(3))).all()


def test_threads_change_nothing(ur5, random):
    q, v, tau = random.normal(size=(3, 20_001, 6))
    y = random.normal(size=12)
    alone, together = costate.Dynamics(ur5, threads=1), costate.Dynamics(ur5, threads=4)
    for found, expected in zip(together.contract(q, v, tau, y), alone.contract(q, v, tau, y)):
        assert (found == expected).all()


def test_eight_python_threads_share_one_object(dynamics, random):
    q, v, tau = random.normal(size=(3, 400, 6))
    expected = dynamics.jacobian(q, v, tau)
    failures = []

    def work(seed):
        order = np.random.default_rng(seed).permutation(400)
        for k in order:
            size = np.abs(expected[k]).max()
            if np.abs(dynamics.jacobian(q[k], v[k], tau[k]) - expected[k]).max() > 1e-11 * size:
                failures.append(k)
        if not (dynamics.jacobian(q, v, tau) == expected).all():
            failures.append(seed)

    threads = [threading.Thread(target=work, args=(seed,)) for seed in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failures


def test_memory_does_not_grow(dynamics, random):
    """A million calls: a leak of 4 bytes in each would be seen."""
    resource = pytest.importorskip("resource")
    q, v, tau = random.normal(size=(3, 6))
    batch = random.normal(size=(2000, 6))
    y = random.normal(size=12)

    def work(count):
        for k in range(count):
            dynamics.contract(q, v, tau, y)
            if k % 1000 == 0:
                dynamics.contract(batch, v, tau, y)
            if k % 100 == 0:
                with pytest.raises(costate.ArgumentError):
                    dynamics.f(q, v[:3], tau)

    def most() -> int:
        """The most memory so far (kB); macOS counts bytes."""
        most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        return most // 1024 if sys.platform == "darwin" else most

    work(5_000)
    before = most()
    work(1_000_000)
    assert most() - before < 4_000


def test_results_belong_to_the_caller(dynamics, random):
    q, v, tau = random.normal(size=(3, 6))
    tracemalloc.start()
    first = dynamics.f(q, v, tau)
    copy = first.copy()
    first[:] = 0
    assert (dynamics.f(q, v, tau) == copy).all() and first.flags.owndata and first.flags.writeable
    tracemalloc.stop()
