"""Robots and states that all tests use."""

import math
import signal
import warnings
from pathlib import Path

import costate
import numpy as np
import pytest
from interface import Recorder

ROBOTS = Path(__file__).parents[2] / "robots"
PROBLEMS = ROBOTS.parent / "examples" / "problems"
QUARTER = math.pi / 2

RECORDER = Recorder()
RAN: set[str] = set()  # Files whose tests other processes ran.


def pytest_configure() -> None:
    RECORDER.install()
    # In the background of a shell Ctrl-C is ignored, and would be in the programs that tests start and interrupt.
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_terminal_summary(terminalreporter) -> None:
    """What of the public interface the tests have called, in all processes."""
    terminalreporter.write_line(RECORDER.summary())


def pytest_sessionfinish(session, exitstatus) -> None:
    """All of it must be called where all tests ran; processes of pytest-xdist tell the one that started them."""
    if hasattr(session.config, "workeroutput"):
        files = sorted({item.path.name for item in session.items})
        session.config.workeroutput |= {"called": sorted(RECORDER.called), "files": files}
        return
    files = RAN | {item.path.name for item in getattr(session, "items", ())}
    everything = files >= {path.name for path in Path(__file__).parent.glob("test_*.py")} and not session.config.option.keyword
    if everything and exitstatus == 0 and RECORDER.missing():
        session.exitstatus = 1


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node, error) -> None:
    """What a process of pytest-xdist has called."""
    output = getattr(node, "workeroutput", {})
    RECORDER.called.update(output.get("called", ()))
    RAN.update(output.get("files", ()))


def load(name: str) -> costate.Robot:
    """A robot of the repository, without its warnings."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", costate.RobotWarning)
        return costate.Robot.from_file(ROBOTS / name)


@pytest.fixture(scope="session")
def ur5() -> costate.Robot:
    return load("ur5.urdf")


@pytest.fixture(scope="session")
def puma() -> costate.Robot:
    return load("puma560.toml")


@pytest.fixture(scope="session")
def arm() -> costate.Robot:
    """Two links in a plane."""
    return load("two_link.toml")


@pytest.fixture(scope="session")
def limited(arm) -> costate.Problem:
    """A quarter turn of both joints of the arm in 1 s, with |v_2| <= 7."""
    limits = {"v_max": [math.inf, 7.0], "from_robot": False}
    return costate.Problem(arm, start=[0, 0], end=[QUARTER, QUARTER], time=1.0, cost=[1, 1], limits=limits)


@pytest.fixture(scope="session")
def solved(limited) -> costate.Solution:
    return limited.solve(tolerance=1e-7)


@pytest.fixture
def random() -> np.random.Generator:
    return np.random.default_rng(17)


def pendulum(mass: float = 2.0, length: float = 0.7) -> costate.Robot:
    """A point mass below a hinge about y: every quantity is known."""
    return costate.Robot.builder("pendulum").revolute("hinge", axis=[0, 1, 0], mass=mass, com=[0, 0, -length]).build()


def central_differences(function, z: np.ndarray, step: float = 1e-6) -> np.ndarray:
    """Finite differences of a function, columns by entries of z; they judge derivatives to about 1e-8."""
    columns = [(function(z + step * unit) - function(z - step * unit)) / (2 * step) for unit in np.eye(len(z))]
    return np.stack(columns, axis=-1)


def assert_close(found, expected, relative: float = 1e-12) -> None:
    """Entries differ by at most this part of the largest one."""
    found, expected = np.asarray(found), np.asarray(expected)
    assert found.shape == expected.shape
    assert np.isfinite(found).all()
    size = max(np.abs(expected).max(initial=0.0), 1e-300)
    assert np.abs(found - expected).max(initial=0.0) <= relative * size
