"""Floating and spherical joints: numbers of Pinocchio, laws of motion, configurations, batches, what is refused."""

import copy
import json
import pickle
from pathlib import Path

import costate
import numpy as np
import pytest
from conftest import ROBOTS, assert_close

# Bases without mass, which move.
pytestmark = pytest.mark.filterwarnings("ignore::costate.RobotWarning")
EPS = float(np.finfo(float).eps)
FIXTURES = ROBOTS.parent / "tests" / "fixtures"
PAYLOAD = {"mass": 5.0, "com": [0.1, -0.05, 0.2], "inertia": [0.3, 0.4, 0.35, 0, 0, 0]}
CASES = [json.loads(line) for line in (FIXTURES / "free_joints_pinocchio.jsonl").read_text().splitlines()]


def free(name: str) -> costate.Robot:
    """A robot of the fixtures: a URDF floats and carries a payload."""
    path = ROBOTS.parent / name
    if path.suffix == ".toml":
        return costate.Robot.from_file(path)
    return costate.Robot.from_file(path, floating_base=True).with_payload("root_joint", **PAYLOAD)


def places(robot: costate.Robot, names: list[str]) -> tuple[list[int], list[int]]:
    """For each entry of q and of v the entry of Pinocchio, whose joints have these names."""
    sizes = {name: (7, 6) if kind == "floating" else (4, 3) for name, kind, *_ in robot.free_joints}
    starts, at = {}, (0, 0)
    for name in names:
        starts[name] = at
        nq, nv = sizes.get(name, (1, 1))
        at = at[0] + nq, at[1] + nv
    parts = {f"{name}_{part}" for name in sizes for part in ("x", "y", "z", "rx", "ry")}
    to_q, to_v = [], []
    for name in (name for name in robot.joint_names if name not in parts):
        (from_q, from_v), (nq, nv) = starts[name], sizes.get(name, (1, 1))
        to_q += range(from_q, from_q + nq)
        to_v += range(from_v, from_v + nv)
    return to_q, to_v


@pytest.fixture(scope="module")
def tree() -> costate.Robot:
    """Five joints, three of them free."""
    return free("tests/fixtures/free_tree.toml")


@pytest.fixture(scope="module")
def drone() -> costate.Robot:
    body = {"mass": 2.0, "com": [0.1, -0.2, 0.3], "inertia": [0.2, 0.3, 0.25, 0.01, -0.02, 0.03]}
    return costate.Robot.builder("drone").floating("body", **body).build()


@pytest.fixture
def state(tree, random):
    """q, v, tau, y (2n) and d (3n)."""
    n = tree.n
    q = tree.integrate(tree.neutral(), random.normal(size=n))
    return q, *(random.normal(size=k * n) for k in (1, 1, 2, 3))


def slope(function, h: float, noise: float):
    """The derivative at 0 by differences of order four, and a bound of its error.

    ``noise`` is the error of one value; the weights of the four add up to 1.5 / h. The error of truncation is
    proportional to h^4: a fifteenth of what twice the step changes, of which the bound takes a seventh.
    """

    def by(h):
        return (8 * (function(h) - function(-h)) - (function(2 * h) - function(-2 * h))) / (12 * h)

    found = by(h)
    return found, 1.5 * noise / h + np.abs(by(2 * h) - found).max() / 7


def curvature(function, h: float, noise: float):
    """The same of the second derivative; the weights add up to 64 / (12 h^2)."""

    def by(h):
        near, far = function(h) + function(-h), function(2 * h) + function(-2 * h)
        return (16 * near - far - 30 * function(0.0)) / (12 * h * h)

    found = by(h)
    return found, 64 / 12 * noise / h**2 + np.abs(by(2 * h) - found).max() / 7


def assert_within(found, expected, bound: float) -> None:
    assert np.abs(np.asarray(found) - expected).max() <= bound


