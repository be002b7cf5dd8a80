"""Many tasks on processes, threads and Dask: nothing is lost."""

import os
import pickle
import re
import signal
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import costate
import numpy as np
import pytest
from conftest import pendulum


def square(x):
    return x * x


def picky(x):
    if x % 5 == 3:
        raise ValueError(f"not {x}")
    return {"square": x * x, "pair": np.array([x, -x]), "name": "odd" if x % 2 else None}


def least_effort(q):
    """J of a pendulum that is led to q."""
    cost = costate.Problem(pendulum(), start=[0.0], end=[q], time=1.0, cost=[1.0]).solve(threads=1).check().cost
    return {"q": q, "cost": cost}


def killed_once(task):
    """Kills its own process the first time."""
    number, mark = task
    if number == 7 and not os.path.exists(mark):
        Path(mark).touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def killed_always(number):
    if number == 5:
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def third_time(path):
    """Fails twice."""
    with open(path, "a") as file:
        file.write("x")
    if os.path.getsize(path) < 3:
        raise OSError("not yet")
    return "done"


def lambda_of(x):
    return lambda: x


class NoPickle(Exception):
    def __init__(self, a, b):
        super().__init__(a)


def hard_to_send(x):
    raise NoPickle(x, x)


def test_results_come_in_order_from_a_pool():
    outcomes = costate.sweep(square, range(50), workers=2, chunk=3)
    assert [outcome.value for outcome in outcomes] == [x * x for x in range(50)]
    assert [outcome.index for outcome in outcomes] == list(range(50))
    assert all(outcome.ok and outcome.attempts == 1 and outcome.seconds >= 0 for outcome in outcomes)
    assert costate.sweep(square, []) == []


def test_failed_tasks_have_their_error():
    seen = []
    outcomes = costate.sweep(picky, range(10), workers=2, progress=seen.append)
    assert [outcome.index for outcome in outcomes if not outcome.ok] == [3, 8]
    assert isinstance(outcomes[3].error, ValueError) and str(outcomes[3].error) == "not 3"
    assert "in picky" in outcomes[3].traceback and outcomes[3].task == 3
    assert sorted(outcome.index for outcome in seen) == list(range(10))


def test_tasks_are_tried_again(tmp_path):
    (outcome,) = costate.sweep(third_time, [str(tmp_path / "count")], workers=1, retries=2)
    assert (outcome.value, outcome.attempts) == ("done", 3)
    (outcome,) = costate.sweep(third_time, [str(tmp_path / "other")], workers=1, retries=1)
    assert isinstance(outcome.error, OSError) and outcome.attempts == 2


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no signal that kills")
def test_nothing_is_lost_when_a_worker_is_killed(tmp_path):
    mark = tmp_path / "killed"
    outcomes = costate.sweep(killed_once, [(k, str(mark)) for k in range(40)], workers=2, chunk=4)
    assert mark.exists() and [outcome.value for outcome in outcomes] == list(range(40))


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no signal that kills")
def test_a_task_that_kills_its_worker_is_the_only_one_that_fails():
    outcomes = costate.sweep(killed_always, range(20), workers=2, chunk=4)
    assert [outcome.value for outcome in outcomes] == [k if k != 5 else None for k in range(20)]
    assert isinstance(outcomes[5].error, costate.WorkerDied) and outcomes[5].attempts == 3
    # A pool of the caller is not made again: what it has not computed says so.
    with ProcessPoolExecutor(1) as pool:
        outcomes = costate.sweep(killed_always, range(20), pool, chunk=4)
    assert [outcome.value for outcome in outcomes[:4]] == [0, 1, 2, 3]
    assert not any(outcome.ok for outcome in outcomes[4:])


def test_what_cannot_be_sent_is_said():
    with pytest.raises(costate.ArgumentError, match="top of a module") as raised:
        costate.sweep(lambda x: x, [1], workers=1)
    assert raised.value.argument == "function"
    outcomes = costate.sweep(square, [1, lambda: 2, 3], workers=1)
    assert [outcome.value for outcome in outcomes] == [1, None, 9] and "cannot be pickled" in str(outcomes[1].error)
    (outcome,) = costate.sweep(lambda_of, [1], workers=1)
    assert "result cannot be pickled" in str(outcome.error)
    (outcome,) = costate.sweep(hard_to_send, [1], workers=1)
    assert "NoPickle" in str(outcome.error)
    with pytest.raises(costate.ArgumentError, match="chunk is 0"):
        costate.sweep(square, [1], chunk=0)


def test_a_script_without_its_guard_is_told(tmp_path):
    script = tmp_path / "script.py"
    script.write_text("import costate, math\nprint([of.value for of in costate.sweep(math.sqrt, [4.0], workers=1)])\n")
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=120)
    assert "__main__" in done.stderr.splitlines()[-1] and done.returncode == 1


def test_other_executors_take_anything():
    with ThreadPoolExecutor(2) as threads:
        outcomes = costate.sweep(lambda x: -x, range(9), threads, chunk=2)
    assert [outcome.value for outcome in outcomes] == [-x for x in range(9)]


def test_motions_are_those_of_one_process():
    tasks = [0.2, 0.4, 0.6]
    for outcome, q in zip(costate.sweep(least_effort, tasks, workers=2, chunk=1), tasks):
        assert outcome.value == least_effort(q)


def test_results_in_a_file(tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
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
    assert again[4].value == {"square": 16, "pair": [4, -4]} and again[5].value["name"] == "odd" and again[11].ok
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
    parquet = pytest.importorskip("pyarrow.parquet")
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
    assert os.listdir(tmp_path / ".") and not parts.exists()


def test_dask_computes_the_same():
    distributed = pytest.importorskip("distributed")
    tasks = [0.2, 0.4, 0.6, 0.8]
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            there = costate.sweep(least_effort, tasks, client.get_executor(), chunk=2)
            failing = costate.sweep(picky, range(10), client.get_executor(), chunk=3)
    assert [outcome.value for outcome in there] == [least_effort(q) for q in tasks]
    assert [outcome.index for outcome in failing if not outcome.ok] == [3, 8] and str(failing[8].error) == "not 8"


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no signal that kills")
def test_nothing_is_lost_when_a_worker_of_dask_is_killed(tmp_path):
    distributed = pytest.importorskip("distributed")
    import dask

    mark = tmp_path / "killed"
    # Dask makes new workers; what was lost with one is sent again, task by task.
    with dask.config.set({"distributed.scheduler.allowed-failures": 0}):
        with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
            with distributed.Client(cluster) as client:
                outcomes = costate.sweep(killed_once, [(k, str(mark)) for k in range(40)], client.get_executor(), chunk=4)
                assert mark.exists() and [outcome.value for outcome in outcomes] == list(range(40))
                outcomes = costate.sweep(killed_always, range(12), client.get_executor(), chunk=4)
    assert [outcome.value for outcome in outcomes] == [k if k != 5 else None for k in range(12)]
    assert isinstance(outcomes[5].error, costate.WorkerDied)


def test_outcomes_are_pickled():
    (outcome,) = costate.sweep(square, [3], workers=1)
    assert pickle.loads(pickle.dumps(outcome)) == outcome


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
