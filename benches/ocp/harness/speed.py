"""How many times faster costate is, and at which accuracies: the goals, and every comparison by itself."""

from statistics import median

from comparison import DEFAULT
from measures import (INSIDE, LOOSE, MESH, MIDDLE, OURS, PEER, by_class, cost_error, error, middle_of, of, ratios,
                      ratios_at_accuracy, solved, tolerances)

# Peer's time over costate's: median of all tasks, median of the worst class.
MEDIAN_RATIO, WORST_RATIO = 20.0, 10.0


def goals(figures, verdict):
    """At the peer's accuracy."""
    rows = of(figures)
    at_accuracy = lambda rows: ratios_at_accuracy(rows, error)
    every, medians = at_accuracy(rows), by_class(figures, at_accuracy)
    own = ", ".join(f"{value:g}" for value in figures[0]["tolerances"])
    what = (f"peer's time at {figures[0]['peer_tolerances'][0]:g} over that of the fastest answer of costate, at {own}, whose "
            "error is at most the peer's")
    reached = f", reached on {sum(ratio > 0 for ratio in every)} of {len(every)} tasks"
    if left := len(rows) - len(every):
        reached += f"; left out, not solved by the peer or without a best cost known: {left}"
    yield (f"at the peer's accuracy: median at least {MEDIAN_RATIO:g} ({what})",
           f"{median(every):.2f}{reached}" if every else "-", verdict(median(every) >= MEDIAN_RATIO if every else None))
    yield (f"the same, median of every class at least {WORST_RATIO:g}", listed(medians) or "-",
           verdict(min(medians.values()) >= WORST_RATIO if medians else None))


def comparisons(figures):
    """No goals: costate at each tolerance beside each peer, with the accuracy of both; only what is measured."""
    own, (tight, middle, loose) = tolerances(figures[0]["tolerances"]), figures[0]["peer_tolerances"]
    rows = of(figures)
    cost_only = lambda rows: ratios_at_accuracy(rows, cost_error)
    if every := cost_only(rows):
        yield ("at the peer's accuracy, the error being that of the cost alone",
               f"{median(every):.2f}, reached on {sum(ratio > 0 for ratio in every)} of {len(every)} tasks; "
               f"{listed(by_class(figures, cost_only))}", faster(every))
    both = lambda rows: ratios_at_accuracy(rows, error, (PEER, MIDDLE, LOOSE))
    if every := both(rows):
        yield ("at the peer's accuracy, the peer too being the fastest of its three answers with no larger error",
               f"{median(every):.2f}; {listed(by_class(figures, both))}", faster(every))
    by_default = lambda rows: ratios(rows, PEER, DEFAULT)
    if every := by_default(rows):
        yield (f"costate with default options, first solve of a process, beside the peer at {tight:g}: median of all tasks; "
               "of every class", f"{median(every):.2f}; {listed(by_class(figures, by_default))}", faster(every))
    for label, peer, other in (*((label, PEER, f"the peer at {tight:g}") for label in own),
                               (OURS, MIDDLE, f"the peer at {middle:g}"), (OURS, LOOSE, f"the peer at {loose:g}"),
                               (OURS, INSIDE, f"the peer at {tight:g} with costate's functions inside"),
                               (OURS, MESH, f"the peer at {tight:g} on costate's own last mesh and transcription")):
        found = lambda rows, peer=peer, label=label: ratios(rows, peer, label)
        if every := found(rows):
            yield (f"costate at {own[label]:g} beside {other}: median of all tasks; of every class; accuracy of both",
                   f"{median(every):.2f}; {listed(by_class(figures, found))}; {accuracy(rows, label, peer)}", faster(every))


def accuracy(rows, label, peer):
    """Over the tasks that both solved."""
    rows = solved(solved(rows, peer), label)
    pair = lambda key: " / ".join(f"{middle_of(rows, side, key):.0e}" for side in (label, peer))
    return (f"medians costate / peer: error of cost {pair(cost_error)}, gap with torques cut {pair('cut')}, miss with torques "
            f"held {pair('held')}, limits of positions, rates, clearances {pair('states')}")


def faster(ratios):
    return "faster" if median(ratios) > 1 else "slower"


def listed(medians):
    return ", ".join(f"{kind} {value:.2f}" for kind, value in medians.items())
