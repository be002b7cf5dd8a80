"""A map of the workspace of a UR5: the least effort that it takes to bring the tool to each place.

``python python/examples/workspace_map.py [--grid 12] [--starts 3] [--workers 4] [--dask] [--parquet map.parquet] [--picture map.png]``

The tool begins in front of the robot and comes to rest at the places of a vertical grid, in any orientation. The
cost of a motion of one second is the integral of the squared torques, each divided by its limit. A solve finds a local
minimum: with ``--starts`` the best of several guesses counts. ``--dask`` computes on a
``LocalCluster``; with ``--parquet`` an interrupted map is continued.
"""

import argparse
import os
import sys
import time
import warnings
from functools import cache, partial
from pathlib import Path

import costate
import numpy as np

ROBOT = Path(__file__).parents[2] / "robots" / "ur5.urdf"
START = [0.0, -1.6, 1.8, -1.8, -1.57, 0.0]


@cache
def robot() -> costate.Robot:
    """Once in each process."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", costate.RobotWarning)
        return costate.Robot.from_file(ROBOT)


def least_effort(place: tuple[float, float, float], starts: int = 1) -> dict:
    """The cheapest motion that ends with the tool at a place (x, y, z) in m."""
    arm = robot()
    row = {"x": place[0], "y": place[1], "z": place[2]}
    weights, end = 1 / arm.effort_limits**2, {"tool": {"frame": "tool0", "xyz": list(place)}}
    try:
        problem = costate.Problem(arm, start=START, end=end, time=1.0, cost=weights, limits=True)
    except costate.ProblemError as error:
        if not (error.key or "").startswith("end.tool"):
            raise
        return row | {"status": "out_of_reach", "cost": None}
    solution = problem.solve(threads=1, starts=starts)
    return row | {"status": solution.status, "cost": solution.cost if solution.solved else None}


def places(grid: int) -> list[tuple[float, float, float]]:
    """A square grid in the plane y = 0.2 m."""
    return [(float(x), 0.2, float(z)) for z in np.linspace(-0.2, 0.9, grid) for x in np.linspace(0.05, 0.95, grid)]


def draw(rows: list[dict], grid: int, file: Path) -> None:
    """The costs as colours; white where no motion was found."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    cost = np.array([np.nan if row.get("cost") is None else row["cost"] for row in rows]).reshape(grid, grid)
    x, z = (np.array([row[name] for row in rows]).reshape(grid, grid) for name in ("x", "z"))
    figure, axes = plt.subplots(figsize=(6, 6), layout="constrained")
    mesh = axes.pcolormesh(x, z, cost, shading="nearest", cmap="viridis")
    figure.colorbar(mesh, label="least effort (s)")
    axes.set(xlabel="x (m)", ylabel="z (m)", title="UR5, motions of 1 s, y = 0.2 m", aspect="equal")
    figure.savefig(file, dpi=110)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--grid", type=int, default=12, help="places along each side")
    parser.add_argument("--starts", type=int, default=1, help="guesses for each motion")
    parser.add_argument("--workers", type=int, help="processes")
    parser.add_argument("--dask", action="store_true", help="on a LocalCluster")
    parser.add_argument("--parquet", help="where results are kept")
    parser.add_argument("--picture", type=Path, help="where the map is drawn")
    given = parser.parse_args()
    tasks, options = places(given.grid), {"chunk": 2, "progress": sys.stderr.isatty(), "parquet": given.parquet}
    function = partial(least_effort, starts=given.starts)
    start = time.perf_counter()
    if given.dask:
        from distributed import Client, LocalCluster

        settings = {"n_workers": given.workers, "threads_per_worker": 1, "dashboard_address": None}
        with LocalCluster(**settings) as cluster, Client(cluster) as client:
            outcomes = costate.sweep(function, tasks, client.get_executor(), **options)
            workers = len(cluster.workers)
    else:
        workers = given.workers or len(os.sched_getaffinity(0))
        outcomes = costate.sweep(function, tasks, workers=workers, **options)
    seconds = time.perf_counter() - start
    for outcome in outcomes:
        if not outcome.ok:
            print(f"{outcome.task}: {outcome.error}")
    rows = [outcome.value or dict(zip("xyz", outcome.task)) for outcome in outcomes]
    away = sum(row.get("status") == "out_of_reach" for row in rows)
    solved = sum(row.get("cost") is not None for row in rows)
    rate = (len(rows) - away) / seconds / workers
    print(f"{len(rows)} places, {away} of them out of reach, {solved} motions solved")
    print(f"{workers} processes, {seconds:.1f} s, {rate:.1f} motions a second and process")
    if given.picture:
        draw(rows, given.grid, given.picture)


if __name__ == "__main__":
    main()
