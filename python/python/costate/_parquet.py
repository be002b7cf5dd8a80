"""A file of results that survives interruptions."""

from __future__ import annotations

import hashlib
import io
import os
import pickle
import time
from pathlib import Path
from typing import Any

from ._errors import ArgumentError, argument_error
from ._outcomes import Outcome

# Seconds after which new results are kept.
_PAUSE = 2.0
_OWN = ("index", "key", "error", "seconds", "attempts")


class Table:
    """Results of a sweep in a Parquet file.

    New ones go into files of a folder beside it, each of which is written under another name first; the file itself is
    made of them at the end in the same way. At every time a reader finds whole files.
    """

    def __init__(self, path: str, tasks: list[Any]) -> None:
        try:
            import pyarrow  # noqa: F401
            import pyarrow.parquet  # noqa: F401
        except ImportError as error:
            raise ImportError("parquet= needs pyarrow: pip install pyarrow") from error
        self.path, self.parts = Path(path), Path(f"{path}.parts")
        self.tasks, self.keys = tasks, [_key(task) for task in tasks]
        self.new: list[dict[str, Any]] = []
        self.kept = time.monotonic()
        self.number = 0
        self.rows = self._read()

    def _read(self) -> dict[int, dict[str, Any]]:
        """What was found before, by task."""
        from pyarrow import parquet

        rows: dict[int, dict[str, Any]] = {}
        parts = sorted(self.parts.glob("*.parquet"))
        self.number = len(parts)
        for file in ([self.path] if self.path.exists() else []) + parts:
            table = parquet.read_table(file)
            if not set(_OWN) <= set(table.column_names):
                raise self._wrong(f"{file} is no file of a sweep")
            # Nulls are keys that the result of this task does not have.
            for row in table.to_pylist():
                if row["index"] >= len(self.keys) or row["key"] != self.keys[row["index"]]:
                    raise self._wrong(f"{file} has results of other tasks")
                rows[row["index"]] = {name: value for name, value in row.items() if value is not None}
        return rows

    def _wrong(self, what: str) -> ArgumentError:
        return argument_error("parquet", f"{what}; give another path, or remove it")

    def known(self) -> dict[int, Outcome]:
        """The tasks that need not be computed again."""
        found = {}
        for index, row in self.rows.items():
            if "error" not in row:
                value: Any = {name: of for name, of in row.items() if name not in _OWN}
                value = value.get("value") if set(value) <= {"value"} else value
                figures = row.get("seconds", float("nan")), row["attempts"]
                found[index] = Outcome(index, self.tasks[index], value, None, "", *figures)
        return found

    def add(self, outcome: Outcome) -> None:
        """One more result."""
        value = outcome.value
        row = {str(name): _plain(of) for name, of in value.items()} if isinstance(value, dict) else {"value": _plain(value)}
        clash = [name for name in row if name in _OWN]
        if clash:
            raise argument_error("function", f"a result has the key {clash[0]!r}, which parquet= uses; rename it")
        error = outcome.error
        row |= {"index": outcome.index, "key": self.keys[outcome.index], "seconds": outcome.seconds}
        row |= {"attempts": outcome.attempts, "error": None if error is None else f"{type(error).__name__}: {error}"}
        self.new.append({name: of for name, of in row.items() if of is not None})
        if time.monotonic() - self.kept > _PAUSE:
            self._keep()

    def _keep(self) -> None:
        if self.new:
            self.parts.mkdir(exist_ok=True, parents=True)
            _write(self.parts / f"{self.number:06}.parquet", self.new)
            self.number += 1
            self.rows.update((row["index"], row) for row in self.new)
            self.new = []
        self.kept = time.monotonic()

    def close(self) -> None:
        """Makes the file of all results."""
        self._keep()
        if self.number:
            _write(self.path, [self.rows[index] for index in sorted(self.rows)])
            for part in self.parts.glob("*.parquet"):
                part.unlink()
            self.parts.rmdir()
            self.number = 0


def _write(path: Path, rows: list[dict[str, Any]]) -> None:
    """Replaces a file."""
    import pyarrow
    from pyarrow import parquet

    others = sorted({name for row in rows for name in row} - set(_OWN))
    columns = {name: pyarrow.array([row.get(name) for row in rows]) for name in ("index", "key", "seconds", "attempts")}
    columns["error"] = pyarrow.array([row.get("error") for row in rows], pyarrow.string())
    columns |= {name: pyarrow.array([row.get(name) for row in rows]) for name in others}
    new = path.with_name(f"{path.name}.new")
    with open(new, "wb") as file:
        parquet.write_table(pyarrow.table(columns), file)
        file.flush()
        os.fsync(file.fileno())
    os.replace(new, path)


def _plain(value: Any) -> Any:
    """Arrays and numbers of NumPy as lists and numbers."""
    return value.tolist() if hasattr(value, "tolist") else value


def _key(task: Any) -> str:
    """A digest of a task: equal for equal numbers, whichever objects they are."""
    text = io.BytesIO()
    pickler = pickle.Pickler(text, 4)
    pickler.fast = True  # Without references to what was pickled before.
    pickler.dump(task)
    return hashlib.sha256(text.getvalue()).hexdigest()[:16]