def solving(dynamics, q) -> float:
    """The relative error of solutions of equations with the mass matrix M at q: n times its condition in units of rounding.

    Scales of the coordinates change nothing in the factorisation L'DL: the condition is that of M scaled to a unit
    diagonal.
    """
    mass = dynamics.crba(q)
    scale = np.sqrt(np.diag(mass))
    return float(len(mass) * EPS * np.linalg.cond(mass / np.outer(scale, scale)))


def rotation(quaternion) -> np.ndarray:
    """The matrix of a unit quaternion (x, y, z, w)."""
    (x, y, z), w = quaternion[:3], quaternion[3]
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * cross + 2 * cross @ cross


@pytest.mark.parametrize("case", CASES, ids=[Path(case["robot"]).stem for case in CASES])
def test_dynamics_and_their_jacobian_are_those_of_pinocchio(case):
    robot = free(case["robot"])
    to_q, to_v = places(robot, case["names"])
    n = robot.nv
    assert (robot.nq, n) == (len(case["q"]), len(case["v"])) == (len(to_q), len(to_v))
    q = np.array(case["q"])[to_q]
    v, tau, a = (np.array(case[key])[to_v] for key in ("v", "tau", "a"))
    mass, a_q, a_v, a_tau = (np.array(case[key])[np.ix_(to_v, to_v)] for key in ("M", "a_q", "a_v", "a_tau"))
    dynamics = costate.Dynamics(robot)
    solved = solving(dynamics, q)
    assert_close(dynamics.crba(q), mass, 1e-12)
    assert_close(dynamics.aba(q, v, tau), a, 1e-10)
    assert_close(dynamics.f(q, v, tau), np.concatenate([v, a]), 1e-10)
    # M a, which may be much larger than tau, has 1e-10 of the largest entry too.
    assert_within(dynamics.rnea(q, v, a), tau, 1e-10 * np.abs(mass).max() * np.abs(a).max())
    jacobian = dynamics.jacobian(q, v, tau)
    for k, expected in enumerate((a_q, a_v, a_tau)):
        assert_close(jacobian[n:, k * n : (k + 1) * n], expected, max(1e-10, solved))
    assert_close(jacobian[:n], np.eye(n, 3 * n, n), 0)
    kinetic, _ = dynamics.energy(q, v)
    assert kinetic == pytest.approx(v @ mass @ v / 2, rel=1e-12)
    assert_close(dynamics.momentum(q, v), mass @ v, 1e-12)
    assert_close(dynamics.velocity(q, mass @ v), v, solved)
    # tau_z of inverse dynamics is -M a_z, and M by a.
    torques = dynamics.rnea_jacobian(q, v, a)
    for k, by in enumerate((-a_q, -a_v, np.eye(n))):
        size = np.abs(mass).max() * np.abs(by).max()
        assert_within(torques[:, k * n : (k + 1) * n], mass @ by, 1e-10 * size)


def test_the_momenta_of_a_motion_are_those_of_its_velocities(tree, state):
    """In (q, p): v = M^-1 p, and dp/dt is the rate of M v along the motion of Newton's equations, by differences."""
    q, v, tau, *_ = state
    n, velocities, momenta = tree.n, costate.Dynamics(tree), costate.Dynamics(tree, "qp")
    p, a = velocities.momentum(q, v), velocities.aba(q, v, tau)
    f, solved = momenta.f(q, p, tau), solving(velocities, q)
    assert_close(f[:n], v, solved)

    def momentum(s):
        return velocities.momentum(tree.integrate(q, s * v), v + s * a)

    rate, bound = slope(momentum, 1e-4, n * EPS * np.abs(p).max())
    # M a is as far from exact as the solution a.
    force = np.abs(velocities.crba(q) @ a).max()
    assert bound < 1e-7 * force
    assert_within(f[n:], rate, bound + solved * force)
    kinetic, potential = momenta.energy(q, v)
    assert kinetic == pytest.approx(v @ p / 2, rel=1e-12) and potential == velocities.energy(q, v)[1]


