"""Times of calls from Python: beside Rust, and beside pin, adam and MJX.

``python python/benches/calls.py [ROBOT.urdf] [--states 1000000] [--write]``, with a package that was built with the feature
``timing``; the least of many repetitions in one run, on one thread where nothing else is said. Rust is, for one state and for
several threads, the same function without objects of Python (``Dynamics._seconds``), and for batches on one thread
``costate::batch`` as a user of Rust calls it (``Dynamics._batch_seconds``), all in the same build with results in memory that
is there. ``--write`` puts the tables into docs/python_calls.md. Peers are compared where they are installed, and named where
they are not. Batches of peers: loops over states for pin, whose calls take one; ``jit`` for adam and MJX, whose derivatives
are checked against those of costate before they are timed (``differentiated``).
"""

import argparse
import itertools
import multiprocessing
import os
import platform
import queue
import time
import warnings
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import costate
import numpy as np

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "python_calls.md"
BATCH = 1024
# So many of these states at once go through a program of JAX; the fastest number is shown.
CHUNKS = (BATCH, 32)


def least(call, seconds: float = 0.4, at_most: float = 6.0) -> float:
    """The least time of a call (s) in rounds that last at least a millisecond."""
    call()
    start = time.perf_counter()
    call()
    one = max(time.perf_counter() - start, 1e-7)
    repeat = max(1, int(1e-3 / one))
    best, end = float("inf"), time.perf_counter() + min(at_most, max(seconds, 3 * one))
    while time.perf_counter() < end:
        start = time.perf_counter()
        for _ in range(repeat):
            call()
        best = min(best, (time.perf_counter() - start) / repeat)
    return best


def arguments(n: int, verb: str, states: tuple[int, ...]) -> list:
    q = np.full((*states, n), 0.3)
    return [q, q.copy(), q.copy()] + ([np.full((*states, 2 * n), 0.3)] if verb in ("contract", "adjoint", "hessian") else [])


def overhead(robot: costate.Robot) -> str:
    dynamics, rows = costate.Dynamics(robot), []
    for verb in ("f", "aba", "rnea", "linearise", "jacobian", "hessian", "contract", "adjoint"):
        given, method = arguments(robot.n, verb, ()), getattr(dynamics, verb)
        ours, rust = least(lambda: method(*given)), dynamics._seconds(verb, 1, 300, False)
        rows.append((ours - rust, f"| `{verb}` | {rust * 1e6:.2f} | {ours * 1e6:.2f} | {(ours - rust) * 1e6:.2f} |"))
    rows.sort(reverse=True)
    return "| one state | Rust (us) | Python (us) | overhead (us) |\n|---|--:|--:|--:|\n" + "\n".join(row for _, row in rows)


def memory(results) -> np.ndarray | tuple:
    """Arrays for results like these, whose pages are there."""
    arrays = tuple(np.zeros_like(array) for array in (results if isinstance(results, tuple) else (results,)))
    return arrays if isinstance(results, tuple) else arrays[0]


# Calls in one round, as many as `_seconds` and `_batch_seconds` make; and rounds of each side, by turns.
CALLS, ROUNDS = 20, 2


def least_of(call, count: int = CALLS) -> float:
    """The least time of so many calls (s)."""
    best = float("inf")
    for _ in range(count):
        start = time.perf_counter()
        call()
        best = min(best, time.perf_counter() - start)
    return best


def fits(method, given: list, states: int) -> int:
    """So many states, or a tenth where there is no memory for two results and what Rust allocates."""
    results = method(*(array[:1] for array in given))
    size = 8 * states * sum(array.size for array in (results if isinstance(results, tuple) else (results,)))
    free = os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    return states if 2.5 * size < free else states // 10


