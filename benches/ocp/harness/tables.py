"""Tables of the figures, on the terminal and in BENCHMARKS.md, losses first."""

from statistics import median, quantiles

import fatrop
import goals
import levels
import markdown
import measures
from comparison import NEAR, STARTS, TIMES, excess
from shell import stop

NAMES = {"costate": "costate", "accurate": "costate, accurate", "default": "costate, default options", "peer": "peer",
         "middle": "peer, tolerance 1e-6", "loose": "peer, tolerance 1e-4",
         "mesh": "peer, costate's mesh",
         "peer_ours": "peer, costate's functions inside", "interpreted": "peer, interpreted",
         **{fatrop.label(mesh, tolerance): f"FATROP, {text}, tolerance {tolerance:g}" for tolerance in fatrop.TOLERANCES
            for mesh, text in ((20, "20 intervals"), ("mesh", "costate's mesh"))},
         fatrop.IPOPT: "IPOPT, FATROP's program"}


def tables(figures):
    """Name of the mark -> text."""
    return {"ocp verdicts": verdict_table(figures), "ocp machine": machine_text(figures),
            "ocp classes": class_table(figures) + "\n" + robot_table(figures), "ocp losses": losses(figures)}


def verdict_table(figures):
    goals_of_all = markdown.table(["goal", "measured", "verdict"], goals.verdicts(figures))
    return "\n".join(filter(None, (levels.text(figures), goals_of_all)))


def class_table(figures):
    rows = []
    for kind in measures.kinds(figures):
        found = measures.of(figures, kind)
        for label in labels(figures):
            rows.append([f"{kind} {found[0]['title']}" if label == "costate" else "", *line(found, label)])
    return markdown.table(HEAD, rows)


HEAD = ["class", "solver", "solved", "CPU ms, median (quartiles)", "with start, ms", "peer's time / costate's", "iterations",
        "cost above the best known, median, worst", "gap", "gap, torques cut", "miss at the end", "miss, torques held",
        "limits at points", "between"]


def robot_table(figures):
    rows = []
    for robot in dict.fromkeys(row["robot"] for row in measures.of(figures)):
        found = [row for row in measures.of(figures) if row["robot"] == robot]
        for label in labels(figures):
            rows.append([robot if label == "costate" else "", *line(found, label)])
    return markdown.table(["robot", *HEAD[1:]], rows)


def labels(figures):
    """costate first, then what else there is; of FATROP's equal meshes only that of 20 intervals."""
    found = dict.fromkeys(label for row in measures.of(figures) for label in row["sides"])
    meshes = [fatrop.label(count, tolerance) for count in fatrop.INTERVALS if count != 20 for tolerance in fatrop.TOLERANCES]
    return ["costate", *(label for label in found if label not in ("costate", *meshes))]


def line(rows, label):
    rows = [row for row in rows if label in row["sides"]]
    done = measures.solved(rows, label)
    sides = [row["sides"][label] for row in done]
    above = [value for row in done if (value := excess(row, label)) is not None]
    ratio = spread(ratios(rows, label), "{:.2f}") if label not in (measures.OURS, measures.DEFAULT) else ""
    return [NAMES.get(label, label.replace(" ", ", tolerance ")), f"{len(done)} of {len(rows)}", spread([side["ms"] for side in sides], "{:.1f}"),
            middle(sides, "process_ms", "{:.1f}"), ratio, middle(sides, "iterations", "{:.0f}"),
            f"{median(above):.0e}, {max(above):.0e}" if above else "-", worst(sides, "gap"), worst(sides, "cut"),
            worst(sides, "end"), worst(sides, "held"), worst(sides, "at_points"), worst(sides, "between")]


def ratios(rows, label):
    """On rows of peers their time over costate's at its first tolerance, with other tolerances the first peer's over it."""
    return measures.ratios(rows, measures.PEER, label) if measures.is_costate(label) else measures.ratios(rows, label)


def spread(values, form):
    if not values:
        return "-"
    if len(values) < 2:
        return form.format(values[0])
    low, mid, high = quantiles(values, n=4, method="inclusive")
    return f"{form.format(mid)} ({form.format(low)}-{form.format(high)})"


def middle(sides, key, form):
    return form.format(median(side[key] for side in sides)) if sides else "-"


def worst(sides, key):
    """The median and the largest; nothing of sides that are not judged."""
    values = [side[key] if side[key] is not None else float("inf") for side in sides if key in side]
    return f"{median(values):.0e}, {max(values):.0e}" if values else "-"


