"""Results of sweeps in files: they are kept, whatever they are and however the sweep ends."""

import os
import re
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import costate
import numpy as np
import pytest
from conftest import pendulum
from test_sweep import picky, square

pyarrow = pytest.importorskip("pyarrow")
parquet = pytest.importorskip("pyarrow.parquet")


def test_results_in_a_file(tmp_path):
    path = tmp_path / "results.parquet"
    costate.sweep(picky, range(10), workers=2, parquet=path)
    rows = parquet.read_table(path).to_pylist()
    assert [row["index"] for row in rows] == list(range(10)) and rows[4]["square"] == 16 and rows[4]["pair"] == [4, -4]
    assert rows[3]["square"] is None and rows[3]["error"] == "ValueError: not 3"
    assert os.listdir(tmp_path) == ["results.parquet"]
    # What is there is not computed again; what failed is. Tasks can be added.
    seen = []
    again = costate.sweep(picky, range(12), workers=1, parquet=path, progress=seen.append)
    assert sorted(outcome.index for outcome in seen) == [3, 8, 10, 11]
    assert again[4].value == {"square": 16, "pair": [4, -4], "name": None} and again[5].value["name"] == "odd" and again[11].ok
    with pytest.raises(costate.ArgumentError, match="other tasks"):
        costate.sweep(picky, range(1, 9), workers=1, parquet=path)
    parquet.write_table(parquet.read_table(path).select(["square"]), tmp_path / "foreign.parquet")
    with pytest.raises(costate.ArgumentError, match="no file of a sweep"):
        costate.sweep(picky, range(3), workers=1, parquet=tmp_path / "foreign.parquet")


SLOW = """
import sys, time, costate
def slow(x):
    time.sleep(0.2)
    return x
if __name__ == "__main__":
    costate.sweep(slow, range(1000), workers=2, chunk=1, parquet=sys.argv[1])
"""


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no signal that kills")
@pytest.mark.parametrize("how", ["SIGINT", "SIGKILL"])
def test_an_interrupted_sweep_keeps_its_results(tmp_path, how):
    path, script = tmp_path / "slow.parquet", tmp_path / "slow.py"
    script.write_text(SLOW)
    process = subprocess.Popen([sys.executable, script, path], stderr=subprocess.DEVNULL, start_new_session=True)
    parts = tmp_path / "slow.parquet.parts"
    end = time.monotonic() + 60
    while not list(parts.glob("*.parquet")) and time.monotonic() < end:
        time.sleep(0.05)
    # Ctrl-C reaches all processes of a terminal.
    os.killpg(process.pid, getattr(signal, how))
    process.wait(30)
    if how == "SIGINT":
        found = parquet.read_table(path).to_pylist()
        assert not parts.exists()
    else:
        found = [row for part in sorted(parts.glob("*.parquet")) for row in parquet.read_table(part).to_pylist()]
        assert not path.exists()
    assert 0 < len(found) < 1000 and all(row["value"] == row["index"] for row in found)
    seen = []
    with ThreadPoolExecutor(4) as threads:
        outcomes = costate.sweep(square, range(1000), threads, parquet=path, progress=seen.append)
    done = {row["index"] for row in found}
    assert {outcome.index for outcome in seen} == set(range(1000)) - done
    assert [outcome.value for outcome in outcomes] == [k if k in done else k * k for k in range(1000)]
    assert not parts.exists()


@dataclass
class Task:
    names: frozenset
    size: int


def sampled(k):
    """Results that Arrow has no type for, or not one type."""
    samples = costate.Problem(pendulum(), start=[0.0], end=[0.3], time=1.0, cost=[1.0]).solve(threads=1).sample(rate=5.0)
    return [
        {"cost": 1.5, "none": None, "empty": {}, "deep": {"a": np.arange(2), "b": [np.float64(k)]}},
        {"cost": "text", "empty": {}, "deep": {"b": 1}, "samples": samples, 7: (1, np.int64(2))},
        {"value": 3, "complex": 1j, "large": 2**70, "name": "\udcff"},
        [1, {"a": {"b": ()}}, object],
        None,
        {},
    ][k]


