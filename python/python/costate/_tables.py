"""Nested dictionaries as the text of a problem file."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from os import PathLike, fspath
from typing import Any

from ._errors import ProblemError

# What a number or a list stands for, where a table can be given.
_SHORT = {"start": "q", "end": "q", "cost": "effort", "time": "final", "periodic": "shift", "actuation": "gain"}
_TABLES = (
    *("robot", "start", "end", "via", "periodic", "gait", "time", "cost", "actuation", "bounds", "limits"),
    *("penalty", "keep", "obstacle", "collision", "start_from", "solver"),
)


def text_of(tables: Mapping[str, Any]) -> str:
    """Write dictionaries, lists, numbers, texts and truth values as TOML; arrays count as lists, None as not given.

    >>> text_of({"time": {"final": 1.0}, "end": {"q": [1, float("inf")]}})
    'time = {final = 1.0}\\nend = {q = [1, inf]}\\n'
    """
    return "".join(f"{_key(name)} = {_value(value, name)}\n" for name, value in tables.items() if value is not None)


def _key(name: object) -> str:
    if not isinstance(name, str):
        raise ProblemError(f"the key {name!r} is not a text; give the names of tables and keys, which help(costate.Problem) lists")
    plain = name.isascii() and name.replace("_", "a").replace("-", "a").isalnum()
    return name if plain else json.dumps(name)


def _value(value: object, path: str) -> str:
    if hasattr(value, "tolist"):  # arrays and numbers of NumPy
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return repr(value) if math.isfinite(value) else {math.inf: "inf", -math.inf: "-inf"}.get(value, "nan")
    if isinstance(value, PathLike):
        value = fspath(value)
    if isinstance(value, str):
        return json.dumps(value)
    if isinstance(value, Mapping):
        inner = (f"{_key(name)} = {_value(of, f'{path}.{name}')}" for name, of in value.items() if of is not None)
        return "{" + ", ".join(inner) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_value(entry, path) for entry in value) + "]"
    error = ProblemError(
        f"{path}: a {type(value).__name__} is no value of a problem; give numbers, texts, truth values, lists, arrays "
        "and dictionaries"
    )
    error.key = path
    raise error


def table_of(name: str, value: Any) -> Any:
    """A table, where a number or a list stood for it."""
    if name not in _TABLES:
        error = ProblemError(f"{name}: unknown key; the keys here are {', '.join(_TABLES)}")
        error.key = name
        raise error
    if isinstance(value, bool) and name == "limits":
        return {"from_robot": value}
    if isinstance(value, bool) and name == "periodic":
        return {} if value else None
    if name in _SHORT and not isinstance(value, Mapping):
        return {_SHORT[name]: value}
    return value