@pytest.mark.parametrize("coordinates", ["qv", "qp"])
def test_derivatives_are_those_along_q_plus_d(tree, state, coordinates):
    """A check by finite differences; the library compares with hyper-dual numbers."""
    q, v, tau, y, d = state
    n, dynamics = tree.n, costate.Dynamics(tree, coordinates)
    f, jacobian, hessian = dynamics.contract(q, v, tau, y)
    assert_close(dynamics.f(q, v, tau), f, 1e-12)
    assert_close(dynamics.jacobian(q, v, tau), jacobian, 1e-12)
    assert_close(dynamics.hessian(q, v, tau, y), hessian, 1e-12)
    assert_close(dynamics.linearise(q, v, tau)[1], jacobian, 1e-12)
    assert_close(dynamics.adjoint(q, v, tau, y), y @ jacobian, 1e-11)
    assert_close(dynamics.hvp(q, v, tau, y, d), hessian @ d, 1e-11)
    assert_close(hessian, hessian.T, 1e-13)

    # Along a direction of length 1.
    d = d / np.linalg.norm(d)

    def along(s):
        return dynamics.f(tree.integrate(q, s * d[:n]), v + s * d[n : 2 * n], tau + s * d[2 * n :])

    noise = solving(dynamics, q) * np.abs(f).max()
    first, bound = slope(along, 1e-3, noise)
    assert bound < 1e-6 * np.abs(jacobian).max()
    assert_within(jacobian @ d, first, bound)
    second, bound = curvature(lambda s: y @ along(s), 2e-2, noise * np.abs(y).sum())
    assert bound < 1e-5 * np.abs(hessian).max()
    assert_within(d @ hessian @ d, second, bound)


def test_second_derivatives_of_inverse_dynamics(tree, state):
    """M a_zz + tau_zz(.., a_z, a_z) = 0, contracted: by the Hessian of forward dynamics at w = M^-1 y."""
    q, v, tau, y, d = state
    n, dynamics = tree.n, costate.Dynamics(tree)
    w = y[:n]
    mass = dynamics.crba(q)
    f, jacobian, hessian = dynamics.contract(q, v, tau, np.concatenate([np.zeros(n), mass @ w]))
    to_z = np.vstack([np.eye(2 * n, 3 * n), jacobian[n:]])
    pulled = to_z.T @ dynamics.rnea_hessian(q, v, f[n:], w) @ to_z
    assert_close(pulled, -hessian, 1e-9)


def test_a_free_robot_keeps_its_angular_momentum_and_falls(tree, random):
    """dh/dt = (0, m g) of all links, whatever the joints do, along the motion by differences."""
    n, dynamics = tree.n, costate.Dynamics(tree)
    q, v = tree.integrate(tree.neutral(), random.normal(size=n)), random.normal(size=n)
    tau = np.concatenate([np.zeros(6), random.normal(size=n - 6)])
    a = dynamics.aba(q, v, tau)
    total, matrix = dynamics.centroidal_momentum(q, v)

    def momentum(s):
        return dynamics.centroidal_momentum(tree.integrate(q, s * v), v + s * a)[0]

    rate, bound = slope(momentum, 1e-4, n * EPS * np.abs(matrix).max() * np.abs(v).max())
    expected = np.concatenate([np.zeros(3), tree.mass * tree.gravity])
    force = np.abs(matrix @ a).max()
    assert bound < 1e-7 * force
    assert_within(rate, expected, bound + solving(dynamics, q) * force)
    assert_close(matrix @ v, total, 1e-12)