def batches(robot: costate.Robot, states: int) -> str:
    """Beside ``costate::batch`` of Rust, the faster of machine code and generic code over lanes, on one thread."""
    rows = []
    for threads in (1, len(os.sched_getaffinity(0))):
        dynamics = costate.Dynamics(robot, threads=threads)
        for verb in ("f", "linearise", "adjoint", "hessian", "contract"):
            given, method = arguments(robot.n, verb, (states,)), getattr(dynamics, verb)
            count = fits(method, given, states)
            given = [array[:count] for array in given]
            ours = new = rust = float("inf")
            for _ in range(ROUNDS):
                out = memory(method(*given))
                ours = min(ours, least_of(lambda: method(*given, out=out)))
                del out
                new = min(new, least_of(lambda: method(*given), 5))
                if threads == 1:
                    rust = min(rust, *(time for time in dynamics._batch_seconds(verb, count, 1) if time))
                else:
                    rust = min(rust, dynamics._seconds(verb, count, 1, False))
            times = " | ".join(f"{time / count * 1e9:.0f}" for time in (rust, ours, new))
            rows.append((ours / rust, f"| `{verb}` | {count:.0e} | {threads} | {times} | {ours / rust:.2f} |"))
            print(rows[-1][1], flush=True)
    rows.sort(reverse=True)
    head = "| batch | states | threads | Rust (ns a state) | Python with `out=` | Python, new arrays | Python with `out=` / Rust |\n"
    return head + "|---|--:|--:|--:|--:|--:|--:|\n" + "\n".join(row for _, row in rows)


def with_costate(robot: costate.Robot) -> dict[str, float]:
    dynamics = costate.Dynamics(robot, threads=1)
    q, v, tau, y = arguments(robot.n, "contract", (BATCH,))
    calls = {"a": lambda: dynamics.aba(q, v, tau), "a, a_z": lambda: dynamics.linearise(q, v, tau),
             "a, a_z, y'a_zz": lambda: dynamics.contract(q, v, tau, y)}  # fmt: skip
    return {name: least(call) / BATCH for name, call in calls.items()}


def with_pin(file: Path):
    import pinocchio

    model = pinocchio.buildModelFromUrdf(str(file))
    data, q = model.createData(), np.full(model.nv, 0.3)
    yield "a", least(lambda: pinocchio.aba(model, data, q, q, q)), "-"
    yield "a, a_z", least(lambda: pinocchio.computeABADerivatives(model, data, q, q, q)), "-"


def differentiated(a, file: Path):
    """Batches of a function (q, v, tau) -> a of JAX, checked against `Dynamics.contract`; all states at once, and fewer.

    Forward over reverse: one program pushes 3n tangents through a and through the gradient of y'a, and gives a, a_z and y'a_zz.
    """
    import jax
    import jax.numpy as jnp

    dynamics = costate.Dynamics(costate.Robot.from_file(file), threads=1)
    n, random = dynamics.n, np.random.default_rng(0)
    z, y = random.uniform(-1.0, 1.0, (BATCH, 3 * n)), random.uniform(-1.0, 1.0, (BATCH, n))
    q, v, tau = (np.ascontiguousarray(part) for part in np.split(z, 3, axis=1))
    f, jacobian, hessian = dynamics.contract(q, v, tau, np.hstack([np.zeros_like(y), y]))
    z, y = jnp.asarray(z), jnp.asarray(y)
    of = lambda z: a(*jnp.split(z, 3))  # noqa: E731

    def second(z, y):
        def gradient(z):
            value, back = jax.vjp(of, z)
            return (value, back(y)[0]), value

        (a_z, ya_zz), value = jax.jacfwd(gradient, has_aux=True)(z)
        return value, a_z, ya_zz

    calls = {"a": lambda z, y: (of(z),), "a, a_z": lambda z, y: (of(z), jax.jacfwd(of)(z)), "a, a_z, y'a_zz": second}
    for (name, function), chunk in itertools.product(calls.items(), CHUNKS):
        in_chunks = lambda *z_y, run=function, chunk=chunk: jax.lax.map(lambda one: run(*one), z_y, batch_size=chunk)  # noqa: E731
        start = time.perf_counter()
        batch = jax.jit(in_chunks).lower(z, y).compile()
        compiling = time.perf_counter() - start
        for exact, theirs in zip((f[:, n:], jacobian[:, n:], hessian), batch(z, y)):
            np.testing.assert_allclose(theirs, exact, rtol=1e-6, atol=1e-10 * np.abs(exact).max())
        yield name, least(lambda batch=batch: jax.block_until_ready(batch(z, y))) / BATCH, f"{compiling:.0f} s, {chunk} at once"


def with_adam(file: Path):
    import jax.numpy as jnp
    from adam.jax import KinDynComputations

    robot = costate.Robot.from_file(file)
    model = KinDynComputations(str(file), robot.joint_names, gravity=jnp.array([*robot.gravity, 0.0, 0.0, 0.0]))
    # Its arrays name their device, which vmap refuses from JAX 0.10 on.
    model.rbdalgos.math.factory._device = None
    n, base = robot.n, jnp.eye(4)

    def a(q, v, tau):
        mass = model.mass_matrix(base, q)[6:, 6:]
        return jnp.linalg.solve(mass, tau - model.bias_force(base, q, jnp.zeros(6), v)[6:])

    return differentiated(a, file)