def test_any_result_is_kept(tmp_path):
    path = tmp_path / "any.parquet"
    with ThreadPoolExecutor(2) as threads:
        first = costate.sweep(sampled, range(6), threads, parquet=path)
        assert all(outcome.ok for outcome in first) and first[4].value is None
        assert parquet.read_table(path).num_rows == 6 and os.listdir(tmp_path) == ["any.parquet"]
        seen = []
        again = [of.value for of in costate.sweep(sampled, range(6), threads, parquet=path, progress=seen.append)]
    assert seen == []
    # The keys are those of each result, with their values.
    assert again[0] == {"cost": 1.5, "none": None, "empty": {}, "deep": {"a": [0, 1], "b": [0.0]}}
    assert again[1].pop("samples") == repr(first[1].value["samples"])
    assert again[1] == {"cost": "text", "empty": {}, "deep": {"b": 1}, "7": [1, 2]}
    assert again[2] == {"value": 3, "complex": "1j", "large": 2**70, "name": "\udcff"}
    assert again[3] == [1, {"a": {"b": []}}, repr(object)] and again[4:] == [None, {}]


def test_a_file_that_cannot_be_written_loses_nothing(tmp_path):
    path = tmp_path / "results.parquet"
    path.with_name("results.parquet.parts").write_text("a file where the folder would be")
    with ThreadPoolExecutor(1) as threads, pytest.warns(RuntimeWarning, match="cannot be kept"):
        with pytest.warns(RuntimeWarning, match="cannot be written"):
            outcomes = costate.sweep(square, range(5), threads, parquet=path)
    assert [outcome.value for outcome in outcomes] == [0, 1, 4, 9, 16]


def test_parts_of_others_stay(tmp_path):
    path, parts = tmp_path / "results.parquet", tmp_path / "results.parquet.parts"
    parts.mkdir()
    (parts / ".DS_Store").touch()
    (parts / "0.new").touch()  # Of a process that was killed while it wrote.

    def other(x):
        """Another sweep writes while this one runs."""
        (parts / "00000000000000000000-1-0.parquet").write_bytes(b"of another process")
        return x

    with ThreadPoolExecutor(1) as threads:
        outcomes = costate.sweep(other, range(3), threads, parquet=path)
    assert all(outcome.ok for outcome in outcomes) and parquet.read_table(path).num_rows == 3
    assert sorted(os.listdir(parts)) == [".DS_Store", "00000000000000000000-1-0.parquet"]


def test_two_sweeps_at_once_write_one_file(tmp_path):
    path, inner = tmp_path / "results.parquet", []

    def slow(x):
        if x == 3:
            with ThreadPoolExecutor(1) as others:
                inner.extend(costate.sweep(square, range(5), others, parquet=path))
        return x

    with ThreadPoolExecutor(1) as threads:
        outcomes = costate.sweep(slow, range(4), threads, parquet=path)
    assert all(outcome.ok for outcome in outcomes + inner)
    assert [row["index"] for row in parquet.read_table(path).to_pylist()] == list(range(5))


def test_results_are_kept_while_none_comes(tmp_path):
    parts = tmp_path / "slow.parquet.parts"

    def waits(x):
        """The second task ends once the result of the first is kept."""
        end = time.monotonic() + 20
        while x and not list(parts.glob("*.parquet")) and time.monotonic() < end:
            time.sleep(0.05)
        return x == 0 or bool(list(parts.glob("*.parquet")))

    with ThreadPoolExecutor(1) as threads:
        outcomes = costate.sweep(waits, [0, 1], threads, chunk=1, parquet=tmp_path / "slow.parquet")
    assert [outcome.value for outcome in outcomes] == [True, True]


def test_what_has_come_before_an_interrupt_is_kept(tmp_path):
    path = tmp_path / "results.parquet"

    def stop(outcome):
        time.sleep(0.5)  # The others end.
        raise KeyboardInterrupt

    with ThreadPoolExecutor(4) as threads, pytest.raises(costate.Interrupted) as raised:
        costate.sweep(square, range(8), threads, chunk=1, parquet=path, progress=stop)
    assert [row["value"] for row in parquet.read_table(path).to_pylist()] == [k * k for k in range(8)]
    assert [outcome.value for outcome in raised.value.reached] == [k * k for k in range(8)]


def reserved(x):
    return {"index": 1} if x == 2 else {"place": x}


def test_a_result_with_a_name_of_the_file_is_the_error_of_its_task(tmp_path):
    path = tmp_path / "results.parquet"
    with ThreadPoolExecutor(1) as threads:
        outcomes = costate.sweep(reserved, range(6), threads, parquet=path)
    assert [outcome.index for outcome in outcomes if not outcome.ok] == [2] and outcomes[5].value == {"place": 5}
    error = outcomes[2].error
    assert isinstance(error, costate.ArgumentError) and "'index'" in str(error) and outcomes[2].attempts == 1
    assert "'index'" in parquet.read_table(path).to_pylist()[2]["error"]


class Mute(Exception):
    """Cannot say what it is."""

    def __str__(self):
        raise OSError("no words")

    __repr__ = __str__


