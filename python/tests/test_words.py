"""Errors name the culprit and say in Python's words what to do."""

import builtins
import re
import traceback
import warnings

import costate
import costate.scipy
import numpy as np
import pytest
from conftest import ROBOTS, load


def arm(**keys):
    return costate.Robot.builder("arm").revolute("hinge", mass=1, com=[1, 0, 0], **keys).build()


def test_inertias_are_six_numbers_three_or_a_matrix():
    full = [[1.0, 0.1, 0.2], [0.1, 2.0, 0.3], [0.2, 0.3, 2.5]]
    six = [1.0, 2.0, 2.5, 0.1, 0.2, 0.3]
    given = [arm(inertia=inertia) for inertia in (six, np.array(six), full, np.array(full))]
    assert all(robot == given[0] for robot in given)
    assert arm(inertia=np.diag([1, 2, 2.5])) == arm(inertia=[1, 2, 2.5]) != given[0]
    loads = [load("ur5.urdf").with_payload("tool0", 1.0, np.zeros(3), inertia) for inertia in (six, np.array(full))]
    assert loads[0] == loads[1]
    full[0][1] = 0.2
    with pytest.raises(TypeError, match="the matrix is not symmetric: xy is 0.2 and 0.1"):
        arm(inertia=full)


@pytest.mark.parametrize(
    "keys, words",
    [
        ({"axis": [0, 0]}, r"give three numbers, not \[0, 0\]"),
        ({"xyz": "abc"}, "give three numbers, not 'abc'"),
        ({"mimic": ("j", 1)}, r"give the name of a joint, a ratio and an offset, not \('j', 1\)"),
        ({"inertia": np.zeros((2, 2))}, "give xx, yy, zz, xy, xz, yz or a 3 x 3 matrix"),
    ],
)
def test_an_argument_of_a_joint_is_named(keys, words):
    with pytest.raises(TypeError, match=words) as raised:
        arm(**keys)
    assert f"'{next(iter(keys))}'" in "".join(traceback.format_exception_only(raised.value))


def test_one_name_is_not_read_letter_by_letter():
    dynamics = costate.ConstrainedDynamics(load("four_bar.toml"))
    with pytest.raises(TypeError, match="give a list of names, not 'crank'"):
        dynamics.close(np.zeros(dynamics.n), held="crank")
    assert dynamics.close(np.zeros(dynamics.n), held=None).shape == (dynamics.n,)


def test_masks_and_imaginary_parts_are_not_dropped(ur5):
    dynamics, zero = costate.Dynamics(ur5), np.zeros(6)
    with pytest.raises(costate.ArgumentError, match=r"v is a masked array.*v.filled\(0.0\)") as raised:
        dynamics.f(zero, np.ma.masked_array(zero, mask=[True] + 5 * [False]), zero)
    assert raised.value.argument == "v"
    with pytest.raises(costate.ArgumentError, match="pass q.real if its imaginary parts are zero"):
        dynamics.f(zero + 0j, zero, zero)
    # Other classes of arrays are taken as what they are.
    assert np.array_equal(dynamics.f(zero.view(np.recarray), zero, zero), dynamics.f(zero, zero, zero))


def test_advice_is_in_words_of_python(ur5):
    with pytest.raises(costate.RobotError) as raised:
        ur5.lock({"zz": 0.0})
    assert "costate info" not in str(raised.value) and "robot.all_joint_names" in str(raised.value)
    chain = costate.Robot.builder("chain")
    for k in range(60):
        chain.revolute(f"j{k}", on=f"j{k - 1}" if k else None, xyz=[0, 0, 0.1], axis=[k % 2, (k + 1) % 2, 0], mass=1, com=[0, 0, 0.1])
    long = costate.Dynamics(chain.build()).backend("hessian")
    assert "generic code" in long and "::" not in long and "JitQuantity" not in long
    bars = load("four_bar.toml")
    with pytest.raises(costate.ProblemError, match="nearby the loops close at q = ") as raised:
        costate.Resolve(costate.Problem(bars, start=[0.5, 0.1, 0.2], end=[0.1] * 3, time=1.0, cost=[1.0] * 3))
    assert raised.value.key == "start.q"


def test_files_are_named(limited, solved, tmp_path):
    for call in (lambda: solved.to_html(urdf="none.urdf"), lambda: solved.to_viser(urdf="none.urdf")):
        with pytest.raises((FileNotFoundError, ImportError)) as raised:
            call()
        if isinstance(raised.value, FileNotFoundError):
            assert raised.value.filename == "none.urdf" and "none.urdf" in str(raised.value)
    with pytest.raises(costate.MotionError, match=r"ur5\.urdf: .*line 1 column 1"):
        costate.Solution.load(ROBOTS / "ur5.urdf", limited)
    with pytest.raises(costate.ArgumentError, match="ur5.urdf has no visual model of a link of") as raised:
        solved.to_html(urdf=ROBOTS / "ur5.urdf")
    assert raised.value.argument == "urdf"


