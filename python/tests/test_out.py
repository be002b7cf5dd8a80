"""Results in arrays of the caller."""

import inspect

import costate
import numpy as np
import pytest
from conftest import pendulum

N = 6
# Each verb with its arguments and the shapes of its results at one state.
DYNAMICS = {
    "f": ("q v tau", [(12,)]),
    "jacobian": ("q v tau", [(12, 18)]),
    "hessian": ("q v tau y", [(18, 18)]),
    "linearise": ("q v tau", [(12,), (12, 18)]),
    "contract": ("q v tau y", [(12,), (12, 18), (18, 18)]),
    "adjoint": ("q v tau y", [(18,)]),
    "hvp": ("q v tau y d", [(18,)]),
    "aba": ("q v tau", [(6,)]),
    "rnea": ("q v a", [(6,)]),
    "rnea_jacobian": ("q v a", [(6, 18)]),
    "rnea_hessian": ("q v a w", [(18, 18)]),
    "crba": ("q", [(6, 6)]),
    "energy": ("q v", [(), ()]),
    "momentum": ("q v", [(6,)]),
    "velocity": ("q p", [(6,)]),
    "centre_of_mass": ("q", [(3,)]),
    "centroidal_momentum": ("q v", [(6,), (6, 6)]),
}
STEP = {name: DYNAMICS[name] for name in ("f", "jacobian", "hessian", "linearise", "contract", "adjoint", "hvp")}
STEP["dt_derivative"] = ("q v tau", [(12,)])
FRAME = {
    "pose": ("q", [(3, 3), (3,)]),
    "jacobian": ("q", [(6, 6)]),
    "jacobian_rate": ("q v", [(6, 6)]),
    "twist": ("q v", [(6,)]),
    "acceleration": ("q v a", [(6,)]),
    "position_hessian": ("q x", [(6, 6)]),
}
LENGTHS = {"y": 12, "d": 18, "x": 3}


@pytest.fixture(scope="module")
def owners(ur5):
    dynamics = costate.Dynamics(ur5)
    return {"Dynamics": dynamics, "Step": costate.Step(dynamics, "rk4", 1e-2), "Frame": dynamics.frame("tool0")}


ALL = [("Dynamics", verb, of) for verb, of in DYNAMICS.items()]
ALL += [("Step", verb, of) for verb, of in STEP.items()]
ALL += [("Frame", verb, of) for verb, of in FRAME.items()]


def test_every_verb_is_listed():
    listed = {(owner, verb) for owner, verb, _ in ALL}
    for owner in ("Dynamics", "Step", "Frame"):
        methods = {
            name
            for name, of in vars(getattr(costate, owner)).items()
            if not name.startswith("_") and callable(of) and "out" in inspect.signature(of).parameters
        }
        assert {(owner, verb) for verb in methods} == {pair for pair in listed if pair[0] == owner}


@pytest.mark.parametrize("leading", [(), (3,), (5, 20)])
@pytest.mark.parametrize(("owner", "verb", "of"), ALL)
def test_results_are_written_where_the_caller_says(owners, random, owner, verb, of, leading):
    names, shapes = of
    given = [random.normal(size=(*leading, LENGTHS.get(name, N))) for name in names.split()]
    method = getattr(owners[owner], verb)
    expected = method(*given)
    memory = [np.full((*leading, *shape), np.nan) for shape in shapes]
    if len(shapes) == 1:
        found = method(*given, out=memory[0])
        assert found is memory[0] and (found == expected).all()
        return
    found = method(*given, out=tuple(memory))
    assert type(found) is tuple and all(array is own for array, own in zip(found, memory, strict=True))
    assert all((array == other).all() for array, other in zip(found, expected, strict=True))
    # None stands for a new array; a list serves as well.
    found = method(*given, out=[None, *memory[1:]])
    assert found[0] is not memory[0] and found[1] is memory[1] and (found[0] == expected[0]).all()


def test_arrays_that_do_not_fit_are_refused(owners, random):
    dynamics = owners["Dynamics"]
    q, v, tau = random.normal(size=(3, 40, N))
    fixed = np.empty((40, 12))
    fixed.flags.writeable = False
    unaligned = np.zeros(40 * 12 * 8 + 1, dtype=np.uint8)[1:].view(np.float64).reshape(40, 12)
    x = np.empty((40, 12))
    for out, words in [
        (np.empty((40, 11)), r"out has the shape \[40, 11\], not \[40, 12\]"),
        (np.empty((1, 40, 12)), "shape"),
        (np.empty((40, 12), dtype=np.float32), "float32, not float64"),
        (np.empty((40, 12), dtype=">f8"), "not float64"),
        (np.empty((12, 40)).T, "not C-contiguous"),
        (np.empty((80, 12))[::2], "not C-contiguous"),
        (unaligned, "not C-contiguous"),
        (fixed, "cannot be written to"),
        ([[0.0] * 12] * 40, "out is a list, not an array"),
        ((x,), "out is a tuple, not an array"),
    ]:
        with pytest.raises(costate.ArgumentError, match=words) as raised:
            dynamics.f(q, v, tau, out=out)
        assert raised.value.argument == "out"
    with pytest.raises(costate.ArgumentError, match="a tuple of 2 arrays"):
        dynamics.linearise(q, v, tau, out=x)
    with pytest.raises(costate.ArgumentError, match=r"out\[1\] has the shape"):
        dynamics.linearise(q, v, tau, out=(None, x))
    assert (dynamics.f(q, v, tau, out=x) == dynamics.f(q, v, tau)).all()


def test_memory_of_arguments_is_refused(owners, random):
    dynamics = owners["Dynamics"]
    z = random.normal(size=(40, N))
    v, tau = random.normal(size=(2, N))
    with pytest.raises(costate.ArgumentError, match="out shares memory with v"):
        dynamics.rnea(np.zeros(N), z, tau, out=z)
    with pytest.raises(costate.ArgumentError, match="out shares memory with q"):
        dynamics.rnea(z[::-1], v, tau, out=z)
    both = random.normal(size=(80, N))
    with pytest.raises(costate.ArgumentError, match="out shares memory with q"):
        dynamics.rnea(both[20:60], v, tau, out=both[40:])
    assert dynamics.rnea(both[:40], v, tau, out=both[40:]).base is both
    centre = np.empty((40, 3, 3))
    frame = owners["Frame"]
    with pytest.raises(costate.ArgumentError, match=r"out\[1\] shares memory with another array of out"):
        frame.pose(z, out=(centre, centre.reshape(-1)[:120].reshape(40, 3)))


def test_bad_states_are_not_a_number_in_the_arrays_of_the_caller(ur5, random):
    q, zero = random.normal(size=(40, N)), np.zeros(N)
    q[7, 2] = np.nan
    out = np.zeros((40, 12))
    with pytest.raises(costate.NonFiniteState):
        costate.Dynamics(ur5).f(q, zero, zero, out=out)
    assert np.isnan(out[7]).all() and np.isfinite(np.delete(out, 7, axis=0)).all()
    with pytest.warns(costate.StateWarning):
        assert costate.Dynamics(ur5, on_error="nan").f(q, zero, zero, out=out) is out


def test_a_result_of_one_number_is_written_too():
    robot = pendulum()
    kinetic, potential = np.zeros(()), np.zeros(())
    found = costate.Dynamics(robot).energy([0.3], [2.0], out=(kinetic, potential))
    assert found[0] is kinetic and abs(float(kinetic) - 0.5 * 2.0 * 0.7**2 * 4.0) < 1e-12
    assert abs(float(potential) + 2.0 * 9.81 * 0.7 * np.cos(0.3)) < 1e-12
