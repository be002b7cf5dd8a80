"""Motions of robots with floating and spherical joints: a satellite by its file and by hand, values of another program."""

import pickle

import costate
import numpy as np
import pytest
from conftest import ROBOTS, assert_close

EXAMPLES = ROBOTS.parent / "examples" / "problems"
SATELLITE = EXAMPLES / "satellite_arm.toml"
# By hand: the same problem.
START = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.5, -2.0]
END = [0.0, 0.0, 0.0, 0.3, 0.4, 0.0, 0.75**0.5, -0.5, 0.6]
TABLES = {
    "start": START,
    "end": {"q": END, "q_free": ["base_x", "base_y", "base_z"]},
    "time": 10.0,
    "cost": [0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0],
    "limits": {"torque_max": [0.0, 0.0, 0.0, 2.0, 2.0, 2.0, 10.0, 10.0]},
}


@pytest.fixture(scope="module")
def satellite() -> costate.Robot:
    return costate.Robot.from_file(EXAMPLES / "robots" / "satellite.toml")


@pytest.fixture(scope="module")
def folded(satellite) -> costate.Solution:
    return costate.Problem(satellite, **TABLES).solve(tolerance=1e-6).check()


def test_a_satellite_by_its_file_and_by_hand(satellite, folded):
    problem = costate.Problem.from_file(SATELLITE)
    found = problem.solve()
    assert found.converged and found.cost == pytest.approx(folded.cost, rel=1e-9)
    assert problem.robot == satellite and folded.keeps_limits and folded.end_defect < 1e-4
    assert (folded.q.shape[1], satellite.nq, satellite.n) == (9, 9, 8)
    assert {rows.shape[1] for rows in (folded.v, folded.p, folded.u, folded.tau, folded.a)} == {8}
    assert folded.costates.shape[1] == 16
    # Where it begins and ends; nothing pushes it: the momentum of the base stays zero, and its centre of mass too.
    assert_close(folded.q[0], START, 1e-12)
    assert_close(folded.q[-1, 3:], END[3:], 1e-6)
    dynamics = costate.Dynamics(satellite)
    assert np.abs(folded.p[:, :3]).max() < 1e-6 and not folded.tau[:, :3].any()
    centre = dynamics.centre_of_mass(folded.q)
    assert np.abs(centre - centre[0]).max() < 1e-5
    assert_close(dynamics.momentum(folded.q, folded.v), folded.p, 1e-9)
    assert_close(dynamics.aba(folded.q, folded.v, folded.tau), folded.a, 1e-9)


def test_samples_move_as_their_rates_say(satellite, folded, tmp_path):
    samples = folded.sample(200.0)
    assert samples.q.shape == (2001, 9) and samples.v.shape == samples.tau.shape == (2001, 8)
    moved = satellite.difference(samples.q[:-1], samples.q[1:]) * 200.0
    assert np.abs(moved - (samples.v[1:] + samples.v[:-1]) / 2).max() < 1e-4
    names = [f"base_{part}" for part in ("x", "y", "z", "qx", "qy", "qz", "qw")] + ["shoulder", "elbow"]
    assert samples.position_names == names and samples.joint_names == satellite.joint_names
    header = samples.to_csv(tmp_path / "motion.csv").splitlines()[0].split(",")
    assert header[1:12] == [f"q_{name}" for name in names] + ["v_base_x", "v_base_y"]
    assert header[10 + 3 :][:3] == ["v_base_rx", "v_base_ry", "v_base"]
    assert (tmp_path / "motion.csv").read_text() == samples.to_csv() and pickle.loads(pickle.dumps(samples)) == samples
    pandas = pytest.importorskip("pandas")
    table = folded.to_dataframe(10.0)
    assert list(table.columns[: len(names) + 1]) == ["t", *(f"q_{name}" for name in names)] and isinstance(table, pandas.DataFrame)


