"""Times of ``costate.casadi`` against the same dynamics expanded in CasADi's ``SX``.

``python python/benches/casadi_times.py [ROBOT.urdf ...] [--write]``; needs CasADi and ``pin``, which reads the URDF for
the expansion. All are functions of CasADi and are called in the same way; the least of many repetitions. The expansion
is `user_lagrangian` of benches/peers: M and the bias by the recursive Newton-Euler algorithm, a linear solution, and
CasADi's derivatives of that. The expert's is `expert_lagrangian`: derivatives by the implicit function theorem, written
by hand, which CasADi's solvers do not find by themselves. Motions are those of `tests/test_casadi.py`: RK4, 30 intervals, IPOPT with the exact
Hessian. ``--write`` puts the tables into docs/casadi.md.
"""

import argparse
import sys
import time
import warnings
from pathlib import Path

import casadi as ca
import costate
import costate.casadi
import numpy as np

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "casadi.md"
sys.path.insert(0, str(ROOT / "benches" / "peers" / "harness"))

import describe  # noqa: E402
import energy  # noqa: E402
import symbolic  # noqa: E402

NODES = 20


def expanded(file: Path):
    """(q, v, tau) -> a, as a user writes it."""
    (q, v, u, _), a, *_ = symbolic.user_lagrangian(energy.Links(describe.Robot(file)))
    return ca.Function("a", [q, v, u], [ca.densify(a)], {"cse": True})


def expert(file: Path):
    """a, a_z and y'a_zz written by hand, for one order after the other."""
    (q, v, u, y), *results = symbolic.expert_lagrangian(energy.Links(describe.Robot(file)))
    weights = y[v.numel() :]
    results = [ca.densify(result) for result in results]
    return [ca.Function(f"expert_{k}", [q, v, u, weights], results[: k + 1], {"cse": True}) for k in range(3)]


def read(file: Path) -> costate.Robot:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return costate.Robot.from_file(file)


def derivatives(f):
    """f, its Jacobian, and that with the Hessian of y'f, each a function of q, v, tau, y."""
    n = f.size1_in(0)
    q, v, u, y = arguments = [ca.MX.sym(name, n) for name in ("q", "v", "u", "y")]
    z, zero = ca.vertcat(q, v, u), ca.DM(n, 1)
    a, blocks = f(q, v, u), f.jacobian()(q, v, u, zero)
    jacobian = ca.horzcat(*blocks)
    hessian = ca.hessian(ca.dot(y, a), z)[0]
    return [ca.Function(f"order_{k}", arguments, of) for k, of in enumerate(([a], [a, jacobian], [a, jacobian, hessian]))]


def least(function, states) -> float:
    """The least time (us) of a node in a map over many states, without conversions from Python."""
    mapped = function.map(NODES)
    buffer, call = mapped.buffer()
    kept = []
    for k in range(mapped.n_in()):
        values = np.asfortranarray(states[k])
        kept.append(values)
        buffer.set_arg(k, memoryview(values.reshape(-1, order="F")))
    for k in range(mapped.n_out()):
        values = np.zeros(max(1, mapped.nnz_out(k)))
        kept.append(values)
        buffer.set_res(k, memoryview(values))
    best, end = float("inf"), time.perf_counter() + 1.0
    while time.perf_counter() < end:
        start = time.perf_counter()
        call()
        best = min(best, time.perf_counter() - start)
    return best / NODES * 1e6


def rk4(f, n: int, h: float):
    """A step of the classical Runge-Kutta scheme, written in CasADi."""
    x, u = ca.MX.sym("x", 2 * n), ca.MX.sym("u", n)
    rate = lambda x: ca.vertcat(x[n:], f(x[:n], x[n:], u))
    k1 = rate(x)
    k2 = rate(x + h / 2 * k1)
    k3 = rate(x + h / 2 * k2)
    k4 = rate(x + h * k3)
    return ca.Function("step", [x, u], [x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)])


