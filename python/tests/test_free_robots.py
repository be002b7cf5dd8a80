"""Robots with floating and spherical joints: configurations, batches, errors, what is refused, files, Pinocchio models."""

import copy
import pickle
import warnings

import costate
import numpy as np
import pytest
from conftest import ROBOTS, assert_close
from free_joints import (  # noqa: F401
    EPS,
    FIXTURES,
    assert_batch_is_single_states,
    assert_within,
    batch,
    drone,
    rotation,
    slope,
    state,
    tree,
)

# Bases without mass, which move.
pytestmark = pytest.mark.filterwarnings("ignore::costate.RobotWarning")


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
def test_batches_are_single_states(tree, batch, coordinates):
    (q, v, tau, y), dynamics = batch, costate.Dynamics(tree, coordinates)
    assert_batch_is_single_states(dynamics, q, v, tau, y, 2 * tree.n)
    centres = dynamics.centre_of_mass(q)
    for k in ((0, 0, 0), (2, 0, 6), (1, 0, 2)):
        assert_close(centres[k], dynamics.centre_of_mass(q[k]), 1e-12)
    assert tree.difference(q, tree.neutral()).shape == (3, 1, 7, tree.n)


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
    pushed = costate.Robot.from_text((FIXTURES / "free_tree.toml").read_text() + '[[wrench]]\nframe = "mast"\nforce = [1, 0, 0]\n')
    with pytest.raises(costate.RobotError, match="take no wrenches.*J = Frame.jacobian") as raised:
        costate.Dynamics(pushed).f(q, v, tau)
    assert raised.value.culprit == "root"
    step = costate.Step(costate.Dynamics(drone), "rk4", 0.01)
    scipy = pytest.importorskip("costate.scipy")
    vectors = [
        lambda: scipy.Extremal(drone, np.zeros(12), np.zeros(12)),
        lambda: scipy.Transcription(step, 3, np.zeros(12), np.zeros(12)),
    ]
    for call in vectors:
        with pytest.raises(costate.RobotError, match="'body' is floating.*costate.jax or costate.torch") as raised:
            call()
        assert raised.value.culprit == "body"


def test_crocoddyl_and_casadi_refuse_quaternions(drone):
    step = costate.Step(costate.Dynamics(drone), "rk4", 0.01)
    for module, call in (
        ("crocoddyl", lambda found: found.ActionModel(step, np.zeros(12))),
        ("casadi", lambda found: found.dynamics(drone)),
        ("casadi", lambda found: found.step(drone, "rk4", 0.01)),
    ):
        pytest.importorskip(module)
        found = pytest.importorskip(f"costate.{module}")
        with pytest.raises(costate.RobotError, match="'body' is floating"):
            call(found)


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
    with pytest.raises(costate.ArgumentError, match="the robot has the joints 'root_joint' alone"):
        robot.map_to(pinocchio.buildModelFromUrdf(str(path)))
    still = costate.Robot.from_file(path)
    with pytest.raises(costate.ArgumentError, match="the model has the joints 'root_joint' alone"):
        still.map_to(model)
    model.jointPlacements[1] = pinocchio.SE3.Random()
    with pytest.raises(costate.ArgumentError, match="'root_joint' has another frame in the model"):
        robot.map_to(model)


def test_source_code_has_the_quaternion_as_argument(drone):
    text = costate.codegen(drone, "f")
    assert "unit quaternions" in text and "f(" in text


def test_all_methods_are_compared_at_random_states(drone, tree):
    report = costate.check(drone, 3)
    assert report.passed and report.states == 3
    rows = {(row.quantity, row.method) for row in report.comparisons}
    assert {("F_x", "analytic"), ("y'F_xx", "analytic"), ("y'a_zz", "analytic"), ("F_x", "dual")} <= rows
    schemes = ["RK4 (q, p)", "Verlet (q, p)", "midpoint (q, p)", "RK4 (q, v)"]
    assert {("Phi_z, z = (x, u, h)", scheme) for scheme in schemes} <= rows
    assert costate.check(tree, 2).passed


def test_robots_are_built_read_and_pickled(tree, drone, caplog):
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
    # What was done is a note, which is logged.
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with caplog.at_level("INFO", "costate"):
            replaced = costate.Robot.from_text(urdf)
    assert replaced.nq == 6 and any("request it by quaternions=True" in note for note in replaced.warnings)
    assert "request it by quaternions=True" in caplog.text


def test_the_inside_of_a_free_joint_has_no_frames(drone, tree):
    assert drone.frame_names == ["world", "body"]
    with pytest.raises(costate.RobotError, match="body_rx"):
        costate.Dynamics(drone).frame("body_rx")
    assert not any(name.endswith(("_rx", "_ry")) for name in tree.frame_names)


def test_free_joints_remain_where_others_are_held():
    flying = costate.Robot.from_file(ROBOTS / "ur5.urdf", floating_base=True)
    q = flying.neutral()
    q[7:] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]
    kept = ["root_joint", "shoulder_pan_joint"]
    held = dict(zip(flying.joint_names[7:], q[8:].tolist()))
    assert flying.reduced_to(kept, q.tolist()) == flying.lock(held)
    with pytest.raises(costate.RobotError, match="'root_joint' is floating.*name it among the joints that remain"):
        flying.reduced_to(["shoulder_pan_joint"])


def test_robots_in_toml_name_the_joint_of_their_base():
    path = ROBOTS / "two_link.toml"
    for read, source in ((costate.Robot.from_file, path), (costate.Robot.from_text, path.read_text())):
        with pytest.raises(costate.ArgumentError, match='give that joint type = "floating"') as error:
            read(source, floating_base=True)
        assert error.value.argument == "floating_base"
        assert read(source, quaternions=True).nq == 2


def test_quaternions_of_any_size_are_normalised(drone):
    q = drone.neutral()
    for size in (1e-160, 1e160):
        q[3:] = np.array([0.0, 3.0, 0.0, -4.0]) * size
        assert_close(drone.normalize(q)[3:], [0, 0.6, 0, -0.8], 1e-15)