def losses(figures):
    """Tasks that FATROP or the peer solves and costate does not, those that cost more, then what these two do not solve."""
    rows, refused = [], {}
    for row in measures.of(figures):
        ours = row["sides"]["costate"]
        theirs = [row["sides"][label] for label in (fatrop.FATROP, measures.PEER) if label in row["sides"]]
        above = excess(row, "costate")
        texts = [reason(ours), *map(reason, theirs)]
        if ours["status"].startswith("refused"):
            refused.setdefault(row["class"], []).append(row)
        elif not ours["solved"]:
            rows.append((1 if any(side["solved"] for side in theirs) else 3, [row["task"], "not solved", *texts]))
        elif above is not None and above > NEAR:
            text = f"cost {above:.1e} above the best known"
            if row.get("starts") is not None:
                text += f", from {STARTS} starts {row['starts'] / row['best'] - 1:.0e}"
            rows.append((2, [row["task"], text, *texts]))
        elif not any(side["solved"] for side in theirs):
            rows.append((4, [row["task"], "solved by costate only", *texts]))
    head = ["FATROP"] * (fatrop.FATROP in labels(figures)) + ["peer"]
    for kind, found in refused.items():
        counts = [len(measures.solved(found, label)) for label in (fatrop.FATROP, measures.PEER)]
        solved = [f"solved {count}" for count in counts[-len(head):]]
        ours = reason(found[0]["sides"]["costate"])
        rows.append((0, [f"class {kind}: {len(found)} tasks", "cannot be posed", ours, *solved]))
    rows.sort(key=lambda pair: pair[0])
    return markdown.table(["task", "what", "costate", *head], [row for _, row in rows]) if rows else "None.\n"


def reason(side):
    if side["solved"]:
        return f"solved, cost {side['cost']:.6g}"
    if not side["says"]:
        return side["status"].replace("|", "/")
    gap = "no motion" if side.get("gap") is None else f"gap {side['gap']:.0e}, limits {side['at_points']:.0e}"
    return f"{side['status']}, but not accepted: {gap}"


def machine_text(figures):
    head = figures[0]
    packages = ", ".join(f"{name} {number}" for name, number in head["packages"].items())
    tolerances = ", ".join(f"{tolerance:g}" for tolerance in head["tolerances"])
    theirs = ", ".join(f"{tolerance:g}" for tolerance in head["peer_tolerances"])
    times = 1 + TIMES * (head["repeats"] - 1)
    return (f"{head['machine']}; {'; '.join(head['compilers'])}; {packages}; {head['costate']}. Seed {head['seed']}; peer: "
            f"{head['elements']} elements of 3 Radau points, tolerances {theirs}; costate: tolerances {tolerances}; the "
            f"least of {times} calls of both sides; with default options once. {added(figures)}{draws(figures)}\n")


def added(figures):
    if not figures[0].get("mesh_added"):
        return ""
    rows = measures.of(figures)
    count = sum(measures.MESH in row["sides"] for row in rows)
    left = f" of {count} of the {len(rows)} tasks" if count < len(rows) else ""
    return f"The peer on costate's mesh was measured in a run of its own{left}, beside costate's time in that run. "


def draws(figures):
    """What was thrown away before there were the tasks."""
    rows = measures.of(figures)
    made, failed = (sum(row[key] for row in rows) for key in ("draws", "peer_failed"))
    kinds = ", ".join(f"{kind} {count}" for kind in measures.kinds(figures)
                      if (count := sum(row["peer_failed"] for row in measures.of(figures, kind))))
    others = made - len(rows) - failed
    return (f"{len(rows)} tasks of {made} draws; {failed} draws were thrown away because the peer did not find the motion "
            f"without limits{f' ({kinds})' if kinds else ''}, {others} because limits would not be active or no known motion "
            "keeps them.")


def print_all(figures):
    for name, text in tables(figures).items():
        print(f"\n{name.removeprefix('ocp ')}\n\n{text}")


def write(page, figures):
    put(page, tables(figures))


def put(page, parts):
    """Texts between the marks of their names."""
    text = page.read_text()
    for name, part in parts.items():
        begin, end = f"<!-- {name}: begin (written by benches/ocp/run --write) -->\n", f"<!-- {name}: end -->"
        if begin not in text or end not in text:
            stop(f"{page.name} has no marks for {name}")
        before, rest = text.split(begin)
        text = before + begin + part + end + rest.split(end, 1)[1]
    page.write_text(text)