def test_frames_of_a_body(drone, random):
    """A point and the axes of one body, in closed form."""
    robot = drone.add_frame("tip", "body", [0.5, 0.2, -0.1])
    dynamics = costate.Dynamics(robot)
    q = robot.integrate(robot.neutral(), random.normal(size=6))
    v, a, arm = random.normal(size=6), random.normal(size=6), np.array([0.5, 0.2, -0.1])
    turn, (linear, angular) = rotation(q[3:]), v.reshape(2, 3)
    tip = dynamics.frame("tip")
    orientation, position = tip.pose(q)
    assert_close(orientation, turn, 1e-14)
    assert_close(position, q[:3] + turn @ arm, 1e-14)
    velocity = turn @ (linear + np.cross(angular, arm))
    assert_close(tip.twist(q, v), np.concatenate([turn @ angular, velocity]), 1e-14)
    assert_close(tip.jacobian(q) @ v, tip.twist(q, v), 1e-14)
    assert_close(dynamics.frame("tip", "local").twist(q, v)[:3], angular, 1e-14)
    # x = r + R s: x'' = R (v' + w x v + w' x s + w x (w x s)).
    (rise, spin), carried = a.reshape(2, 3), np.cross(angular, arm)
    acceleration = turn @ (rise + np.cross(angular, linear) + np.cross(spin, arm) + np.cross(angular, carried))
    assert_close(tip.acceleration(q, v, a)[3:], acceleration, 1e-13)
    assert_close(tip.jacobian(q) @ a + tip.jacobian_rate(q, v) @ v, tip.acceleration(q, v, a), 1e-13)
    assert_close(dynamics.centre_of_mass(q), q[:3] + turn @ [0.1, -0.2, 0.3], 1e-14)
    # w.x at q (+) d is w.(R (d_l + d_w x s + (d_w x d_l + d_w x (d_w x s)) / 2)) to second order.
    d, w = random.normal(size=6), random.normal(size=3)
    (along, about) = d.reshape(2, 3)
    bend = turn @ (np.cross(about, along) + np.cross(about, np.cross(about, arm)))
    assert d @ tip.position_hessian(q, w) @ d == pytest.approx(w @ bend, rel=1e-12)


def test_configurations_move_by_exponentials(tree, random):
    n = tree.n
    assert (tree.nq, tree.nv, n) == (20, 17, 17)
    assert tree.free_joints == [("root", "floating", 0, 0), ("hip", "spherical", 7, 6), ("load", "floating", 13, 11)]
    neutral = tree.neutral()
    assert neutral.tolist() == [0, 0, 0, 0, 0, 0, 1] + [0, 0, 0, 1] + [0, 0] + [0, 0, 0, 0, 0, 0, 1]
    q, d = tree.integrate(neutral, random.normal(size=n)), random.normal(size=n)
    moved = tree.integrate(q, d)
    assert_close(tree.difference(q, moved), d, 1e-13)
    assert_close(moved[11:13], q[11:13] + d[9:11], 1e-15)
    # A turn by an angle about an axis of the body: R(q) exp(theta).
    theta, axis = np.linalg.norm(d[6:9]), d[6:9] / np.linalg.norm(d[6:9])
    half = np.append(np.sin(theta / 2) * axis, np.cos(theta / 2))
    assert_close(rotation(moved[7:11]), rotation(q[7:11]) @ rotation(half), 1e-14)
    # Two half steps of a constant twist are one.
    assert_close(tree.integrate(tree.integrate(q, d / 2), d / 2), moved, 1e-14)
    stretched = moved.copy()
    stretched[7:11] *= 3
    assert_close(tree.normalize(stretched), moved, 1e-15)
    plain = costate.Robot.builder("cart").prismatic("rail", mass=1).build()
    assert (plain.nq, plain.nv, plain.free_joints) == (1, 1, [])
    assert plain.integrate([1.0], [0.5]).tolist() == [1.5] and plain.neutral().tolist() == [0.0]


