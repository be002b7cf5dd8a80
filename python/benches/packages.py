"""Times of other packages: pin, adam and MJX, for `calls.py`."""

import multiprocessing
import queue
import time
import warnings
from pathlib import Path

import costate
import numpy as np

BATCH = 1024
# So many of these states at once go through a program of JAX.
CHUNK = 32


def least(call, seconds: float = 0.4, at_most: float = 6.0) -> float:
    """The least time of a call (s) in rounds that last at least a millisecond; of a long call, its second one."""
    call()
    start = time.perf_counter()
    call()
    one = max(time.perf_counter() - start, 1e-7)
    if one > at_most:
        return one
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


# What is computed of each state.
PROGRAMS = ("a", "a, a_z", "a, a_z, y'a_zz")


def with_costate(robot: costate.Robot) -> dict[str, float]:
    dynamics = costate.Dynamics(robot, threads=1)
    q, v, tau, y = arguments(robot.n, "contract", (BATCH,))
    calls = (lambda: dynamics.aba(q, v, tau), lambda: dynamics.linearise(q, v, tau), lambda: dynamics.contract(q, v, tau, y))
    return {name: least(call) / BATCH for name, call in zip(PROGRAMS, calls)}


def with_pin(file: Path):
    import pinocchio

    model = pinocchio.buildModelFromUrdf(str(file))
    data, q = model.createData(), np.full(model.nv, 0.3)
    yield PROGRAMS[0], least(lambda: pinocchio.aba(model, data, q, q, q)), "-"
    yield PROGRAMS[1], least(lambda: pinocchio.computeABADerivatives(model, data, q, q, q)), "-"


def differentiated(a, file: Path):
    """Batches of a function (q, v, tau) -> a of JAX, checked against `Dynamics.contract`.

    Forward over reverse: one program pushes 3n tangents through a and through the gradient of y'a, and gives a, a_z and y'a_zz.
    """
    import jax
    import jax.numpy as jnp

    dynamics = costate.Dynamics(costate.Robot.from_file(file), threads=1)
    n, random = dynamics.n, np.random.default_rng(0)
    of = lambda z: a(*jnp.split(z, 3))  # noqa: E731

    def second(z, y):
        def gradient(z):
            value, back = jax.vjp(of, z)
            return (value, back(y)[0]), value

        (a_z, ya_zz), value = jax.jacfwd(gradient, has_aux=True)(z)
        return value, a_z, ya_zz

    calls = dict(zip(PROGRAMS, (lambda z, y: (of(z),), lambda z, y: (of(z), jax.jacfwd(of)(z)), second)))
    z, y = random.uniform(-1.0, 1.0, (BATCH, 3 * n)), random.uniform(-1.0, 1.0, (BATCH, n))
    q, v, tau = (np.ascontiguousarray(part) for part in np.split(z, 3, axis=1))
    f, jacobian, hessian = dynamics.contract(q, v, tau, np.hstack([np.zeros_like(y), y]))
    z, y = jnp.asarray(z), jnp.asarray(y)
    for name, function in calls.items():
        in_chunks = lambda *z_y, run=function: jax.lax.map(lambda one: run(*one), z_y, batch_size=CHUNK)  # noqa: E731
        start = time.perf_counter()
        batch = jax.jit(in_chunks).lower(z, y).compile()
        compiling = f"{time.perf_counter() - start:.0f} s"
        yield name, None, compiling
        for exact, theirs in zip((f[:, n:], jacobian[:, n:], hessian), batch(z, y)):
            np.testing.assert_allclose(theirs, exact, rtol=1e-6, atol=1e-10 * np.abs(exact).max())
        yield name, least(lambda batch=batch: jax.block_until_ready(batch(z, y))) / BATCH, compiling


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


# Packages, and how many of the programs they have.
PEERS = (("pin", with_pin, 2), ("adam", with_adam, 3), ("MJX", with_mjx, 3))


def peer(run, file: Path, limit: float):
    """Times of the programs of a package (s) and words about compiling them; what was compiled; how it ended too early."""
    context = multiprocessing.get_context("spawn")
    results, found, compiled = context.Queue(), {}, {}
    process = context.Process(target=times_of, args=(run, file, results))
    process.start()
    end = time.monotonic() + limit
    try:
        while True:
            what, seconds, compiling = results.get(timeout=max(0.0, end - time.monotonic()))
            if what is None:
                return found, compiled, seconds
            if seconds is None:
                compiled[what] = compiling
            else:
                found[what] = seconds, compiling
            print(what, seconds, compiling, flush=True)
    except queue.Empty:
        return found, compiled, None
    finally:
        process.kill()
        process.join()


def peers(robot: costate.Robot, file: Path, end: float) -> str:
    """Packages share the time until the end; programs that need more are named."""
    ours, rows, absent = with_costate(robot), [], []
    for k, (name, run, programs) in enumerate(PEERS):
        limit = (end - time.monotonic()) / (len(PEERS) - k)
        found, compiled, error = peer(run, file, limit)
        if error:
            absent.append(f"{name}: {error}")
        for what in PROGRAMS[:programs]:
            if what in found:
                theirs, compiling = found[what]
                ratio = theirs / ours[what]
                row = f"{theirs * 1e9:.0f} | {ours[what] * 1e9:.0f} | {ratio:.1f} | {compiling}"
            elif error:
                continue
            else:
                ratio = float("inf")
                row = f"did not end: {limit:.0f} s for {name} | {ours[what] * 1e9:.0f} | - | {compiled.get(what, 'did not end')}"
            rows.append((PROGRAMS.index(what), ratio, f"| {what} | {name} | {row} |"))
    rows.sort()
    text = "| computed | package | its time (ns a state) | costate (ns a state) | ratio | its compiling |\n"
    text += "|---|---|--:|--:|--:|---|\n" + "\n".join(row[-1] for row in rows) + "\n"
    return text + "".join(f"\nNot compared: {line}." for line in absent)
