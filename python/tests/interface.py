"""The public interface: what there is, what each callable says about itself, and what the tests have called."""

from __future__ import annotations

import ast
import functools
import importlib
import importlib.util
import inspect
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import costate

FRIENDS = ("casadi", "crocoddyl", "jax", "scipy", "torch")
# Methods with a package that they use.
NEEDS = {
    "Samples.to_dataframe": "pandas",
    "Solution.plot": "matplotlib",
    "Solution.to_dataframe": "pandas",
    "Solution.to_viser": "viser",
    "scipy.Transcription.ipopt": "cyipopt",
}


def modules() -> list[ModuleType]:
    """The package, and those of its modules whose packages are installed."""
    found = [costate]
    for name in FRIENDS:
        try:
            found.append(importlib.import_module(f"costate.{name}"))
        except ImportError:
            continue
    return found


def public() -> Iterator[tuple[str, Any, Any]]:
    """Public functions and classes, and the public attributes of these: name, owner, object."""
    for module in modules():
        names = getattr(module, "__all__")
        for name in names:
            thing = getattr(module, name)
            full = name if module is costate else f"{module.__name__[8:]}.{name}"
            yield full, module, thing
            if not inspect.isclass(thing):
                continue
            for base in thing.__mro__:
                if not base.__module__.startswith("costate"):
                    continue
                for part, own in vars(base).items():
                    if not part.startswith("_"):
                        yield f"{full}.{part}", base, own


def written() -> set[str]:
    """Public classes, functions, methods and fields as the sources have them, also of modules whose packages are not
    installed: their names alone. ``costate.__all__`` says which of the package are public."""
    folder = Path(costate.__file__).parent
    classes: dict[str, ast.ClassDef] = {}
    found = set(costate.__all__) - {"__version__"}
    for path in [*folder.glob("*.py"), *folder.glob("*/__init__.py"), folder / "_costate.pyi"]:
        body = ast.parse(path.read_text(encoding="utf-8")).body
        classes |= {node.name: node for node in body if isinstance(node, ast.ClassDef)}
        if (path.parent.name if path.name == "__init__.py" else path.stem) in FRIENDS:
            named = (node.name for node in body if isinstance(node, (ast.ClassDef, ast.FunctionDef)))
            found |= {name for name in named if not name.startswith("_")}
    # With the classes that public ones are made of.
    of = [classes[name] for name in found if name in classes]
    for node in of:
        bases = [classes[base.id] for base in node.bases if isinstance(base, ast.Name) and base.id in classes]
        of.extend(base for base in bases if base not in of)
    for part in (part for node in of for part in node.body):
        if isinstance(part, ast.FunctionDef):
            found.add(part.name)
        elif isinstance(part, ast.AnnAssign) and isinstance(part.target, ast.Name):
            found.add(part.target.id)
    return {name for name in found if not name.startswith("_")}


def function_of(thing: Any) -> Any:
    """The function of a static method or of one of the class."""
    return thing.__func__ if isinstance(thing, (staticmethod, classmethod)) else thing


def returns() -> dict[str, str]:
    """What compiled functions and methods return, from their stub: by their names."""
    found = {}
    for node in ast.parse((Path(costate.__file__).parent / "_costate.pyi").read_text()).body:
        if isinstance(node, ast.FunctionDef):
            found[node.name] = ast.unparse(node.returns) if node.returns else "None"
        if isinstance(node, ast.ClassDef):
            for part in node.body:
                if isinstance(part, ast.FunctionDef):
                    found[f"{node.name}.{part.name}"] = ast.unparse(part.returns) if part.returns else "None"
    return found


def sections(text: str) -> dict[str, list[str]]:
    """The entries of each section of a docstring in the style of numpydoc: lines that are not indented."""
    found: dict[str, list[str]] = {}
    name = ""
    lines = inspect.cleandoc(text).splitlines()
    for k, line in enumerate(lines):
        if k + 1 < len(lines) and lines[k + 1] and set(lines[k + 1]) == {"-"} and len(lines[k + 1]) == len(line):
            name = line
            found[name] = []
        elif name and line and not line.startswith(" ") and set(line) != {"-"}:
            found[name].append(line)
    return found


def documented(entries: list[str]) -> set[str]:
    """The names that the entries of a section are about."""
    return {name.strip().lstrip("*") for entry in entries for name in entry.split(" : ")[0].split(",")}


def arguments(thing: Any) -> list[inspect.Parameter] | None:
    """The arguments of a callable without that of the object; None where it has no signature."""
    try:
        parameters = list(inspect.signature(function_of(thing)).parameters.values())
    except (TypeError, ValueError):
        return None
    return [parameter for parameter in parameters if parameter.name not in ("self", "cls", "slf")]


class Recorder:
    """Notes which functions, methods and properties are called, and which classes are made or met.

    A recorder stands in the place of each of them until it is called for the first time: nothing is slower afterwards.
    """

    def __init__(self) -> None:
        self.all: set[str] = set()
        self.called: set[str] = set()

    def install(self) -> None:
        for name, owner, thing in list(public()):
            if name.endswith("__version__") or isinstance(thing, type):
                continue
            if isinstance(thing, property) or inspect.isgetsetdescriptor(thing):
                self._replace(name, owner, thing, self._property)
            elif isinstance(thing, functools.cached_property):
                self._replace(name, owner, thing, self._property)
            elif callable(function_of(thing)):
                self._replace(name, owner, thing, self._method)

    def _replace(self, name: str, owner: Any, thing: Any, make: Callable[..., Any]) -> None:
        part = name.rsplit(".", 1)[-1]
        # A method of a base class counts once, with the first class that has it.
        try:
            setattr(owner, part, make(name, owner, part, thing))
        except (AttributeError, TypeError):
            return
        self.all.add(name)

    def _note(self, name: str, owner: Any, part: str, thing: Any) -> None:
        self.called.add(name)
        setattr(owner, part, thing)

    def _method(self, name: str, owner: Any, part: str, thing: Any) -> Any:
        function = function_of(thing)

        @functools.wraps(function)
        def first(*given: Any, **named: Any) -> Any:
            self._note(name, owner, part, thing)
            return function(*given, **named)

        return type(thing)(first) if isinstance(thing, (staticmethod, classmethod)) else first

    def _property(self, name: str, owner: Any, part: str, thing: Any) -> Any:
        def first(of: Any) -> Any:
            self._note(name, owner, part, thing)
            return thing.__get__(of, type(of))

        return property(first, doc=inspect.getdoc(thing))

    def missing(self) -> list[str]:
        """What was not called, without what needs a package that is not installed."""
        needs = {name for name, package in NEEDS.items() if importlib.util.find_spec(package) is None}
        return sorted(self.all - self.called - needs)

    def summary(self) -> str:
        missing = self.missing()
        text = f"public interface: {len(self.called)} of {len(self.all)} functions, methods and properties called"
        return text + (f"; not called: {', '.join(missing)}" if 0 < len(missing) < 40 else "")
