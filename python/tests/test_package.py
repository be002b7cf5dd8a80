"""The package as a whole: examples of docstrings, stubs, source text, the comparison of methods, Pinocchio."""

import doctest
import importlib.util
import inspect
import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import costate
import numpy as np
import pytest
from conftest import ROBOTS, assert_close, load
from interface import public


def documented():
    """All public objects and their methods, by name."""
    yield "costate", costate
    for name in costate.__all__:
        thing = getattr(costate, name)
        yield name, thing
        if inspect.isclass(thing):
            own = [base for base in thing.__mro__ if base.__module__.startswith("costate")]
            for part, method in (pair for base in own for pair in vars(base).items()):
                if not part.startswith("_"):
                    yield f"{name}.{part}", method


def test_everything_public_is_documented():
    missing = [name for name, thing in documented() if name != "__version__" and not inspect.getdoc(thing)]
    inherited = [name for name in missing if not hasattr(getattr(costate, name.split(".")[0]), "__dataclass_fields__")]
    errors = [getattr(costate, name) for name in costate.__all__ if name.endswith("Error")]
    attributes = {part for of in errors for part in vars(of) if not part.startswith("_")}
    assert {name.split(".")[1] for name in inherited} <= attributes


def test_examples_of_docstrings():
    runner, parser, found = doctest.DocTestRunner(), doctest.DocTestParser(), 0
    for name, thing in documented():
        test = parser.get_doctest(inspect.getdoc(thing) or "", {}, name, None, 0)
        found += bool(test.examples)
        runner.run(test)
    assert found >= 8 and runner.failures == 0


def test_the_example_of_the_readme(monkeypatch, capsys):
    monkeypatch.chdir(ROBOTS.parent)
    text = (ROBOTS.parent / "python" / "README.md").read_text()
    names = {}
    exec(text.split("```python\n")[1].split("```")[0], names)
    assert names["J"].shape == (1000, 12, 18) and "states compared" in capsys.readouterr().out


def test_the_example_of_motions(monkeypatch, capsys, tmp_path):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "robots").symlink_to(ROBOTS)
    text = (ROBOTS.parent / "python" / "README.md").read_text()
    exec(text.split("```python\n")[2].split("```")[0], {})
    assert "converged" in (shown := capsys.readouterr().out) and "(1001, 6)" in shown
    assert len((tmp_path / "motion.csv").read_text().splitlines()) == 1002


# Packages that some modules need, which have the same names, and others that are imported where they are used.
FRIENDS = ("casadi", "crocoddyl", "jax", "scipy", "torch")
OTHERS = ("cyipopt", "matplotlib", "pandas", "pyarrow", "tqdm", "viser")


@pytest.fixture
def typed(tmp_path):
    """Settings of mypy: strict. Other packages are not looked into."""
    pytest.importorskip("mypy")
    foreign = "".join(f"[mypy-{name}.*]\nignore_missing_imports = True\nfollow_imports = skip\n" for name in FRIENDS + OTHERS)
    (tmp_path / "mypy.ini").write_text(f"[mypy]\nstrict = True\n{foreign}")
    return tmp_path / "mypy.ini"