def motion(step, robot: costate.Robot, intervals: int = 30):
    """Iterations, building and solving (s), functions and their derivatives in one iteration (ms)."""
    n = robot.n
    lower, upper = np.where(np.isfinite(robot.position_limits), robot.position_limits, np.array([[-1.0], [1.0]]))
    start = lower + 0.4 * (upper - lower)
    end = start + 0.15 * np.minimum(upper - lower, 2.0)
    x, tau = ca.MX.sym("x", 2 * n, intervals + 1), ca.MX.sym("tau", n, intervals)
    rest = np.zeros(n)
    defects = [x[:, k + 1] - step(x[:, k], tau[:, k]) for k in range(intervals)]
    ends = [x[:, 0] - np.concatenate([start, rest]), x[:, intervals] - np.concatenate([end, rest])]
    t, way = np.linspace(0, 1, intervals + 1)[:, None], end - start
    q, v, a = start + (3 - 2 * t) * t**2 * way, 6 * t * (1 - t) * way, (6 - 12 * t) * way
    guess = np.concatenate([np.hstack([q, v]).ravel(), costate.Dynamics(robot).rnea(q, v, a)[:-1].ravel()])
    problem = {"x": ca.veccat(x, tau), "f": ca.sumsqr(tau) / intervals, "g": ca.veccat(*ends, *defects)}
    options = {"ipopt.print_level": 0, "print_time": 0, "ipopt.sb": "yes", "ipopt.max_iter": 300, "show_eval_warnings": False}
    started = time.perf_counter()
    solver = ca.nlpsol("solver", "ipopt", problem, options)
    built = time.perf_counter()
    solution = solver(x0=guess, lbg=0, ubg=0)
    solved = time.perf_counter()
    stats = solver.stats()
    name = {"nlp_g": "values", "nlp_jac_g": "Jacobian", "nlp_hess_l": "Hessian"}
    times = {name[of]: 1e3 * stats[f"t_wall_{of}"] / max(1, stats[f"n_call_{of}"]) for of in name}
    return stats, float(solution["f"]), built - started, solved - built, times


def tables(files: list[Path]) -> str:
    rows = []
    for file in files:
        robot, random = read(file), np.random.default_rng(0)
        states = [random.normal(size=(robot.n, NODES)) for _ in range(4)]
        ours, theirs = derivatives(costate.casadi.dynamics(robot)), derivatives(expanded(file))
        by_hand = expert(file)
        found = [np.array(of[2](*(state[:, 0] for state in states))[2]) for of in (ours, theirs, by_hand)]
        for other in found[1:]:
            assert np.allclose(found[0], other, rtol=1e-6, atol=1e-6 * np.abs(other).max())
        for what, *functions in zip(("a", "a, a_z", "a, a_z, y'a_zz"), ours, theirs, by_hand):
            mine, other, best = (least(function, states) for function in functions)
            times = f"{mine:.2f} | {other:.1f} ({other / mine:.0f}) | {best:.1f} ({best / mine:.0f})"
            rows.append(f"| {robot.name} | {robot.n} | {what} | {times} |")
    text = "| robot | n | function | `costate.casadi` (us) | expanded (us, ratio) | expert's (us, ratio) |\n"
    text += "|---|---|---|---|---|---|\n"
    text += "\n".join(rows) + "\n\n"
    text += "| robot | step | built (s) | iterations | solved (s) | values (ms) | Jacobian (ms) | Hessian (ms) |\n"
    text += "|---|---|---|---|---|---|---|---|\n"
    for file in files:
        robot = read(file)
        steps = {
            "`costate.casadi.step`": costate.casadi.step(robot, "rk4", 1 / 30),
            "stages of `costate.casadi.dynamics`": rk4(costate.casadi.dynamics(robot), robot.n, 1 / 30),
            "stages of the expansion": rk4(expanded(file), robot.n, 1 / 30),
        }
        for name, step in steps.items():
            stats, _, built, solved, times = motion(step, robot)
            done = stats["iter_count"] if stats["success"] else f"{stats['iter_count']}, {stats['return_status']}"
            values = " | ".join(f"{value:.2f}" for value in times.values())
            text += f"| {robot.name} | {name} | {built:.2f} | {done} | {solved:.2f} | {values} |\n"
    return text


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("robots", nargs="*", type=Path, default=[ROOT / "robots" / "ur5.urdf", ROOT / "robots" / "panda.urdf"])
    parser.add_argument("--write", action="store_true", help=f"write the tables into {PAGE.name}")
    arguments = parser.parse_args()
    text = tables(arguments.robots)
    print(text)
    if arguments.write:
        page = PAGE.read_text()
        before, rest = page.split("<!-- times: begin -->\n")
        after = rest.split("<!-- times: end -->")[1]
        PAGE.write_text(f"{before}<!-- times: begin -->\n{text}<!-- times: end -->{after}")


if __name__ == "__main__":
    main()
