"""Times of calls from Python, beside Pinocchio's where ``pin`` is installed.

``python python/benches/calls.py [ROBOT.urdf]``; the least of many repetitions. The overhead of a call is that of a
pendulum, whose own work takes some tens of nanoseconds.
"""

import sys
import time
import warnings
from pathlib import Path

import costate
import numpy as np

BATCH = 20_000


def least(call, repeat: int = 300, seconds: float = 0.5) -> float:
    """The least time of a call in ns."""
    best, end = float("inf"), time.perf_counter() + seconds
    while time.perf_counter() < end:
        start = time.perf_counter()
        for _ in range(repeat):
            call()
        best = min(best, (time.perf_counter() - start) / repeat)
    return best * 1e9


def calls(dynamics: costate.Dynamics, states: tuple[int, ...] = ()):
    """Name and call of each method, at so many states."""
    n, random = dynamics.n, np.random.default_rng(0)
    q, v, tau = random.normal(size=(3, *states, n))
    y, d = random.normal(size=(*states, 2 * n)), random.normal(size=(*states, 3 * n))
    return {
        "f": lambda: dynamics.f(q, v, tau),
        "jacobian": lambda: dynamics.jacobian(q, v, tau),
        "contract": lambda: dynamics.contract(q, v, tau, y),
        "adjoint": lambda: dynamics.adjoint(q, v, tau, y),
        "hvp": lambda: dynamics.hvp(q, v, tau, y, d),
        "rnea": lambda: dynamics.rnea(q, v, tau),
        "crba": lambda: dynamics.crba(q),
    }


def main() -> None:
    file = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[2] / "robots" / "ur5.urdf"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        robot = costate.Robot.from_file(file)
    pendulum = costate.Robot.builder("pendulum").revolute("hinge", axis=[0, 1, 0], mass=1, com=[0, 0, -1]).build()
    print(f"{robot.name}, n = {robot.n}; ns a state")
    print(f"{'':12}{'overhead':>10}{'one state':>12}{'batch, 1 thread':>18}{'batch, threads':>18}")
    columns = [
        calls(costate.Dynamics(pendulum)),
        calls(costate.Dynamics(robot)),
        calls(costate.Dynamics(robot, threads=1), (BATCH,)),
        calls(costate.Dynamics(robot), (BATCH,)),
    ]
    for name in columns[0]:
        one = [least(of[name]) for of in columns[:2]]
        many = [least(of[name], 1) / BATCH for of in columns[2:]]
        print(f"{name:12}{one[0]:10.0f}{one[1]:12.0f}{many[0]:18.1f}{many[1]:18.1f}")
    try:
        import pinocchio
    except ImportError:
        return
    model = pinocchio.buildModelFromUrdf(str(file))
    data, (q, v, tau) = model.createData(), np.random.default_rng(0).normal(size=(3, model.nv))
    if model.nq == model.nv:
        print(f"pin {pinocchio.__version__}: aba {least(lambda: pinocchio.aba(model, data, q, v, tau)):.0f}, ", end="")
        print(f"its derivatives {least(lambda: pinocchio.computeABADerivatives(model, data, q, v, tau)):.0f}")


if __name__ == "__main__":
    main()
