"""FATROP beside costate at equal error, both ways, and both beside IPOPT on FATROP's program."""

from statistics import median

import fatrop
import markdown
import measures
from comparison import DEFAULT
from fatrop import FATROP
from measures import FLOOR, error
from solvers import TIGHT

FORM = ("FATROP's program has a stage for each interval: states q and v, and T where it is free; controls are the accelerations "
        "at three Radau points, torques stand in cost and inequalities only. All classes of tasks can be posed in this form, "
        "none is refused. The cost is in units of that of the first guess, so tolerances are relative.")
NATIVE = ("FATROP here is the library of CasADi's wheel, whose BLASFEO has generic kernels. A native build of FATROP 1.1.8 is "
          "about 1.6 times as fast: measured in earlier work on 80 tasks of these classes, not by this command, which cannot "
          "reproduce it.")


def text(figures):
    """All tables, losses first; nothing where FATROP was not run."""
    rows = measures.of(figures)
    if not any(FATROP in row["sides"] for row in rows):
        return ""
    own = measures.tolerances(figures[0]["tolerances"])
    return "\n".join([
        f"FATROP's time over costate's at costate's error: on each task FATROP takes the fastest of its answers on {meshes()} "
        f"intervals and on costate's mesh, each with tolerances of {tolerances()}, whose error is at most that of costate's "
        f"answer, or {FLOOR:g}. Medians over the tasks on which there is one, and how many these are. Below 1 costate loses; "
        "the classes that costate loses at its first tolerance come first.\n",
        table(figures, [f"costate at {value:g}" for value in own.values()],
              [lambda rows, label=label: at_costates_error(rows, label) for label in own]),
        "The same at FATROP's error: costate takes the fastest of its answers whose error is at most that of FATROP's answer "
        f"at {TIGHT:g} on so many intervals.\n",
        table(figures, [f"FATROP, {count}" for count in fatrop.INTERVALS],
              [lambda rows, label=fatrop.label(count): at_fatrops_error(rows, label, own) for count in fatrop.INTERVALS]),
        "Levels that are never reached:\n",
        unreached(figures, own),
        f"FATROP at {TIGHT:g} on 20 intervals, IPOPT on the same program, costate at {figures[0]['tolerances'][0]:g} and with "
        "default options: CPU ms, iterations, errors and tasks solved; medians over tasks that FATROP and costate solved.\n",
        summary(figures), f"{FORM} {NATIVE}\n"])


def meshes():
    return ", ".join(map(str, fatrop.INTERVALS))


def tolerances():
    return ", ".join(f"{value:g}" for value in fatrop.TOLERANCES)


def fastest(row, labels, most):
    """Least time (ms) among the answers of these labels with an error of at most this; None where there is none."""
    return min((row["sides"][label]["ms"] for label in labels
                if (found := error(row, label)) is not None and found <= max(most, FLOOR)), default=None)


def answers(row, kind):
    return [label for label in row["sides"] if kind(label)]


def at_costates_error(rows, label):
    """(task, FATROP's time / costate's) by task; None where FATROP has no such answer."""
    for row in rows:
        if (most := error(row, label)) is not None:
            time = fastest(row, answers(row, fatrop.is_fatrop), most)
            yield row["task"], None if time is None else time / row["sides"][label]["ms"]


def at_fatrops_error(rows, label, own):
    """The same, None where costate has no such answer."""
    for row in rows:
        if (most := error(row, label)) is not None:
            time = fastest(row, own, most)
            yield row["task"], None if time is None else row["sides"][label]["ms"] / time


def table(figures, head, columns):
    """A row for each class and one for all, by the first column."""
    kinds = measures.kinds(figures)
    groups = {f"{kind} {measures.of(figures, kind)[0]['title']}": measures.of(figures, kind) for kind in kinds}
    rows = []
    for name, found in groups.items():
        ratios = [[ratio for _, ratio in column(found)] for column in columns]
        rows.append((middle(ratios[0]), [name, *map(cell, ratios)]))
    rows.sort(key=lambda pair: pair[0])
    every = [[ratio for _, ratio in column(measures.of(figures))] for column in columns]
    return markdown.table(["class", *head], [*(row for _, row in rows), ["all", *map(cell, every)]])


def middle(ratios):
    found = [ratio for ratio in ratios if ratio is not None]
    return median(found) if found else float("inf")


def cell(ratios):
    found = [ratio for ratio in ratios if ratio is not None]
    return f"{median(found):.2f} ({len(found)} of {len(ratios)})" if found else f"- (0 of {len(ratios)})"


def unreached(figures, own):
    rows, lines = measures.of(figures), []
    for label, value in own.items():
        lines.append([f"costate's error at {value:g}, by FATROP", names(at_costates_error(rows, label))])
    for count in fatrop.INTERVALS:
        found = at_fatrops_error(rows, fatrop.label(count), own)
        lines.append([f"FATROP's error on {count} intervals, by costate", names(found)])
    return markdown.table(["level", "tasks"], lines)


def names(found):
    return ", ".join(task for task, ratio in found if ratio is None) or "none"


SIDES = {FATROP: "FATROP", fatrop.IPOPT: "IPOPT", measures.OURS: "costate", DEFAULT: "default"}


def summary(figures):
    head = ["class", *(f"{name}, ms" for name in SIDES.values()), "FATROP / costate", "iterations", "error", "solved"]
    rows = []
    for kind in measures.kinds(figures):
        found = measures.of(figures, kind)
        rows.append((speed(found), [f"{kind} {found[0]['title']}", *line(found)]))
    rows.sort(key=lambda pair: pair[0])
    return markdown.table(head, [*(row for _, row in rows), ["all", *line(measures.of(figures))]])


def speed(rows):
    return middle(measures.ratios(rows, FATROP))


def line(rows):
    both = measures.solved(measures.solved(rows, FATROP), measures.OURS)
    of = lambda key, form, labels=SIDES: [form.format(measures.middle_of(both, label, key)) for label in labels]
    errors = of(error, "{:.0e}", (FATROP, measures.OURS))
    solved = [len(measures.solved(rows, label)) for label in SIDES]
    return [*of("ms", "{:.2f}"), f"{speed(rows):.2f}", ", ".join(of("iterations", "{:.0f}")), " / ".join(errors),
            f"{', '.join(map(str, solved))} of {len(rows)}"]
