"""What costate is to reach, and whether the figures show it."""

from statistics import median

from classes import CLASSES
from comparison import NEAR, STARTS, excess

PEER = "peer"
# The peer with costate's functions inside.
INSIDE = "peer_ours"
# costate at its first tolerance, which is that of the peer's accuracy, and at its second one.
OURS, ACCURATE = "costate", "accurate"
# Share of tasks that must be solved in these classes.
SURE, SURE_CLASSES = 0.99, "abg"
# Peer's time over costate's: median of all tasks, median of the worst class.
MEDIAN_RATIO, WORST_RATIO = 20.0, 10.0
# Six or seven joints with all limits: median time (ms), at a cost above the best one known by at most this.
ARMS = ((OURS, 10.0, NEAR), (ACCURATE, 50.0, 1e-7))
# Limits: at the points, and between them in parts of their range.
AT_POINTS, BETWEEN = 1e-8, 1e-4
# Share of tasks that may cost more than NEAR above the best one known.
DEARER = 0.05


def of(figures, kind=None):
    return [row for row in figures if "task" in row and kind in (None, row["class"])]


def solved(rows, label):
    return [row for row in rows if row["sides"].get(label, {}).get("solved")]


def ratios(rows, peer=PEER):
    """The peer's time over costate's where both solved the task."""
    return [row["sides"][peer]["ms"] / row["sides"][OURS]["ms"] for row in solved(solved(rows, peer), OURS)]


def kinds(figures):
    return [kind for kind in CLASSES if of(figures, kind)]


def verdicts(figures):
    """(goal, measured, verdict), missed goals first."""
    rows = [solves_what_the_peer_solves(figures), *sure(figures), *fast(figures), *arms(figures), *limits(figures)]
    rows.append(best_cost(figures))
    rows += inside(figures)
    order = {"**missed**": 0, "not measured": 1, "kept": 2, "faster": 3, "slower": 3}
    return sorted(rows, key=lambda row: order[row[2]])


def verdict(kept):
    return "not measured" if kept is None else "kept" if kept else "**missed**"


def solves_what_the_peer_solves(figures):
    counts = {kind: tuple(len(solved(of(figures, kind), label)) for label in (OURS, PEER)) for kind in kinds(figures)}
    text = ", ".join(f"{kind} {ours}/{theirs}" for kind, (ours, theirs) in counts.items())
    return ("solves at least as many tasks as the peer in every class (costate/peer)", text or "-",
            verdict(all(ours >= theirs for ours, theirs in counts.values()) if counts else None))


def sure(figures):
    for kind in SURE_CLASSES:
        rows = of(figures, kind)
        count = len(solved(rows, OURS))
        kept = count >= SURE * len(rows) if rows else None
        yield f"solves {SURE:.0%} of class {kind}", f"{count} of {len(rows)}", verdict(kept)


def fast(figures):
    every = ratios(of(figures))
    yield (f"median at least {MEDIAN_RATIO:g} times faster than the peer", f"{median(every):.2f}" if every else "-",
           verdict(median(every) >= MEDIAN_RATIO if every else None))
    medians = {kind: median(found) for kind in kinds(figures) if (found := ratios(of(figures, kind)))}
    text = ", ".join(f"{kind} {value:.2f}" for kind, value in medians.items())
    yield (f"median of every class at least {WORST_RATIO:g} times faster", text or "-",
           verdict(min(medians.values()) >= WORST_RATIO if medians else None))


def inside(figures):
    """Beside the peer with costate's own functions: what is left is not due to derivatives. No goal; only if measured."""
    every = ratios(of(figures), INSIDE)
    if every:
        text = ", ".join(f"{kind} {median(found):.2f}" for kind in kinds(figures)
                         if (found := ratios(of(figures, kind), INSIDE)))
        yield ("beside the peer with costate's functions inside: median of all tasks; of every class",
               f"{median(every):.2f}; {text}", "faster" if median(every) > 1 else "slower")


def arms(figures):
    rows = [row for row in of(figures, "g") if row["n"] in (6, 7)]
    for label, bound, above in ARMS:
        near = [row["sides"][label]["ms"] for row in solved(rows, label) if (excess(row, label) or 0) <= above]
        enough = None if not rows else len(near) > len(rows) / 2 and median(near) <= bound
        yield (f"six or seven joints with all limits: median below {bound:g} ms at a cost within {above:g}",
               f"{f'{median(near):.1f} ms' if near else '-'}, {len(near)} of {len(rows)} tasks", verdict(enough))


def limits(figures):
    for key, bound, where in (("at_points", AT_POINTS, "at points"), ("between", BETWEEN, "of their range between points")):
        worst = {kind: max(row["sides"][OURS][key] for row in rows)
                 for kind in kinds(figures) if (rows := solved(of(figures, kind), OURS))}
        text = ", ".join(f"{kind} {value:.0e}" for kind, value in worst.items())
        yield (f"limits kept to {bound:g} {where}", text or "-", verdict(max(worst.values()) <= bound if worst else None))


def best_cost(figures):
    rows = [(row, above) for row in of(figures) if (above := excess(row, OURS)) is not None]
    dear = [row for row, above in rows if above > NEAR]
    left = [row for row in dear if row.get("starts") is None or row["starts"] > (1 + NEAR) * row["best"]]
    return (f"at most {DEARER:.0%} of tasks cost more than {NEAR:g} above the best cost known, other minima told apart by {STARTS} "
            "starts", f"{len(left)} of {len(rows)}; from one start {len(dear)}",
            verdict(len(left) <= DEARER * len(rows) if rows else None))