def test_jacobians_of_configurations(tree, random):
    """By finite differences between tangent spaces; positions have a size of about 1."""
    n, unit = tree.n, np.eye(tree.n)
    q, d = tree.integrate(tree.neutral(), random.normal(size=n)), random.normal(size=n)
    to = tree.integrate(q, d)

    def check(found, function):
        expected, bound = slope(lambda s: function(s * unit).T, 1e-3, 16 * EPS)
        assert bound < 1e-8
        assert_within(found, expected, bound)

    by_q, by_d = tree.integrate_jacobians(d)
    check(by_q, lambda e: tree.difference(to, tree.integrate(tree.integrate(q, e), d)))
    check(by_d, lambda e: tree.difference(to, tree.integrate(q, d + e)))
    by_from, by_to = tree.difference_jacobians(q, to)
    check(by_from, lambda e: tree.difference(tree.integrate(q, e), to))
    check(by_to, lambda e: tree.difference(q, tree.integrate(to, e)))


@pytest.mark.parametrize("coordinates", ["qv", "qp"])
def test_batches_are_single_states(tree, random, coordinates):
    n, dynamics = tree.n, costate.Dynamics(tree, coordinates)
    q = tree.integrate(tree.neutral(), random.normal(size=(3, 1, 7, n)))
    v, tau, y = random.normal(size=(5, 1, n)), random.normal(size=n), random.normal(size=2 * n)
    f, jacobian, hessian = dynamics.contract(q, v, tau, y)
    assert (f.shape, jacobian.shape, hessian.shape) == ((3, 5, 7, 2 * n), (3, 5, 7, 2 * n, 3 * n), (3, 5, 7, 3 * n, 3 * n))
    room = np.empty_like(f)
    assert dynamics.f(q, v, tau, out=room) is room
    for k in ((0, 0, 0), (2, 4, 6), (1, 3, 2)):
        alone = q[k[0], 0, k[2]], v[k[1], 0], tau
        assert_close(room[k], dynamics.f(*alone), 1e-10)
        for found, expected in zip((f, jacobian, hessian), dynamics.contract(*alone, y), strict=True):
            assert_close(found[k], expected, 1e-9)
        assert_close(dynamics.centre_of_mass(q)[k[0], 0, k[2]], dynamics.centre_of_mass(alone[0]), 1e-12)
    assert tree.difference(q, tree.neutral()).shape == (3, 1, 7, n)


def test_quaternions_that_are_not_unit_are_told_by_their_length(tree, state):
    q, v, tau, *_ = state
    dynamics, wrong = costate.Dynamics(tree), q.copy()
    wrong[7:11] *= 1.25
    with pytest.raises(costate.NonUnitQuaternion, match="'hip' in q has the length 1.2") as caught:
        dynamics.f(wrong, v, tau)
    assert (caught.value.joint, caught.value.argument, caught.value.index) == ("hip", "q", ())
    assert caught.value.length == pytest.approx(1.25) and isinstance(caught.value, costate.StateError)
    batch = np.stack([q] * 40)
    batch[17] = wrong
    batch[30, 2] = np.nan
    for call in (dynamics.f, dynamics.rnea):
        with pytest.raises(costate.NonUnitQuaternion) as caught:
            call(batch, v, tau)
        assert caught.value.index == (17,)
    lenient = costate.Dynamics(tree, on_error="nan")
    with pytest.warns(costate.StateWarning, match="2 of 40 states"):
        f = lenient.f(batch, v, tau)
    assert np.isnan(f[[17, 30]]).all() and np.isfinite(np.delete(f, [17, 30], 0)).all()
    for call in (lambda: dynamics.frame("root").pose(wrong), lambda: tree.difference(q, wrong), lambda: dynamics.crba(wrong)):
        with pytest.raises(costate.NonUnitQuaternion):
            call()
    with pytest.raises(costate.NonUnitQuaternion, match="in q_1"):
        tree.difference(q, wrong)
    with pytest.raises(costate.NonFiniteState, match=r"q\[9\] \(joint 'hip'\)"):
        dynamics.f(np.where(np.arange(20) == 9, np.inf, q), v, tau)
    with pytest.raises(costate.NonFiniteState, match=r"q\[12\] \(joint 'mast'\)"):
        dynamics.f(np.where(np.arange(20) == 12, np.inf, q), v, tau)
    with pytest.raises(costate.NonUnitQuaternion, match="'hip' in q has the length 0, not 1; it has no direction") as caught:
        tree.normalize(np.where((np.arange(20) > 6) & (np.arange(20) < 11), 0.0, q))
    assert (caught.value.joint, caught.value.length) == ("hip", 0.0)
    with pytest.raises(costate.ArgumentError, match=r"not \(..., 20\).*quaternion"):
        dynamics.f(v, v, tau)
    assert np.isfinite(dynamics.f(tree.normalize(wrong), v, tau)).all()


