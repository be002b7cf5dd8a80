"""Tables of Markdown."""


def table(head, rows):
    line = lambda row: f"| {' | '.join(map(str, row))} |"
    return "\n".join([line(head), "|---" * len(head) + "|", *map(line, rows)]) + "\n"
