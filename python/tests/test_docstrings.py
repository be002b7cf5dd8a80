"""Docstrings: each argument and each result is described, examples run."""

import doctest
import importlib
import inspect
import pkgutil
import re

import costate
import pytest
from interface import arguments, documented, function_of, modules, public, returns, sections

# Made by other methods alone: their attributes are described.
MADE_BY_OTHERS = {"Branch", "Feedback", "Gains", "Samples"}


def test_sections_are_found():
    text = """One line.

    Parameters
    ----------
    a, b : int
        Two of them.
    **options
        Others.

    Returns
    -------
    int
        A number.
    """
    found = sections(text)
    assert documented(found["Parameters"]) == {"a", "b", "options"} and found["Returns"] == ["int"]
    assert [parameter.name for parameter in arguments(costate.Dynamics.contract)] == ["q", "v", "tau", "y", "out"]
    assert returns()["Dynamics.f"] == "_Array" and returns()["_Run.cancel"] == "None"


def wanting():
    """What public callables do not say."""
    compiled, count = returns(), 0
    for name, _, thing in public():
        made = inspect.isclass(thing)
        if not (made or callable(thing) or isinstance(thing, (staticmethod, classmethod))):
            continue
        if made and (name in MADE_BY_OTHERS or issubclass(thing, BaseException) and "__init__" not in vars(thing)):
            continue
        # Their fields are attributes, which are described as such.
        fields = hasattr(thing, "_fields") or hasattr(thing, "__dataclass_fields__")
        given = arguments(thing)
        if given is None:
            yield name, "no signature"
            continue
        if not given:
            continue
        count += 1
        function = function_of(thing)
        found = sections(inspect.getdoc(function) or "")
        described = documented(found.get("Parameters", []) + (found.get("Attributes", []) if fields else []))
        missing = [parameter.name for parameter in given if parameter.name not in described]
        if missing:
            yield name, f"arguments {missing}"
        annotation = compiled.get(name) or getattr(function, "__annotations__", {}).get("return", "None")
        if not made and annotation not in ("None", None) and not found.get("Returns"):
            yield name, "result"
        if made and not fields and not inspect.getdoc(thing):
            yield name, "docstring"
    assert count > 100


def test_arguments_and_results_are_described():
    assert not [f"{name}: {what}" for name, what in wanting()]


@pytest.mark.parametrize("module", modules(), ids=lambda module: module.__name__)
def test_examples_of_public_names(module):
    runner, parser, found = doctest.DocTestRunner(), doctest.DocTestParser(), 0
    texts = {module.__name__: module.__doc__}
    own = "" if module is costate else f"{module.__name__[8:]}."
    if own:
        pytest.importorskip(own[:-1])
    texts |= {name: inspect.getdoc(function_of(thing)) for name, _, thing in public() if name.startswith(own)
              and (own or name.split(".")[0] in costate.__all__)}  # fmt: skip
    for name, text in texts.items():
        test = parser.get_doctest(text or "", {}, name, None, 0)
        found += bool(test.examples)
        runner.run(test)
    assert runner.failures == 0 and (found or module.__name__ == "costate.crocoddyl")


def test_examples_of_private_modules():
    for module in pkgutil.iter_modules(costate.__path__):
        if module.name.startswith("_") and module.name != "_costate":
            assert doctest.testmod(importlib.import_module(f"costate.{module.name}")).failed == 0


def test_docstrings_name_no_files_that_the_package_does_not_carry():
    names = [
        (name, word)
        for name, _, thing in public()
        for word in re.findall(r"[\w./-]+\.(?:md|rst|ipynb)\b", inspect.getdoc(function_of(thing)) or "")
    ]
    assert not names
