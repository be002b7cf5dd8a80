"""What costate is to reach, and whether the figures show it."""

from statistics import median

from scipy.stats import beta

import speed
from comparison import NEAR, STARTS, excess
from fatrop import FATROP
from measures import ACCURATE, OURS, PEER, is_costate, kinds, of, solved, tolerances

# Share of tasks that must be solved in these classes.
SURE, SURE_CLASSES = 0.99, "abg"
# A share of tasks is told with the bound that it exceeds with this probability.
PROBABILITY = 0.95
# Six or seven joints with all limits: median time (ms), at a cost above the best one known by at most this.
ARMS = ((OURS, 10.0, NEAR), (ACCURATE, 50.0, 1e-7))
# Limits: at the points, and between them in parts of their range.
AT_POINTS, BETWEEN = 1e-8, 1e-4
# Share of tasks that may cost more than NEAR above the best one known.
DEARER = 0.05


def verdicts(figures):
    """(goal, measured, verdict), missed goals first, comparisons without a goal last."""
    rows = [*speed.goals(figures, verdict), *solves_as_many(figures), *sure(figures), *arms(figures),
            *limits(figures), best_cost(figures)]
    order = {"**missed**": 0, "not measured": 1, "kept, too few tasks to show it": 2, "kept": 3}
    return [*sorted(rows, key=lambda row: order[row[2]]), *speed.comparisons(figures)]


def verdict(kept):
    return "not measured" if kept is None else "kept" if kept else "**missed**"


def solves_as_many(figures):
    """As each of the two peers that were run."""
    for label, name in ((FATROP, "FATROP"), (PEER, "the peer")):
        if any(label in row["sides"] for row in of(figures)):
            counts = {kind: tuple(len(solved(of(figures, kind), side)) for side in (OURS, label)) for kind in kinds(figures)}
            text = ", ".join(f"{kind} {ours}/{theirs}" for kind, (ours, theirs) in counts.items())
            yield (f"solves at least as many tasks as {name} in every class (costate/{name.removeprefix('the ')})", text,
                   verdict(all(ours >= theirs for ours, theirs in counts.values())))


def sure(figures):
    for kind in SURE_CLASSES:
        rows = of(figures, kind)
        count = len(solved(rows, OURS))
        kept = count >= SURE * len(rows) if rows else None
        bound = at_least(count, len(rows))
        shown = "kept, too few tasks to show it" if kept and bound < SURE else verdict(kept)
        yield (f"solves {SURE:.0%} of class {kind}",
               f"{count} of {len(rows)}: at least {bound:.0%} with {PROBABILITY:.0%} confidence" if rows else "-", shown)


def at_least(count, tasks):
    """Lower bound of the share of all such tasks that are solved (Clopper and Pearson 1934, one-sided)."""
    return float(beta.ppf(1 - PROBABILITY, count, tasks - count + 1)) if count else 0.0


def arms(figures):
    rows = [row for row in of(figures, "g") if row["n"] in (6, 7)]
    for label, bound, above in ARMS:
        near = [row["sides"][label]["ms"] for row in rows
                if (found := excess(row, label)) is not None and found <= above]
        enough = None if not rows else len(near) > len(rows) / 2 and median(near) <= bound
        yield (f"six or seven joints with all limits: median below {bound:g} ms at a cost within {above:g}",
               f"{f'{median(near):.1f} ms' if near else '-'}, {len(near)} of {len(rows)} tasks", verdict(enough))


def limits(figures):
    for key, bound, where in (("at_points", AT_POINTS, "at points"), ("between", BETWEEN, "between points")):
        for label, tolerance in tolerances(figures[0]["tolerances"]).items():
            worst = {kind: max(row["sides"][label][key] for row in rows)
                     for kind in kinds(figures) if (rows := solved(of(figures, kind), label))}
            text = ", ".join(f"{kind} {value:.0e}" for kind, value in worst.items())
            yield (f"limits kept to {bound:g} of their range {where}, costate at {tolerance:g}", text or "-",
                   verdict(max(worst.values()) <= bound if worst else None))


def best_cost(figures):
    rows = [(row, above) for row in of(figures) if (above := excess(row, OURS)) is not None]
    dear = [row for row, above in rows if above > NEAR]
    left = [row for row in dear if row.get("starts") is None or row["starts"] > (1 + NEAR) * row["best"]]
    text = f"{len(left)} of {len(rows)}; from one start {len(dear)}"
    unsolved = [row["task"] for row in of(figures) if not row["sides"][OURS]["solved"]]
    unknown = [row["task"] for row in of(figures) if row["best"] is None and row["task"] not in unsolved]
    for what, names in (("not solved", unsolved), ("no best cost known", unknown)):
        text += f"; {what}, not counted: {len(names)} ({', '.join(names)})" if names else ""
    own = sum(row["best_by"] == "starts" or is_costate(row["best_by"]) for row, _ in rows)
    return (f"at most {DEARER:.0%} of tasks cost more than {NEAR:g} above the best cost known, other minima told apart by "
            f"{STARTS} starts", f"{text}; the best cost is costate's own on {own}",
            verdict(len(left) <= DEARER * len(rows) if rows else None))