def test_what_is_written_is_read_again(satellite, folded, tmp_path):
    problem = folded.problem
    for read in (costate.Solution.from_json(folded.to_json(), problem), pickle.loads(pickle.dumps(folded))):
        assert np.array_equal(read.q, folded.q) and np.array_equal(read.v, folded.v) and read.cost == folded.cost
    assert pickle.loads(pickle.dumps(folded)) == folded and pickle.loads(pickle.dumps(problem)) == problem
    folded.save(tmp_path / "folded.json")
    again = problem.solve(start_from=tmp_path / "folded.json")
    assert again.cost == pytest.approx(folded.cost, rel=1e-6) and again.newton_iterations < folded.newton_iterations
    assert pickle.loads(pickle.dumps(costate.Problem(satellite, TABLES, start_from={"file": str(tmp_path / "folded.json")})))
    # A robot whose joints have the same names, all of one degree of freedom, is another one.
    builder = costate.Robot.builder("satellite", gravity=[0, 0, 0])
    on = None
    for name in satellite.joint_names:
        kind = builder.prismatic if name in ("base_x", "base_y", "base_z") else builder.revolute
        builder = kind(name, axis=[0, 0, 1], mass=1.0, com=[0.3, 0, 0], **({} if on is None else {"on": on}))
        on = name
    chain = costate.Problem(builder.build(), start=[0.0] * 8, end=[0.1] * 8, time=1.0, cost=[1.0] * 8)
    with pytest.raises(costate.MotionError, match="base"):
        costate.Solution.from_json(folded.to_json(), chain)


def test_pictures_of_a_motion(folded):
    page = folded._repr_html_()
    assert page.count('class="curve"') == 9 + 8 and "base_qw" in page and "base_ry" in page
    report = folded.to_html()
    assert '"name":"base_qw"' in report and '"kind":"quaternion"' in report
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    axes = folded.plot(10.0)
    assert [len(ax.lines) for ax in axes] == [9, 8, 8, 8]
    assert [text.get_text() for text in axes[0].get_legend().get_texts()][6:8] == ["base_qw", "shoulder"]


def test_the_least_cost_of_a_body_that_turns_over():
    """150 degrees and a hinge, all coordinates driven, against gravity: the cost that CasADi and IPOPT find.

    ``bash benches/ocp/run --values freely`` has their equations.
    """
    builder = costate.Robot.builder("body", gravity=[0.0, 0.0, -2.0])
    builder = builder.floating("root", mass=2.0, com=[0.05, 0.0, 0.1], inertia=[0.3, 0.4, 0.5, 0, 0, 0])
    link = {"mass": 0.8, "com": [0.5, 0.0, 0.0], "inertia": [0.02, 0.1, 0.1, 0, 0, 0]}
    robot = builder.revolute("hinge", on="root", axis=[0, 1, 0], xyz=[0.2, 0, 0], **link).build()
    axis = np.array([0.2, 1.0, 0.3])
    angle = np.radians(150.0)
    turned = np.append(np.sin(angle / 2) * axis / np.linalg.norm(axis), np.cos(angle / 2))
    end = np.concatenate([[0.5, 0.2, 0.3], turned, [0.8]])
    problem = costate.Problem(
        robot, start=robot.neutral(), end=end, time=2.0, cost=np.ones(7), limits={"torque_max": [np.inf] * 7}
    )
    solution = problem.solve(starts=3, tolerance=1e-6).check()
    assert solution.cost == pytest.approx(33.3867199, rel=1e-5)
    assert_close(solution.q[-1], end, 1e-6)


