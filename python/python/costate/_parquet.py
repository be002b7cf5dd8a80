"""A file of results that survives interruptions."""

from __future__ import annotations

import dataclasses
import hashlib
import io
import json
import os
import pickle
import time
import warnings
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any
from uuid import uuid4

from ._errors import ArgumentError, argument_error
from ._outcomes import Outcome, said

# Seconds after which new results are kept.
_PAUSE = 2.0
_OWN = ("index", "key", "error", "seconds", "attempts", "columns")
# Marks columns whose values are JSON text.
_JSON = {b"costate": b"json"}


class Table:
    """Results of a sweep in a Parquet file.

    New ones go into files of a folder beside it, each of which is written under another name first; the file itself is
    made of them at the end in the same way. At every time a reader finds whole files. Other processes may write there
    too: names are unique, and only what this one has written or read is removed.
    """

    def __init__(self, path: str, tasks: list[Any]) -> None:
        try:
            import pyarrow  # noqa: F401
            import pyarrow.parquet  # noqa: F401
        except ImportError as error:
            raise ImportError("parquet= needs pyarrow: pip install pyarrow") from error
        self.path, self.parts = Path(path), Path(f"{path}.parts")
        if self.path.is_dir():
            raise argument_error("parquet", f"{path or 'the empty path'} is a folder; give the path of a file")
        self.tasks, self.keys = tasks, [_task_key(index, task) for index, task in enumerate(tasks)]
        self.new: list[dict[str, Any]] = []
        self.kept = time.monotonic()
        # What is removed at the end, with what a process has left that was killed while it wrote.
        self.used, self.changed = sorted(self.parts.glob("*.new")), False
        self.rows: dict[int, dict[str, Any]] = {}
        parts = sorted(self.parts.glob("*.parquet"))
        for file in ([self.path] if self.path.exists() else []) + parts:
            self.rows |= {row["index"]: row for row in self._read(file)}
        self.used += parts

    def _read(self, file: Path, longer: bool = False) -> Iterator[dict[str, Any]]:
        """The rows of a file, which may have more tasks if so."""
        import pyarrow
        from pyarrow import parquet

        try:
            table = parquet.read_table(file)
        except FileNotFoundError:
            return  # Another process has just made the file of its parts.
        except (pyarrow.ArrowException, OSError) as error:
            raise self._wrong(f"{file} cannot be read as Parquet ({error})") from None
        if not set(_OWN) <= set(table.column_names):
            raise self._wrong(f"{file} is no file of a sweep")
        texts = [field.name for field in table.schema if _JSON.items() <= (field.metadata or {}).items()]
        for row in table.to_pylist():
            try:
                more = row["index"] >= len(self.keys)
                other = not longer if more else row["index"] < 0 or row["key"] != self.keys[row["index"]]
                row |= {name: json.loads(row[name]) for name in texts if row[name] is not None}
            except (TypeError, ValueError):
                raise self._wrong(f"{file} is no file of a sweep") from None
            if other:
                raise self._wrong(f"{file} has results of other tasks")
            yield row

    def _wrong(self, what: str) -> ArgumentError:
        return argument_error("parquet", f"{what}; give another path, or remove it")

    def known(self) -> dict[int, Outcome]:
        """The tasks that need not be computed again."""
        found = {}
        for index, row in self.rows.items():
            if row["error"] is None:
                names = row["columns"]
                value = row.get("value") if names is None else {name: row.get(name) for name in names}
                found[index] = Outcome(index, self.tasks[index], value, None, "", row["seconds"], row["attempts"])
        return found

    def add(self, outcome: Outcome) -> Outcome:
        """One more result, or the error of a task whose result has no place here."""
        value = _kept(outcome.value)
        clash = [name for name in value if name in _OWN] if isinstance(value, dict) else []
        if clash:
            error = argument_error("function", f"a result has the key {clash[0]!r}, which parquet= uses; rename it")
            outcome, value = replace(outcome, value=None, error=error), None
        named = isinstance(value, dict)
        row = dict(value) if named else {"value": value}
        row |= {"index": outcome.index, "key": self.keys[outcome.index], "seconds": outcome.seconds}
        row |= {"attempts": outcome.attempts, "columns": list(value) if named else None}
        row["error"] = None if outcome.error is None else _written(said(outcome.error))
        self.rows[outcome.index] = row
        self.new.append(row)
        self.tick()
        return outcome

    def tick(self) -> None:
        """Keeps what is new when it is time to."""
        if time.monotonic() - self.kept > _PAUSE:
            self._keep()

    def _keep(self) -> None:
        self.kept = time.monotonic()
        if self.new:
            part = self.parts / f"{time.time_ns():020}-{os.getpid()}-{uuid4().hex}.parquet"
            try:
                self._write(part, self.new)
            except Exception as error:  # Tried again later: the results are what counts.
                warnings.warn(f"results cannot be kept in {part} ({error})", RuntimeWarning, stacklevel=2)
                return
            self.used.append(part)
            self.new, self.changed = [], True

    def close(self) -> None:
        """Makes the file of all results."""
        self._keep()
        if not (self.changed or self.new or self.used) and self.path.exists():
            return
        try:
            if self.path.exists():
                # Another process may have written it since.
                for row in self._read(self.path, True):
                    own = self.rows.get(row["index"])
                    if own is None or (own["error"] is not None and row["error"] is None):
                        self.rows[row["index"]] = row
            self._write(self.path, [self.rows[index] for index in sorted(self.rows)])
        except Exception as error:
            text = f"{self.path} cannot be written ({error}); what was kept is in {self.parts}, where the same call finds it"
            warnings.warn(text, RuntimeWarning, stacklevel=3)
            return
        for part in self.used:
            part.unlink(missing_ok=True)
        try:
            self.parts.rmdir()
        except OSError:
            pass  # It has files of others.

    def _write(self, path: Path, rows: list[dict[str, Any]]) -> None:
        """Replaces a file."""
        import pyarrow
        from pyarrow import parquet

        self.parts.mkdir(exist_ok=True, parents=True)
        new = self.parts / f"{uuid4().hex}.new"
        try:
            with open(new, "wb") as file:
                parquet.write_table(pyarrow.table(*_columns(rows)), file)
                file.flush()
                os.fsync(file.fileno())
            os.replace(new, path)
        finally:
            new.unlink(missing_ok=True)


