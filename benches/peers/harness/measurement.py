"""Times and values of all competitors on one robot, from peers/driver.c."""

import subprocess
from collections import defaultdict
from statistics import median, quantiles

from machine import say, stop


def run(options, robots):
    """For each robot its rows of times, and the values of each state.

    Every round is a process, its batches go through all competitors in turn. A round of one robot follows that of
    another, so that no robot is measured at one time only: the machine is slower for minutes at a time, and not for all
    kinds of code alike."""
    found = [(defaultdict(list), defaultdict(dict)) for _ in robots]
    for number in range(options.rounds):
        for (robot, peers), (batches, values) in zip(robots, found):
            say(f"{robot.name}: round {number + 1} of {options.rounds}")
            play(options, robot, peers, number, batches, values)
    flags = [{peer.label: peer.flags for peer in peers.competitors} for _, peers in robots]
    return [([row(key, times, flags) for key, times in batches.items()], values)
            for flags, (batches, values) in zip(flags, found)]


def play(options, robot, peers, number, batches, values):
    """One round of a robot: adds its times and values."""
    arguments = [f"{peer.label}={peer.library}:{peer.file}" for peer in peers.competitors]
    # Where memory lies shifts some times by a tenth: another order of loading in each round.
    first = number * len(arguments) // options.rounds
    order = arguments[first:] + arguments[:first]
    done = subprocess.run(
        [peers.driver, robot.states, str(robot.nq), str(robot.n), str(options.batches), str(1e6 * options.milliseconds),
         ",".join(options.quantities) or "-", *order],
        capture_output=True, text=True, check=False)
    if done.returncode:
        stop(f"the driver failed on {robot.name}: {done.stderr.strip()}")
    for line in done.stdout.splitlines():
        kind, label, name, index, *numbers = line.split()
        quantity, way = name.split(":")
        if kind == "time":
            batches[label, quantity, way].append(float(numbers[0]))
        elif number == 0:
            values[quantity, int(index)][f"{way} [{label}]"] = [float(text) for text in numbers]


def row(key, times, flags):
    label, quantity, way = key
    low, _, high = quantiles(times, n=4) if len(times) > 1 else 3 * times
    return {"quantity": quantity, "way": way, "label": label, "flags": flags[label], "batches": len(times),
            "ns": round(median(times), 2), "q25": round(low, 2), "q75": round(high, 2), "min": round(min(times), 2),
            "times": [round(time, 1) for time in times]}