def with_mjx(file: Path):
    import mujoco
    from mujoco import mjx

    model = mujoco.MjModel.from_xml_path(str(file))
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    there = mjx.put_model(model)
    data = mjx.make_data(there)

    def a(q, v, tau):
        return mjx.forward(there, data.replace(qpos=q, qvel=v, qfrc_applied=tau)).qacc

    return differentiated(a, file)


def times_of(run, file: Path, results) -> None:
    """Runs in a process of its own."""
    warnings.simplefilter("ignore")
    try:
        if run is not with_pin:
            import jax

            jax.config.update("jax_platforms", "cpu")
            jax.config.update("jax_enable_x64", True)
        for times in run(file):
            results.put(times)
    except Exception as error:
        results.put((None, f"{type(error).__name__}: {(str(error).splitlines() or [''])[0][:90]}", None))
    else:
        results.put((None, None, None))


PEERS = (("pin", with_pin), ("adam", with_adam), ("MJX", with_mjx))


def peers(robot: costate.Robot, file: Path, limit: float) -> str:
    """Packages whose derivatives take longer to compile and run than the limit (s) are named."""
    context = multiprocessing.get_context("spawn")
    ours, found, absent = with_costate(robot), {}, []
    for name, run in PEERS:
        results = context.Queue()
        process = context.Process(target=times_of, args=(run, file, results))
        process.start()
        end = time.monotonic() + limit
        while True:
            try:
                what, seconds, compiling = results.get(timeout=max(0.0, end - time.monotonic()))
            except queue.Empty:
                absent.append(f"{name}: the rest of its programs took longer than {limit:.0f} s, most of it compiling")
                break
            if what is None:
                absent.extend([f"{name}: {seconds}"] if seconds else [])
                break
            times = f"{seconds * 1e9:.0f} | {ours[what] * 1e9:.0f} | {seconds / ours[what]:.1f} | {compiling}"
            row = seconds / ours[what], f"| {what} | {name} | {times} |"
            found[what, name] = min(row, found.get((what, name), row))
            print(row[1], flush=True)
        process.kill()
        process.join()
    text = f"| {BATCH} states | package | its time (ns a state) | costate (ns a state) | ratio | its compiling |\n"
    text += "|---|---|--:|--:|--:|---|\n" + "\n".join(row for _, row in sorted(found.values())) + "\n"
    return text + "".join(f"\nNot compared: {line}." for line in absent)


def machine() -> str:
    """The processor, and the versions of the packages that are compared."""
    file = Path("/proc/cpuinfo")
    info = file.read_text() if file.exists() else ""
    names = [line.partition(":")[2].strip() for line in info.splitlines() if line.startswith("model name")]
    vectors = "with AVX-512" if "avx512f" in info else "without AVX-512"
    found = [f"{(names or [platform.processor()])[0]}, {len(os.sched_getaffinity(0))} cores, {vectors}",
             f"Python {platform.python_version()}"]  # fmt: skip
    for name in ("numpy", "pin", "adam-robotics", "mujoco-mjx", "jax"):
        try:
            found.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            continue
    return "; ".join(found)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("robot", nargs="?", type=Path, default=ROOT / "robots" / "ur5.urdf")
    parser.add_argument("--states", type=int, default=1_000_000)
    parser.add_argument("--limit", type=float, default=1800, help="seconds for each other package")
    parser.add_argument("--write", action="store_true", help=f"write the tables into {PAGE.name}")
    given = parser.parse_args()
    if not hasattr(costate.Dynamics, "_seconds"):
        raise SystemExit('build it first by: pip install ./python --config-settings=build-args="--features timing"')
    warnings.simplefilter("ignore", costate.RobotWarning)
    robot = costate.Robot.from_file(given.robot)
    parts = [f"{robot.name}, n = {robot.n}; {machine()}"]
    for part in (lambda: overhead(robot), lambda: batches(robot, given.states), lambda: peers(robot, given.robot, given.limit)):
        parts.append(part())
        print(parts[-1], flush=True)
    text = "\n\n".join(parts) + "\n"
    if given.write:
        page = PAGE.read_text()
        before, rest = page.split("<!-- times: begin -->\n")
        PAGE.write_text(f"{before}<!-- times: begin -->\n{text}<!-- times: end -->{rest.split('<!-- times: end -->')[1]}")


if __name__ == "__main__":
    main()
