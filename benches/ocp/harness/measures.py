"""What the figures say: rows of a class, tasks that a side solves, errors of answers, and ratios of times."""

from statistics import median

from classes import CLASSES
from comparison import DEFAULT, excess

# The peer, the same to looser tolerances, and with costate's functions inside.
PEER, MIDDLE, LOOSE, INSIDE = "peer", "middle", "loose", "peer_ours"
# On the mesh of costate's first answer.
MESH = "mesh"
# costate at its first and at its last tolerance.
OURS, ACCURATE = "costate", "accurate"
# Errors below this count as equal: the best cost known is not better known, and it is costate's last tolerance.
FLOOR = 1e-7


def tolerances(values):
    """Label -> tolerance of costate; the first one and the last one have labels of their own."""
    labels = [OURS, *(f"{OURS} {value:g}" for value in values[1:-1]), ACCURATE]
    return dict(zip(labels, values, strict=True))


def is_costate(label):
    """At one of its tolerances, or with default options."""
    return label.split()[0] in (OURS, ACCURATE, DEFAULT)


def of(figures, kind=None):
    return [row for row in figures if "task" in row and kind in (None, row["class"])]


def kinds(figures):
    return [kind for kind in CLASSES if of(figures, kind)]


def solved(rows, label):
    return [row for row in rows if row["sides"].get(label, {}).get("solved")]


def ratios(rows, peer=PEER, ours=OURS):
    """The peer's time over costate's where both solved the task."""
    return [row["sides"][peer]["ms"] / own_ms(row, peer, ours) for row in solved(solved(rows, peer), ours)]


def own_ms(row, peer, ours):
    """costate's time in the run in which the peer was measured."""
    return row["sides"][peer].get("beside_ms", row["sides"][ours]["ms"])


def cost_error(row, label):
    """Distance of the cost from the best one known, relative; None where one of the two is missing. A cost below the best one
    is an error too: of a motion that does not obey the dynamics or the limits between the solver's points."""
    above = excess(row, label)
    return None if above is None else abs(above)


def number_of(value):
    """Infinite where JSON has none."""
    return float("inf") if value is None else value


def error(row, label):
    """The largest of three: the error of the cost, the gap with torques cut to their limits (infinite where no motion came of
    that), and the violation between the points of limits of positions, rates and clearances."""
    found = cost_error(row, label)
    return None if found is None else max(found, *(number_of(row["sides"][label][key]) for key in ("cut", "states")))


def ratios_at_accuracy(rows, error_of, peers=(PEER,)):
    """The peer's time over that of the fastest answer of costate whose error is at most the peer's, or FLOOR; 0 where there is
    none. The peer's time is that of its fastest answer among these with no larger error either. Tasks on which the peer's
    error is not known are left out."""
    found = []
    for row in rows:
        theirs = error_of(row, PEER)
        if theirs is not None:
            near = lambda label: (own := error_of(row, label)) is not None and own <= max(theirs, FLOOR)
            time = lambda label: row["sides"][label]["ms"]
            least = min(time(label) for label in peers if label in row["sides"] and near(label))
            own = [label for label in row["sides"] if is_costate(label) and label != DEFAULT and near(label)]
            found.append(max((least / time(label) for label in own), default=0.0))
    return found


def by_class(figures, values):
    """Class -> median of what `values` gives of its rows, where it gives anything."""
    return {kind: median(found) for kind in kinds(figures) if (found := values(of(figures, kind)))}


def middle_of(rows, label, key):
    """Median of a figure of a side over the tasks that it solved, infinite where the figure is; or of what a function gives,
    over the tasks on which it gives something."""
    done = solved(rows, label)
    if callable(key):
        values = [value for row in done if (value := key(row, label)) is not None]
    else:
        values = [number_of(row["sides"][label][key]) for row in done]
    return median(values) if values else float("nan")
