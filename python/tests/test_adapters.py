"""What adapters of other packages take, and joints of Pinocchio's models."""

import pickle
from types import SimpleNamespace

import costate
import costate.scipy
import numpy as np
import pytest
from conftest import assert_close, load

LINK = '<link name="l{k}"><inertial><mass value="1"/><origin xyz="0.1 0.2 0.3"/>'
LINK += '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
JOINT = '<joint name="j{k}" type="{kind}"><parent link="{on}"/><child link="l{k}"/><origin xyz="0 0.1 1" rpy="0.1 0.2 0.3"/>'
JOINT += '<axis xyz="{axis}"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'


def chain(*joints: tuple[str, str]) -> str:
    """A URDF of a chain of joints, each with its kind and its axis."""
    text = '<robot name="chain"><link name="base"/>'
    for k, (kind, axis) in enumerate(joints):
        text += LINK.format(k=k) + JOINT.format(k=k, kind=kind, axis=axis, on=f"l{k - 1}" if k else "base")
    return text + "</robot>"


def test_continuous_joints_of_any_axis(random):
    pinocchio = pytest.importorskip("pinocchio")
    text = chain(("continuous", "1 2 3"), ("prismatic", "1 2 3"), ("continuous", "0 -1 0"), ("revolute", "-1 0 0"), ("continuous", "0 0 1"))
    robot, model = costate.Robot.from_text(text), pinocchio.buildModelFromXML(text)
    model.gravity.linear = robot.gravity
    joints = robot.map_to(model)
    assert joints.signs == [1] * 5 and model.nq == 8
    q, v, tau = random.normal(size=(3, 5))
    there = [joints.q_to_pinocchio(q), joints.v_to_pinocchio(v), joints.v_to_pinocchio(tau)]
    assert_close(joints.q_from_pinocchio(there[0]), q, 1e-12)
    a = joints.v_from_pinocchio(pinocchio.aba(model, model.createData(), *there))
    assert_close(costate.Dynamics(robot).aba(q, v, tau), a, 1e-9)


def test_joints_of_another_kind_are_refused():
    pinocchio = pytest.importorskip("pinocchio")
    robot = costate.Robot.from_text(chain(("revolute", "0 0 1"), ("revolute", "0 1 1")))
    model = pinocchio.buildModelFromXML(chain(("revolute", "0 0 1"), ("prismatic", "0 1 1")))
    with pytest.raises(costate.ArgumentError, match="'j1' is prismatic in the model and revolute in the robot"):
        robot.map_to(model)


def test_what_is_no_model_or_has_another_length_is_refused(ur5):
    for wrong in (None, 3, SimpleNamespace(names=[])):
        with pytest.raises(costate.ArgumentError, match="give a pinocchio.Model") as raised:
            ur5.map_to(wrong)
        assert raised.value.argument == "model"
    names = list(ur5.joint_names)
    model = SimpleNamespace(names=["universe", *names], joints=[SimpleNamespace(nq=1)] * 7, idx_qs=[0, *range(6)])
    joints = ur5.map_to(model)
    for method in (joints.q_to_pinocchio, joints.q_from_pinocchio, joints.v_to_pinocchio, joints.v_from_pinocchio):
        assert method(np.zeros((4, 6))).shape == (4, 6) and method([0] * 6).shape == (6,)
        for wrong in (0.5, np.zeros(5), np.zeros((6, 7)), "six", [True] * 6, [[1.0], [1.0, 2.0]]):
            with pytest.raises(costate.ArgumentError) as raised:
                method(wrong)
            assert raised.value.argument in ("q", "v")


