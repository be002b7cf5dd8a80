"""Tables: of one robot on the terminal, of all in BENCHMARKS.md."""

import claims
from machine import stop

TITLES = {
    "F": "F(q, p)", "F_x": "F and F_x", "y_F_xx": "F, F_x and y'F_xx",
    "a": "forward dynamics a(q, v, u)", "a_z": "a and a_z, z = (q, v, u)", "y_a_zz": "a, a_z and y'a_zz",
    "tau": "inverse dynamics tau(q, v, a)", "tau_z": "tau and its Jacobian in (q, v, a)",
    "w_tau_zz": "second derivatives of tau in (q, v, a)", "M": "M(q)", "Minv": "inverse of M(q)",
    "contact": "on two feet: a, forces and the linearised state equation", "contact_xx": "on two feet: F, F_x and y'F_xx",
}


def times(figures, robot=None):
    return [row for row in figures if "ns" in row and robot in (None, row["robot"])]


def who(row):
    """One line of a table: the competitor and its way."""
    ways = {"codegen": "", "costate": ""}
    way = ways.get(row["way"], row["way"].removesuffix("_hamiltonian").removesuffix("_lagrangian"))
    if way.startswith("costate"):
        way = way.removeprefix("costate")[1:-1].replace("_", " ")
    return f"{row['label']}{': ' + way if way else ''}"


def print_robot(robot, figures):
    """Medians, quartiles and ratios of one robot."""
    print(f"\n{robot}: ns, median [quartiles], and how many times the time of generic costate")
    for quantity, title in TITLES.items():
        rows = [row for row in times(figures, robot) if row["quantity"] == quantity]
        own = claims.fastest(figures, robot, quantity, "costate-native")
        if rows:
            print(f"  {title}")
        for row in sorted(rows, key=lambda row: row["ns"]):
            ratio = f"{claims.ratio(row, own):6.2f}" if own else "     -"
            print(f"    {who(row):52} {row['ns']:10.0f}  [{row['q25']:.0f}, {row['q75']:.0f}] {ratio}")


def print_verdicts(figures, of):
    print("\nclaim: peer's time / costate's: verdict")
    for claim, ratios, verdict in claims.verdicts(figures, of):
        print(f"  {claim}: {ratios}: {verdict}")
    differences = [row["difference"] for row in figures if "difference" in row]
    if differences:
        print(f"\nlargest relative difference of values: {max(differences):.1e} ({len(differences)} comparisons)")


def write(page, figures, of, floating):
    """Fills the marked parts of BENCHMARKS.md."""
    text = page.read_text()
    parts = {"verdicts": verdict_table(figures, of), "machine": machine_text(figures), "tables": tables(figures),
             "agreement": agreement_text(figures)}
    for name, part in parts.items():
        name, command = (f"floating {name}", "--floating --write") if floating else (name, "--write")
        begin, end = f"<!-- {name}: begin (written by benches/peers/run {command}) -->\n", f"<!-- {name}: end -->"
        before, found, rest = text.partition(begin)
        _, closed, after = rest.partition(end)
        if not (found and closed):
            stop(f"{page} has no part {name}")
        text = before + begin + part + end + after
    page.write_text(text)


def verdict_table(figures, of):
    lines = ["| claim | measured: peer's time / costate's | verdict |", "|---|---|---|"]
    return "\n".join(lines + [f"| {' | '.join(row)} |" for row in claims.verdicts(figures, of)]) + "\n"


def machine_text(figures):
    head = figures[0]
    packages = ", ".join(f"{name} {number}" for name, number in head["packages"].items())
    flags = dict.fromkeys((row["label"], row["flags"]) for row in times(figures))
    lines = [f"{head['machine']}; {'; '.join(head['compilers'])}; {packages}. Medians of {head['batches']} batches of "
             f"{head['milliseconds']:g} ms over {head['states']} random states; ratios are medians of those of batches that "
             "ran one after the other.", "",
             "| competitor | compiled with |", "|---|---|"]
    return "\n".join(lines + [f"| {label} | `{text}` |" for label, text in flags]) + "\n"


def tables(figures):
    robots = list(dict.fromkeys(row["robot"] for row in times(figures)))
    parts = []
    for quantity, title in TITLES.items():
        rows = [row for row in times(figures) if row["quantity"] == quantity]
        if not rows:
            continue
        names = sorted(dict.fromkeys(who(row) for row in rows), key=lambda name: rank(rows, name))
        lines = [f"### {title}", "", f"| ns (times generic costate) | {' | '.join(robots)} |", "|---" * (len(robots) + 1) + "|"]
        for name in names:
            cells = [cell(figures, robot, quantity, [r for r in rows if r["robot"] == robot and who(r) == name])
                     for robot in robots]
            lines.append(f"| {name} | {' | '.join(cells)} |")
        parts.append("\n".join(lines) + "\n")
    return "\n".join(parts)


def rank(rows, name):
    return min(row["ns"] / row["n"] ** 2 for row in rows if who(row) == name)


def cell(figures, robot, quantity, rows):
    if not rows:
        return "-"
    own = claims.fastest(figures, robot, quantity, "costate-native")
    ratio = f" ({claims.ratio(rows[0], own):.2f})" if own else ""
    return f"{rows[0]['ns']:.0f}{ratio}"


def differences(figures):
    return [row for row in figures if "agreement" in row and row["with"].startswith("costate")]


def agreement_text(figures):
    lines = ["| quantity | largest difference from generic costate | of |", "|---|---|---|"]
    for quantity, title in TITLES.items():
        rows = [row for row in differences(figures) if row["agreement"] == quantity and row["agrees"]]
        if rows:
            worst = max(rows, key=lambda row: row["difference"])
            lines.append(f"| {title} | {worst['difference']:.0e} | {worst['robot']}: {worst['of']} |")
    lines += [f"\nLeft out of all tables, since its values are wrong: {row['of']}, {TITLES[row['agreement']]} of {row['robot']} "
              f"({row['difference']:.0e})." for row in differences(figures) if not row["agrees"]]
    spread = max((row["q75"] - row["q25"]) / row["ns"] for row in times(figures))
    return "\n".join(lines) + f"\n\nLargest distance between quartiles, in units of the median: {spread:.2f}.\n"
