"""Figures in a file, a line for each task: what is finished outlives an interruption."""

import json

from shell import say


class Record:
    """While a run goes on its figures are in a file of their own. The same run, started again, goes on there; any other one
    begins anew."""

    def __init__(self, file, head):
        self.file, self.part = file, file.with_suffix(".part.jsonl")
        self.figures = read(self.part) if self.part.exists() else []
        if self.figures and self.figures[0] == json.loads(json.dumps(head)):
            say(f"{self.part}: goes on after {len(self.figures) - 1} tasks")
        else:
            if len(self.figures) > 1:
                say(f"{self.part} is of another run, and replaced")
            self.figures = [head]
        # Without the half line that an interruption may leave.
        self.part.write_text("".join(json.dumps(row) + "\n" for row in self.figures))

    def tasks(self):
        """Names of those that are finished."""
        return {row["task"] for row in self.figures[1:]}

    def add(self, row):
        self.figures.append(row)
        with self.part.open("a") as stream:
            stream.write(json.dumps(row) + "\n")

    def close(self):
        """All figures; the run is complete."""
        self.part.replace(self.file)
        return self.figures


def read(file):
    """All whole lines."""
    found = []
    for line in file.read_text().splitlines():
        try:
            found.append(json.loads(line))
        except ValueError:
            break
    return found