def test_adapters_of_scipy_say_what_they_take(ur5):
    x = np.zeros(12)
    by_robot, by_dynamics = (costate.scipy.Extremal(of, x, x) for of in (ur5, costate.Dynamics(ur5)))
    z = np.linspace(0.1, 0.5, 24)[:, None]
    assert np.array_equal(by_robot.torques(z), by_dynamics.torques(z))
    for given, name in [(ur5, "costate.Robot"), (costate.Dynamics(ur5), 'Dynamics in "qv"'), ("ur5", "str")]:
        with pytest.raises(costate.ArgumentError, match=f"step is a {name}; give a costate.Step") as raised:
            costate.scipy.Transcription(given, 3, x, x)
        assert raised.value.argument == "step"
    step = costate.Step(costate.Dynamics(ur5), "rk4", 0.1)
    with pytest.raises(costate.ArgumentError, match="dynamics is a costate.Step; give costate.Dynamics, or a costate.Robot"):
        costate.scipy.Extremal(step, x, x)
    for intervals in (0, 2.5, None):
        with pytest.raises(costate.ArgumentError, match="intervals"):
            costate.scipy.Transcription(step, intervals, x, x)


def test_adapters_of_casadi_say_what_they_take(ur5):
    casadi = pytest.importorskip("casadi")
    import costate.casadi

    z = np.full(6, 0.1)
    found = [costate.casadi.dynamics(of)(z, z, z) for of in (ur5, costate.Dynamics(ur5))]
    assert float(casadi.norm_inf(found[0] - found[1])) == 0
    for given, words in [(costate.Dynamics(ur5, "qp"), 'Dynamics in "qp"'), (None, "NoneType")]:
        with pytest.raises(costate.ArgumentError, match=f'robot is a {words}; give a costate.Robot, or costate.Dynamics in "qv"'):
            costate.casadi.dynamics(given)


def test_models_of_jax_are_pickled():
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    import costate.jax

    robot = load("two_link.toml")
    model = costate.jax.Model(robot, "reverse")
    again = pickle.loads(pickle.dumps(model))
    z = np.array([0.1, 0.2])
    assert again.order == "reverse" and np.array_equal(again.f(z, z, z), model.f(z, z, z))
    assert again == model != costate.jax.Model(robot) and hash(again) == hash(model)
    step = model.step("rk4", 0.1)
    copied = pickle.loads(pickle.dumps(step))
    x = np.concatenate([z, z])
    miss = [jax.jacfwd(jax.grad(lambda tau, f=f: (f(x[:2], x[2:], tau) ** 2).sum()))(z) for f in (step, copied)]
    assert np.array_equal(miss[0], miss[1])
    with pytest.raises(costate.ArgumentError, match="give costate.Dynamics, or a costate.Robot"):
        costate.jax.Model("robot")


def test_models_of_torch_take_robots():
    torch = pytest.importorskip("torch")
    import costate.torch

    z = torch.tensor([0.1, 0.2], dtype=torch.float64)
    robot = load("two_link.toml")
    assert torch.equal(costate.torch.Model(robot).f(z, z, z), costate.torch.Model(costate.Dynamics(robot)).f(z, z, z))


def test_models_of_crocoddyl_are_pickled():
    pytest.importorskip("crocoddyl")
    import costate.crocoddyl

    step = costate.Step(costate.Dynamics(load("two_link.toml")), "rk4", 0.05)
    model = costate.crocoddyl.ActionModel(step, np.arange(4.0), effort=[1, 2], deviation=0.5, exact=False)
    model.costate = np.arange(4.0) + 1
    last = costate.crocoddyl.FinalModel(step, np.arange(4.0), 3.0)
    for before, u in [(model, np.array([1.0, 2.0])), (last, np.zeros(0))]:
        after = pickle.loads(pickle.dumps(before))
        data = [of.createData() for of in (before, after)]
        for of, into in zip((before, after), data, strict=True):
            of.calc(into, np.full(4, 0.1), u)
            of.calcDiff(into, np.full(4, 0.1), u)
        assert type(after) is type(before) and data[0].cost == data[1].cost
        assert np.array_equal(data[0].Lxx, data[1].Lxx) and np.array_equal(data[0].xnext, data[1].xnext)
    assert np.array_equal(pickle.loads(pickle.dumps(model)).costate, model.costate)
    with pytest.raises(costate.ArgumentError, match="give a costate.Step"):
        costate.crocoddyl.ActionModel(step.dynamics, np.zeros(4))