def test_one_folder_of_packages_needs_no_list(tmp_path):
    mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    (tmp_path / "arm").mkdir()
    (tmp_path / "arm" / "hand.obj").write_text(mesh)
    visual = '<visual><geometry><mesh filename="package://arm/hand.obj"/></geometry></visual>'
    text = (
        f'<robot name="r"><link name="base"/><link name="hand"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" '
        f'ixy="0" ixz="0" iyz="0"/></inertial>{visual}</link><joint name="j" type="continuous"><parent link="base"/>'
        '<child link="hand"/><axis xyz="0 0 1"/></joint></robot>'
    )
    solution = costate.Problem(costate.Robot.from_text(text), start=[0.0], end=[1.0], time=1.0, cost=[1.0]).solve()
    with pytest.warns(UserWarning, match=r"give its folder by package_path=\[...\]"):
        solution.to_html()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert solution.to_html(package_path=str(tmp_path)) == solution.to_html(package_path=[tmp_path])


def test_what_is_exceeded_between_the_points_is_shown(limited):
    solved = limited.solve(tolerance=1e-4)
    shown = str(solved), solved._repr_html_()
    for kind, use in solved.limits.items():
        if kind != "torque" and use["between"] > use["at_points"]:
            assert all(f"between the points by {use['between']:.1e}" in text for text in shown)
    assert any(use["between"] > use["at_points"] for use in solved.limits.values())


def test_reports_of_checks_are_short(ur5):
    report = costate.check(ur5, 1)
    assert re.fullmatch(r"CheckReport\(passed, \d+ comparisons, 1 states, 0 left out\)", repr(report))
    assert report._repr_html_().startswith("<pre>") and "agrees" in report._repr_html_()
    with pytest.raises(costate.ArgumentError, match="robot is a Dynamics; give a costate.Robot") as raised:
        costate.check(costate.Dynamics(ur5))
    assert raised.value.argument == "robot"


def test_a_sweep_on_an_executor_takes_no_number_of_workers():
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(1) as threads, pytest.raises(costate.ArgumentError, match="leave it out") as raised:
        costate.sweep(abs, [1], threads, workers=3)
    assert raised.value.argument == "workers"


def test_what_is_not_installed_is_named(ur5, monkeypatch):
    original = builtins.__import__

    def missing(name, *arguments, **keys):
        if name == "cyipopt":
            raise ModuleNotFoundError("No module named 'cyipopt'")
        return original(name, *arguments, **keys)

    monkeypatch.setattr(builtins, "__import__", missing)
    step = costate.Step(costate.Dynamics(ur5), "rk4", 0.1)
    with pytest.raises(ImportError, match="pip install cyipopt"):
        costate.scipy.Transcription(step, 3, np.zeros(12), np.zeros(12)).ipopt()


def test_equal_programs_and_extremals_are_equal(ur5):
    x, y = np.zeros(12), np.ones(12)
    step = costate.Step(costate.Dynamics(ur5), "rk4", 0.1)
    programs = [costate.scipy.Transcription(step, 3, x, goal) for goal in (x, x, y)]
    extremals = [costate.scipy.Extremal(ur5, x, goal) for goal in (x, x, y)]
    for one, same, other in (programs, extremals):
        assert one == same != other and hash(one) == hash(same) and one != 1


def test_functions_of_acados_and_casadi_are_written(arm):
    acados = costate.codegen(arm, abi="acados", scheme="rk4", dt=0.01)
    assert all(name in acados for name in ("two_link_expl_ode_hess(", "two_link_dyn_disc_phi_fun_jac_hess("))
    assert "int jac_adj1_two_link_fd(" in costate.codegen(arm, abi="casadi")
    for keys, words in [
        ({"abi": "matlab"}, "unknown abi 'matlab'; give 'casadi' or 'acados'"),
        ({"abi": "acados", "quantity": "f"}, "leave out quantity"),
        ({"abi": "acados", "scheme": "midpoint"}, "no source for the scheme 'midpoint'"),
        ({"quantity": "f", "scheme": "rk4"}, "scheme is of abi='casadi' and abi='acados' alone"),
        ({"quantity": "f", "dt": 0.1}, "dt is of abi="),
        ({}, "unknown quantity ''; give one of"),
    ]:
        with pytest.raises(costate.ArgumentError, match=re.escape(words)):
            costate.codegen(arm, **keys)


def test_a_bar_of_text_without_a_warning(monkeypatch):
    """What tqdm says in a notebook without ipywidgets is no advice for this package."""
    pytest.importorskip("tqdm")
    from costate._progress import tqdm_or_none

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        assert tqdm_or_none() is not None
    assert not caught