def test_a_ball_joint_turns_by_its_motors():
    """A body about a principal axis at rest: 6 I^2 angle^2/T^3."""
    builder = costate.Robot.builder("ball", gravity=[0, 0, 0])
    robot = builder.spherical("ball", mass=1.0, inertia=[0.2, 0.3, 0.4, 0, 0, 0]).build()
    end = [0.0, 0.0, np.sin(0.6), np.cos(0.6)]
    solution = costate.Problem(robot, start=[0, 0, 0, 1], end=end, time=2.0, cost=[1.0] * 3, limits={"torque_max": [np.inf] * 3})
    solution = solution.solve(tolerance=1e-6).check()
    assert solution.cost == pytest.approx(6 * 0.16 * 1.2**2 / 8, rel=1e-6)
    assert solution.q.shape[1] == 4 and solution.v.shape[1] == 3


def test_what_such_motions_do_not_take_is_named(satellite, folded):
    problem = folded.problem
    refused = [
        folded.feedback,
        folded.sensitivities,
        lambda: costate.Resolve(problem),
        lambda: problem.solve(method="collocation"),
    ]
    for call in refused:
        with pytest.raises(costate.ProblemError, match="'base' is floating"):
            call()
    with pytest.raises(costate.ProblemError, match="end.q.*has 8 entries, and the robot 9 positions") as raised:
        costate.Problem(satellite, TABLES | {"end": END[:8]})
    assert raised.value.key == "end.q"
    with pytest.raises(costate.ProblemError, match=r"q\[3\] to q\[6\], has length 1.1") as raised:
        costate.Problem(satellite, TABLES | {"start": [0, 0, 0, 0, 0, 0, 1.1, 1.5, -2.0]})
    assert raised.value.key == "start.q"
    with pytest.raises(costate.ProblemError, match="'base' turns freely") as raised:
        costate.Problem(satellite, TABLES | {"via": [{"q": END, "time": 5.0}]})
    assert raised.value.key.startswith("via")


def test_the_base_of_a_file_flies_by_a_keyword_as_by_its_key(tmp_path):
    """The robot is that of `Robot.from_file`, also after a pickle; friction likewise."""
    inertia = '<inertia ixx="{0}" iyy="{0}" izz="{0}" ixy="0" ixz="0" iyz="0"/>'
    link = '<link name="{0}"><inertial><mass value="{1}"/>' + inertia.replace("{0}", "{2}") + "</inertial></link>"
    joint = '<joint name="wheel" type="continuous"><parent link="trunk"/><child link="rotor"/><axis xyz="0 0 1"/>'
    joint += '<dynamics damping="0.1"/></joint>'
    urdf = f'<robot name="wheel">{link.format("trunk", 10, 3)}{link.format("rotor", 1, 0.2)}{joint}</robot>'
    (tmp_path / "wheel.urdf").write_text(urdf)
    text = """[start]
q = [0, 0, 0, 0, 0, 0, 1, 0]
[end]
q = [0, 0, 0, 0, 0, 0.6, 0.8, 0]
q_free = ["root_joint_x", "root_joint_y", "root_joint_z", "wheel"]
[time]
final = 2.0
[cost]
effort = [1, 1, 1, 1, 1, 1, 1]
"""
    path = tmp_path / "turn.toml"
    by_key = 'robot = { file = "wheel.urdf", floating_base = true, friction = true, gravity = [0, 0, 0] }\n' + text
    by_keyword = 'robot = { file = "wheel.urdf", gravity = [0, 0, 0] }\n' + text
    found = []
    for content, options in ((by_key, {}), (by_keyword, {"floating_base": True, "friction": True})):
        path.write_text(content)
        for problem in (costate.Problem.from_file(path, **options), costate.Problem.from_text(content, folder=tmp_path, **options)):
            flying = costate.Robot.from_file(tmp_path / "wheel.urdf", floating_base=True, friction=True)
            assert problem.robot == flying.with_gravity([0, 0, 0])
            again = pickle.loads(pickle.dumps(problem))
            assert again == problem and again.robot == problem.robot
            found.append(problem.solve().check().cost)
    assert np.ptp(found) <= 1e-9 * found[0]
    with pytest.raises(costate.ArgumentError, match="names the joint of its base itself"):
        costate.Problem.from_file(SATELLITE, floating_base=True)
