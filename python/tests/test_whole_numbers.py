"""Counts and places in lists: what is no whole number, negative or too large is refused by the name of the argument."""

import costate
import numpy as np
import pytest
from conftest import pendulum

START, TIP = [0.0, 0.0], "joint:elbow"


@pytest.fixture(scope="module")
def motion(arm) -> costate.Resolve:
    """With one of each thing that can be set by its number."""
    knots = {"times": [0, 1], "positions": [START, START], "weights": [1.0, 1.0]}
    away = {"frame": TIP, "xyz": [1.0, 0.0, 0.0], "rpy": [0.0, 0.0, 0.0]}
    via = [{"q": [0.5, 0.2], "time": 0.5}]
    ball = [{"kind": "sphere", "xyz": [5.0, 0.0, 0.0], "radius": 0.1}]
    body = {"capsule": [{"frame": TIP, "radius": 0.05}]}
    cost = {"effort": [1, 1], "reference": [knots], "tool": [away]}
    tables = {"via": via, "obstacle": ball, "collision": body, "cost": cost}
    return costate.Problem(arm, start=START, end=[1.0, 0.5], time=1.0, **tables).resolve()


CALLS = {
    "set_via": ("number", lambda motion, k: motion.set_via(k, [0.5, 0.2], START)),
    "set_obstacle": ("number", lambda motion, k: motion.set_obstacle(k, kind="sphere", xyz=[5.0, 0.1, 0.0], radius=0.1)),
    "set_reference": ("number", lambda motion, k: motion.set_reference(k, times=[0, 1], positions=[START] * 2, weights=[1.0] * 2)),
    "set_tool_cost": ("number", lambda motion, k: motion.set_tool_cost(k, [1.0, 0.1, 0.0])),
    "set_start_tool": ("number", lambda motion, k: motion.set_start_tool(k, [1.0, 0.1, 0.0])),
    "set_end_tool": ("number", lambda motion, k: motion.set_end_tool(k, [1.0, 0.1, 0.0])),
    "set_start_orientation": ("number", lambda motion, k: motion.set_start_orientation(k, rpy=[0.0, 0.0, 1.0])),
    "set_end_orientation": ("number", lambda motion, k: motion.set_end_orientation(k, rpy=[0.0, 0.0, 1.0])),
    "set_tool_cost_orientation": ("number", lambda motion, k: motion.set_tool_cost_orientation(k, rpy=[0.0, 0.0, 1.0])),
    "set_limit": ("joint", lambda motion, k: motion.set_limit("v_max", 1.0, k)),
    "derivative_by": ("joint", lambda motion, k: motion.derivative_by("v_max", k)),
    "derivative_by_task": ("entry", lambda motion, k: motion.derivative_by_task("keep", k)),
    "solve": ("steps", lambda motion, k: motion.solve(steps=k)),
    "states of check": ("states", lambda _, k: costate.check(pendulum(), k)),
    "seed of check": ("seed", lambda _, k: costate.check(pendulum(), 1, seed=k)),
    "limit of codegen": ("limit", lambda _, k: costate.codegen(pendulum(), "f", limit=k)),
    "threads": ("threads", lambda _, k: costate.Dynamics(pendulum(), threads=k)),
}


@pytest.mark.parametrize("name", CALLS)
def test_other_numbers_are_refused(motion, name):
    argument, call = CALLS[name]
    for wrong in (-1, -(2**70), 2**70, 0.5, True, [0]):
        with pytest.raises(costate.ArgumentError, match=rf"^{argument} is .*whole number") as raised:
            call(motion, wrong)
        assert raised.value.argument == argument


@pytest.mark.parametrize("name", ["set_via", "set_obstacle", "set_reference", "set_tool_cost"])
def test_places_are_counted_from_0_with_numbers_of_numpy_too(motion, name):
    argument, call = CALLS[name]
    for number in (0, np.int32(0), np.uint8(0)):
        call(motion, number)
    with pytest.raises(costate.ArgumentError, match="1"):
        call(motion, 1)