def test_what_takes_no_quaternions_says_so(tree, drone, state):
    q, v, tau, *_ = state
    dynamics = costate.Dynamics(tree)
    refused = [
        lambda: costate.Step(dynamics, "rk4", 0.01),
        lambda: costate.Problem(tree, start=q, end=q, time=1.0),
        lambda: tree.lock({"root": 0.0}),
        lambda: tree.with_armature("hip", 1.0),
    ]
    for call in refused:
        with pytest.raises(costate.RobotError, match="'(root|hip)' is (floating|spherical)"):
            call()
    with pytest.raises(costate.CodegenError, match="'root' is floating.*Dynamics"):
        costate.codegen(tree, abi="casadi")
    with pytest.raises(costate.CodegenError, match="'root' is floating"):
        costate.codegen(tree, "f", parameters=True)
    scipy = pytest.importorskip("costate.scipy")
    with pytest.raises(costate.RobotError, match="'body' is floating"):
        scipy.Extremal(drone, np.zeros(12), np.zeros(12))


def test_a_model_of_pinocchio_is_mapped_with_its_free_joints(random):
    """Positions, velocities and torques of a humanoid there and back, and the same accelerations."""
    pinocchio = pytest.importorskip("pinocchio")
    path = ROBOTS / "humanoid32.urdf"
    robot = costate.Robot.from_file(path, floating_base=True)
    model = pinocchio.buildModelFromUrdf(str(path), pinocchio.JointModelFreeFlyer())
    model.gravity.linear = robot.gravity
    joints, n = robot.map_to(model), robot.n
    q = robot.integrate(robot.neutral(), random.normal(size=(4, n)))
    v, tau = random.normal(size=(2, 4, n))
    there = joints.q_to_pinocchio(q), joints.v_to_pinocchio(v), joints.v_to_pinocchio(tau)
    assert there[0].shape == (4, model.nq) and there[1].shape == (4, model.nv)
    assert np.array_equal(joints.q_from_pinocchio(there[0]), q)
    assert np.array_equal(joints.v_from_pinocchio(there[1]), v)
    data = model.createData()
    a = np.stack([pinocchio.aba(model, data, *arguments) for arguments in zip(*there)])
    assert_close(costate.Dynamics(robot).aba(q, v, tau), joints.v_from_pinocchio(a), 1e-10)
    step = pinocchio.integrate(model, there[0][0], there[1][0])
    assert_close(robot.integrate(q[0], v[0]), joints.q_from_pinocchio(step), 1e-13)
    with pytest.raises(costate.ArgumentError, match="lacks the joints .'root_joint'. of the robot"):
        robot.map_to(pinocchio.buildModelFromUrdf(str(path)))
    still = costate.Robot.from_file(path)
    with pytest.raises(costate.ArgumentError, match="the robot the joints .'root_joint'. of the model"):
        still.map_to(model)
    model.jointPlacements[1] = pinocchio.SE3.Random()
    with pytest.raises(costate.ArgumentError, match="'root_joint' has another frame in the model"):
        robot.map_to(model)


def test_source_code_has_the_quaternion_as_argument(drone):
    text = costate.codegen(drone, "f")
    assert "unit quaternions" in text and "f(" in text
    assert "machine code" in costate.Dynamics(drone).backend("f") or "generic" in costate.Dynamics(drone).backend("f")