def test_stubs_are_those_of_the_module(typed, tmp_path):
    # A module cannot be imported where its package is not installed.
    missing = [name for name in FRIENDS if importlib.util.find_spec(name) is None]
    allowed = "".join(f"costate\\.{name}(\\..*)?\n" for name in missing)
    # Crocoddyl has no types: nobody can know the metaclass of its classes. Their methods are compared.
    allowed += "".join(f"costate\\.crocoddyl\\.{name}\n" for name in ("ActionModel", "Costates", "FinalModel"))
    (tmp_path / "allowed").write_text(allowed)
    command = [sys.executable, "-m", "mypy.stubtest", "costate", "--ignore-disjoint-bases", "--ignore-unused-allowlist"]
    command += ["--mypy-config-file", typed, "--allowlist", tmp_path / "allowed"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_types_are_strict(typed, tmp_path):
    command = [sys.executable, "-m", "mypy", "--config-file", typed, "--cache-dir", tmp_path / "cache", "-p", "costate"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_calls_of_the_guide_have_the_types_of_the_stubs(typed, tmp_path):
    """Of all code blocks. What mypy infers is less than what they say: of dictionaries behind ``**``, of texts in loops."""
    path = ROBOTS.parent / "docs" / "guide" / "pages.py"
    spec = importlib.util.spec_from_file_location("pages", path)
    pages = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(pages)
    (tmp_path / "guide").mkdir()
    for page in filter(pages.blocks, pages.PAGES):
        (tmp_path / "guide" / f"page_{page.stem}.py").write_text("".join(code for _, code in pages.blocks(page)))
    wrong = tmp_path / "guide" / "wrong.py"
    wrong.write_text("import costate\ncostate.Robot.builder('x', gravity=object())\n")
    names = {name.split(".")[-1] for name, _, _ in public()}

    command = [sys.executable, "-m", "mypy", "--config-file", typed, "--cache-dir", tmp_path / "cache", tmp_path / "guide"]
    done = subprocess.run(command, capture_output=True, text=True)
    found = []
    for line in done.stdout.splitlines():
        called = re.search(r'Argument .* to "(\w+)".* has incompatible type "(.*?)"; expected "(.*)"  \[arg-type\]', line)
        inferred = called and (called[2].startswith("**") or called[2] == "str" and called[3].startswith("Literal"))
        if called and called[1] in names and not inferred:
            found.append(line)
    assert [line for line in found if "wrong.py" not in line] == [] and len(found) == 1, done.stdout + done.stderr


def test_generated_source_compiles_and_computes(ur5, random, tmp_path):
    text = costate.codegen(ur5, "f", "qv", "c")
    assert "fn ur5_lagrangian_f" in costate.codegen(ur5, "f", "qv", "rust")
    assert len(costate.codegen(ur5, "f_x", "qp")) > len(text)
    with pytest.raises(costate.ArgumentError, match="y_tau_zz"):
        costate.codegen(ur5, "hessian")
    with pytest.raises(costate.CodegenError, match="inverse_dynamics"):
        costate.codegen(ur5, "inverse_dynamics", "qp")
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("no C compiler")
    import ctypes

    (tmp_path / "f.c").write_text(text)
    library = tmp_path / "f.so"
    subprocess.run([compiler, "-O1", "-shared", "-fPIC", "-o", library, tmp_path / "f.c", "-lm"], check=True)
    function = ctypes.CDLL(library).ur5_lagrangian_f
    q, v, tau, a = (*random.normal(size=(3, 6)), np.zeros(6))
    function(*(part.ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for part in (q, v, tau, a)))
    assert_close(a, costate.Dynamics(ur5).aba(q, v, tau), 1e-11)


def test_check_compares_all_methods(puma):
    report = costate.check(puma, 2, seed=3)
    assert report.passed and report.states == 2 and len(report.comparisons) > 20
    assert {"machine code", "analytic"} <= {row.method for row in report.comparisons}
    assert "DIFFERS" not in str(report) and "2 states compared" in str(report)
    worst = max(report.comparisons, key=lambda row: row.difference)
    assert not costate.CheckReport([costate.Comparison("F", "x", 1.0, 1e-9, False)], 1, 0).passed and worst.agrees


def model_of(robot, order, turned=()):
    """A stand-in for a Pinocchio model: these joints in this order, some with their axes the other way."""
    zero = costate.Dynamics(robot)
    axes = {
        name: zero.frame(f"joint:{name}").jacobian(np.zeros(robot.n))[:3, k] * (-1 if name in turned else 1)
        for k, name in enumerate(robot.joint_names)
    }
    joints = [SimpleNamespace(nq=0)]
    joints += [SimpleNamespace(nq=1, axis=axes[name], shortname=lambda: "JointModelRevoluteUnaligned") for name in order]
    still = SimpleNamespace(rotation=np.eye(3))
    positions = [0, *range(len(order))]
    return SimpleNamespace(
        names=["universe", *order],
        joints=joints,
        idx_qs=positions,
        idx_vs=positions,
        jointPlacements=[still] * (len(order) + 1),
        parents=[0] * (len(order) + 1),
    )


def test_joints_of_a_model_in_another_order(ur5, random):
    order = [ur5.joint_names[k] for k in (3, 0, 5, 1, 2, 4)]
    joints = ur5.map_to(model_of(ur5, order, turned=["elbow_joint"]))
    assert joints.indices_q == joints.indices_v == [1, 3, 4, 0, 5, 2] and joints.signs == [1, 1, -1, 1, 1, 1]
    q = random.normal(size=(4, 6))
    there = joints.q_to_pinocchio(q)
    assert_close(there[:, 4], -q[:, 2], 1e-15)
    assert_close(joints.q_from_pinocchio(there), q, 1e-15)
    assert_close(joints.v_from_pinocchio(joints.v_to_pinocchio(q)), q, 1e-15)
    with pytest.raises(costate.ArgumentError, match="elbow_joint"):
        ur5.lock({"elbow_joint": 0.0}).map_to(model_of(ur5, order))
    with pytest.raises(costate.ArgumentError, match="wrist_3_joint"):
        ur5.map_to(model_of(ur5, order[:2] + order[3:]))


@pytest.mark.parametrize("file", ["ur5.urdf", "humanoid32.urdf"])
def test_pinocchio_computes_the_same(file, random):
    pinocchio = pytest.importorskip("pinocchio")
    robot = load(file)
    model = pinocchio.buildModelFromUrdf(str(ROBOTS / file))
    model.gravity.linear = robot.gravity
    data, joints, dynamics = model.createData(), robot.map_to(model), costate.Dynamics(robot)
    q, v, tau = random.normal(size=(3, robot.n))
    there = [joints.q_to_pinocchio(q), joints.v_to_pinocchio(v), joints.v_to_pinocchio(tau)]
    a = joints.v_from_pinocchio(pinocchio.aba(model, data, *there))
    assert_close(dynamics.aba(q, v, tau), a, 1e-9)
    assert_close(dynamics.rnea(q, v, tau), joints.v_from_pinocchio(pinocchio.rnea(model, data, *there)), 1e-10)


def test_licences_of_others_are_up_to_date():
    """What the wheel contains beside LICENSE-*; read offline from what cargo has."""
    if shutil.which("cargo") is None:
        pytest.skip("no cargo")
    script = ROBOTS.parent / "python" / "update_licences.py"
    done = subprocess.run([sys.executable, script, "--check"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_an_exception_in_a_thread_fails_the_test_that_runs(tmp_path):
    """The configuration of these tests, with a test whose thread raises."""
    test = tmp_path / "test_thread.py"
    test.write_text(
        "import threading\n"
        "def test_thread():\n"
        "    thread = threading.Thread(target=lambda: 1 / 0)\n"
        "    thread.start()\n"
        "    thread.join()\n"
    )
    settings = Path(__file__).parents[1] / "pyproject.toml"
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-c", settings, "--rootdir", tmp_path, test]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 1 and "PytestUnhandledThreadExceptionWarning" in done.stdout, done.stdout + done.stderr
