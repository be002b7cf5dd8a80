"""What is said about the public interface is said of all of it."""

import re
from pathlib import Path

import costate
from interface import FRIENDS, Recorder, public, written

ROOT = Path(__file__).parents[2]


class Thing:
    """Stands for a class of the package."""

    def method(self, number: int = 1) -> int:
        return number

    @classmethod
    def of_class(cls) -> type:
        return cls

    @staticmethod
    def static() -> int:
        return 3

    @property
    def number(self) -> int:
        return 4


def test_calls_are_recorded_once_and_change_nothing(monkeypatch):
    before = dict(vars(Thing))
    recorder = Recorder()
    listed = [(f"Thing.{name}", Thing, of) for name, of in before.items() if not name.startswith("_")]
    monkeypatch.setattr("interface.public", lambda: listed)
    recorder.install()
    assert recorder.missing() == ["Thing.method", "Thing.number", "Thing.of_class", "Thing.static"]
    assert vars(Thing)["method"] is not before["method"]
    assert (Thing().method(2), Thing.of_class(), Thing.static(), Thing().number) == (2, Thing, 3, 4)
    assert not recorder.missing() and dict(vars(Thing)) == before
    assert recorder.summary() == "public interface: 4 of 4 functions, methods and properties called"


def test_all_classes_are_looked_into():
    names = {name for name, _, _ in public()}
    assert {"Dynamics.f", "Step.hvp", "Frame.pose", "Robot.lock", "Resolve.set_start", "Solution.save", "check"} <= names
    assert len([name for name in names if "." in name]) > 150 and not [name for name in names if "._" in name]
    assert set(costate.__all__) <= names


def test_every_public_name_is_used_by_a_test_or_an_example():
    """Of modules whose packages are not installed too; what tests call is recorded where they are."""
    names = written()
    assert {"Dynamics", "contract", "Model", "step", "ActionModel", "ipopt", "set_via", "left_out"} <= names
    files = [*ROOT.glob("python/tests/*.py"), *ROOT.glob("python/examples/*.py"), *ROOT.glob("docs/**/*.md")]
    text = "\n".join(path.read_text(encoding="utf-8") for path in files)
    used = set(re.findall(r"(?<![A-Za-z0-9])[A-Za-z][A-Za-z0-9_]*", text))
    assert sorted(names - used) == []
    assert all(f"costate.{name}" in text for name in FRIENDS)
