"""The programs of `python/examples`: each checks its own result; here they run, where their packages are installed."""

import ast
import runpy
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[1] / "examples"
PROGRAMS = sorted(EXAMPLES.glob("*.py"))
# What they are given here; the rest runs as it is.
ARGUMENTS = {"workspace_map": ["--grid", "3", "--workers", "2"]}
OWN = {path.stem for path in PROGRAMS} | {"costate", "pathlib"}


def packages(path: Path) -> set[str]:
    """What a program imports, itself or by the module of costate that it uses."""
    names = {
        alias.name
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Import)
        for alias in node.names
    }
    own = {name.removeprefix("costate.") for name in names if name.startswith("costate.")}
    return own | {name.split(".")[0] for name in names} - OWN


def test_there_is_a_program_for_each_friend():
    friends = set().union(*map(packages, PROGRAMS))
    assert {"casadi", "crocoddyl", "jax", "scipy", "torch"} <= friends


def test_the_page_of_examples_names_all_of_them():
    page = (EXAMPLES / "README.md").read_text()
    assert [path.name for path in PROGRAMS if f"]({path.name})" not in page] == []


@pytest.mark.filterwarnings("ignore::costate.RobotWarning")
@pytest.mark.parametrize("path", PROGRAMS, ids=lambda path: path.stem)
def test_program(path, monkeypatch, capsys):
    for name in packages(path):
        pytest.importorskip(name)
    monkeypatch.syspath_prepend(str(EXAMPLES))
    monkeypatch.setattr("sys.argv", [str(path), *ARGUMENTS.get(path.stem, ())])
    runpy.run_path(str(path), run_name="__main__")
    assert capsys.readouterr().out
