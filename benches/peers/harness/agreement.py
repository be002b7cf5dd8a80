"""Whether all competitors compute the same numbers."""

import math
from collections import defaultdict

from machine import stop


def check(robot, values, tolerance):
    """The largest max |a - b| / max |b| over all states, of each competitor; b is costate's, or the first one's."""
    worst = defaultdict(float)
    for (quantity, state), found in values.items():
        reference = min(found, key=lambda name: (not name.startswith("costate"), list(found).index(name)))
        expected = found[reference]
        size = max(map(abs, expected)) or 1.0
        for name, numbers in found.items():
            if len(numbers) != len(expected):
                stop(f"{robot}: {quantity}: {name} gives {len(numbers)} numbers, {reference} {len(expected)}")
            # max() passes over what is no number, so that is looked for by itself.
            finite = all(map(math.isfinite, numbers)) and all(map(math.isfinite, expected))
            difference = max(abs(a - b) for a, b in zip(numbers, expected)) / size if finite else math.inf
            worst[quantity, name, reference] = max(worst[quantity, name, reference], difference)
    return [{"agreement": quantity, "of": name, "with": reference, "difference": difference, "agrees": difference <= tolerance}
            for (quantity, name, reference), difference in worst.items() if name != reference]


def right(figures):
    """All figures but the times of competitors whose values disagree: these count for nothing."""
    wrong = {(row["robot"], row["agreement"], row["of"]) for row in figures if row.get("agrees") is False}
    return [row for row in figures if (row.get("robot"), row.get("quantity"), name_of(row)) not in wrong]


def name_of(row):
    return f"{row['way']} [{row['label']}]" if "way" in row else None


def stop_at_disagreement(figures):
    """Exit status 1 where values disagree: then the times say nothing."""
    wrong = [row for row in figures if row.get("agrees") is False]
    for row in wrong:
        print(f"DISAGREES: {row['robot']}: {row['agreement']}: {row['of']} and {row['with']} by {row['difference']:.1e}")
    if wrong:
        stop(f"{len(wrong)} values disagree")