def mute(x):
    if x == 1:
        raise Mute
    return [{"\udcff": 1}, None, Mute(), {"a": Mute()}][x]


def test_what_has_no_words_is_kept(tmp_path):
    path = tmp_path / "results.parquet"
    with ThreadPoolExecutor(1) as threads:
        outcomes = costate.sweep(mute, range(4), threads, parquet=path)
        again = costate.sweep(mute, range(4), threads, parquet=path)
    assert [outcome.ok for outcome in outcomes] == [True, False, True, True]
    assert [outcome.value for outcome in again] == [{"\\udcff": 1}, None, "<Mute>", {"a": "<Mute>"}]
    assert parquet.read_table(path).to_pylist()[1]["error"] == "Mute"


def test_files_that_are_no_sweeps_are_refused(tmp_path):
    junk, parts = tmp_path / "junk.parquet", tmp_path / "other.parquet.parts"
    junk.write_text("no Parquet")
    parts.mkdir()
    (parts / "0.parquet").touch()
    own = {"index": ["a"], "key": ["b"], "error": ["c"], "seconds": [1.0], "attempts": [1], "columns": ["d"]}
    parquet.write_table(pyarrow.table(own), tmp_path / "words.parquet")
    for name, words in [
        ("junk.parquet", "junk.parquet cannot be read"),
        ("other.parquet", "0.parquet cannot be read"),
        ("words.parquet", "no file of a sweep"),
        ("", "is a folder"),
    ]:
        with pytest.raises(costate.ArgumentError, match=words) as raised:
            costate.sweep(square, [1], parquet=tmp_path / name)
        assert raised.value.argument == "parquet"


def test_a_failure_does_not_replace_what_another_sweep_has_found(tmp_path):
    path = tmp_path / "results.parquet"

    def fails(x):
        with ThreadPoolExecutor(1) as others:
            costate.sweep(square, [3], others, parquet=path)
        raise ValueError(x)

    with ThreadPoolExecutor(1) as threads:
        (outcome,) = costate.sweep(fails, [3], threads, parquet=path)
        (again,) = costate.sweep(fails, [3], threads, parquet=path)
    assert not outcome.ok and again.value == 9


def test_no_task_makes_a_file_without_rows(tmp_path):
    assert costate.sweep(square, [], parquet=tmp_path / "none.parquet") == []
    assert parquet.read_table(tmp_path / "none.parquet").num_rows == 0 and os.listdir(tmp_path) == ["none.parquet"]


SETS = """
import costate, sys
from concurrent.futures import ThreadPoolExecutor
sys.path.insert(0, sys.argv[2])
from test_sweep_files import Task
tasks = [{"names": {"ann", "bob", "eve", "dan"}}, Task(frozenset(["one", "two", "three", "four"]), 3)]
seen = []
with ThreadPoolExecutor(1) as threads:
    costate.sweep(lambda task: 1, tasks, threads, parquet=sys.argv[1], progress=seen.append)
print(len(seen))
"""


def test_tasks_with_sets_are_found_again(tmp_path):
    found = []
    for seed in "123":
        command = [sys.executable, "-c", SETS, tmp_path / "sets.parquet", Path(__file__).parent]
        done = subprocess.run(command, capture_output=True, text=True, env=os.environ | {"PYTHONHASHSEED": seed})
        assert done.returncode == 0, done.stderr
        found.append(done.stdout.strip())
    assert found == ["2", "0", "0"]


def test_tasks_that_no_file_can_know_are_named(tmp_path):
    with pytest.raises(costate.ArgumentError, match="task 1 cannot be pickled") as raised:
        costate.sweep(square, [1, lambda: 2], parquet=tmp_path / "results.parquet")
    assert raised.value.argument == "tasks" and os.listdir(tmp_path) == []


def test_a_map_of_the_workspace_on_dask(monkeypatch, tmp_path, capsys):
    pytest.importorskip("distributed")
    pytest.importorskip("matplotlib")
    monkeypatch.syspath_prepend(Path(__file__).parents[1] / "examples")
    import workspace_map

    picture = tmp_path / "map.png"
    arguments = ["--grid", "3", "--dask", "--workers", "2", "--picture", str(picture)]
    monkeypatch.setattr(sys, "argv", ["workspace_map.py", *arguments])
    workspace_map.main()
    printed = capsys.readouterr().out
    away, solved = map(int, re.match(r"9 places, (\d) of them out of reach, (\d) motions solved", printed).groups())
    assert 0 < solved <= 9 - away and away > 0
    # The corner of the grid near the base costs what it costs here.
    assert workspace_map.least_effort((0.05, 0.2, -0.2))["status"] == "converged"
    assert picture.read_bytes().startswith(b"\x89PNG")