def _columns(rows: list[dict[str, Any]]) -> tuple[list[Any], Any]:
    """Arrays of Arrow and their schema."""
    import pyarrow

    types = {"index": pyarrow.int64(), "key": pyarrow.string(), "seconds": pyarrow.float64()}
    types |= {"attempts": pyarrow.int64(), "error": pyarrow.string(), "columns": pyarrow.list_(pyarrow.string())}
    arrays = [pyarrow.array([row[name] for row in rows], of) for name, of in types.items()]
    fields = [pyarrow.field(name, of) for name, of in types.items()]
    for name in sorted({name for row in rows for name in row} - set(_OWN)):
        values, marks = [row.get(name) for row in rows], None
        try:
            array = pyarrow.array(values)
            # Structs have all keys in all rows, and without keys they cannot be written.
            typed = "struct<" not in str(array.type)
        except Exception:  # Of many kinds: no such type, several types, too large.
            typed = False
        if not typed:
            texts = [None if value is None else json.dumps(value, default=_words) for value in values]
            array, marks = pyarrow.array(texts, pyarrow.string()), _JSON
        arrays.append(array)
        fields.append(pyarrow.field(name, array.type, metadata=marks))
    return arrays, pyarrow.schema(fields)


def _kept(value: Any) -> Any:
    """What a file keeps of a result."""
    try:
        return _plain(value)
    except Exception:  # It contains itself, is too deep, or cannot be copied.
        return _written(_words(value))


def _plain(value: Any) -> Any:
    """Arrays and numbers of NumPy as lists and numbers, keys as text."""
    if hasattr(value, "tolist") and not isinstance(value, type):
        value = value.tolist()
    if isinstance(value, dict):
        return {_written(str(name)): _plain(of) for name, of in value.items()}
    if isinstance(value, (list, tuple, set, frozenset)):
        return [_plain(of) for of in value]
    return value


def _words(value: object) -> str:
    try:
        return repr(value)
    except Exception:
        return f"<{type(value).__name__}>"


def _written(text: str) -> str:
    """The same in characters that a file can have."""
    return text.encode("utf-8", "backslashreplace").decode()


def _task_key(index: int, task: Any) -> str:
    try:
        return _key(task)
    except Exception as error:
        raise argument_error(
            "tasks",
            f"task {index} cannot be pickled ({said(error)}), so its result cannot be found again in a file; give tasks of "
            "numbers, text and arrays, or leave out parquet=",
        ) from None


def _key(task: Any) -> str:
    """A digest of a task: equal for equal numbers, whichever objects they are."""
    text = io.BytesIO()
    pickler = pickle.Pickler(text, 4)
    pickler.fast = True  # Without references to what was pickled before.
    pickler.dump(_ordered(task))
    return hashlib.sha256(text.getvalue()).hexdigest()[:16]


def _ordered(task: Any) -> Any:
    """The same with sets in an order that all processes have: that of text in a set changes with each."""
    if isinstance(task, (set, frozenset)):
        return "set", tuple(sorted(_key(of) for of in task))
    if type(task) in (list, tuple):
        return type(task)(_ordered(of) for of in task)
    if isinstance(task, tuple) and type(task).__reduce__ is object.__reduce__:
        return type(task).__qualname__, tuple(_ordered(of) for of in task)
    if type(task) is dict:
        return {_ordered(name): _ordered(of) for name, of in task.items()}
    own = dataclasses.is_dataclass(task) and not isinstance(task, type) and type(task).__reduce__ is object.__reduce__
    if own and hasattr(task, "__dict__"):
        return type(task).__qualname__, _ordered(vars(task))
    return task