def test_all_methods_are_compared_at_random_states(drone, tree):
    report = costate.check(drone, 3)
    assert report.passed and report.states == 3
    rows = {(row.quantity, row.method) for row in report.comparisons}
    assert {("F_x", "analytic"), ("y'F_xx", "analytic"), ("y'a_zz", "analytic"), ("F_x", "dual")} <= rows
    assert costate.check(tree, 2).passed


def test_robots_are_built_read_and_pickled(tree, drone):
    text = (FIXTURES / "free_tree.toml").read_text()
    assert costate.Robot.from_text(text) == tree and repr(tree) == "Robot('free tree', n=17, nq=20)"
    builder = costate.Robot.builder("pair").floating("base", mass=1, inertia=[1, 1, 1])
    pair = builder.spherical("ball", on="base", xyz=[0, 0, 1], mass=1, com=[0, 0, 0.1], inertia=[1, 1, 1]).build()
    assert pair.joint_names == ["base_x", "base_y", "base_z", "base_rx", "base_ry", "base", "ball_rx", "ball_ry", "ball"]
    assert (pair.nq, pair.nv) == (11, 9) and "'ball'" in repr(builder) and np.isinf(pair.position_limits).all()
    assert "spherical, 3 of 3" in pair._repr_html_()
    ur5 = ROBOTS / "ur5.urdf"
    flying = costate.Robot.from_file(ur5, floating_base=True)
    assert (flying.nq, flying.nv) == (13, 12) and flying.free_joints[0][0] == "root_joint"
    for robot in (tree, pair, flying, drone.with_gravity([0, 0, 0])):
        again = pickle.loads(pickle.dumps(robot))
        assert again == robot == copy.deepcopy(robot) and again.nq == robot.nq
        dynamics = pickle.loads(pickle.dumps(costate.Dynamics(robot, "qp")))
        assert dynamics == costate.Dynamics(robot, "qp")
    joint = '<joint name="fly" type="floating"><parent link="world"/><child link="body"/></joint>'
    inertia = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
    body = f'<link name="body"><inertial><mass value="1"/>{inertia}</inertial></link>'
    urdf = f'<robot name="fly"><link name="world"/>{body}{joint}</robot>'
    assert costate.Robot.from_text(urdf, quaternions=True).nq == 7
    assert costate.Robot.from_text(urdf).nq == 6


def test_a_body_held_at_a_point_is_a_spherical_pendulum(random):
    """A floating body whose point is pinned to the world moves as one on a spherical joint there."""
    body = {"mass": 2.0, "com": [0.1, -0.2, 0.3], "inertia": [0.2, 0.3, 0.25, 0.01, -0.02, 0.03]}
    held = costate.Robot.builder("held").floating("body", **body).build().with_constraint("pin", "body", kind="pinned")
    ball = costate.Robot.builder("ball").spherical("body", **body).build()
    constrained, pendulum = costate.ConstrainedDynamics(held), costate.Dynamics(ball, "qp")
    turn = ball.integrate(ball.neutral(), random.normal(size=3))
    v, y = random.normal(size=3), random.normal(size=6)
    q = np.concatenate([np.zeros(3), turn])
    p = constrained.momentum(q, np.concatenate([np.zeros(3), v]))
    f, jacobian, _ = constrained.contract(q, p, np.zeros(6), np.concatenate([np.zeros(9), y[:3]]))
    expected = pendulum.f(turn, costate.Dynamics(ball).momentum(turn, v), np.zeros(3))
    assert_close(f[3:6], v, 1e-12)
    assert_close(f[9:], expected[3:], 1e-11)
    a = costate.Dynamics(ball).aba(turn, v, np.zeros(3))
    assert_close(constrained.acceleration(q, p, np.zeros(6))[3:], a, 1e-11)
    assert jacobian.shape == (12, 18)
    assert_close(constrained.velocity(q, p)[0][3:], v, 1e-12)
