"""One task solved by every side, judged, and set beside the best cost known."""

import math

from classes import CLASSES

# The peer's mesh for the best cost is this many times finer.
FINER = 4
# Starts among which the best cost is looked for: the answers found, and this many bent lines.
BENT = 3
# A solver that took longer than this (s) is not repeated.
LONG = 2.0


class Comparison:
    def __init__(self, peers, ours, judge, options):
        """`peers` by label, the first one also finds the best costs."""
        self.peers, self.ours, self.judge, self.options = peers, ours, judge, options

    def run(self, task):
        """The row of figures of one task."""
        sides = {label: (lambda peer=peer: peer.solve(task, self.options.elements)) for label, peer in self.peers.items()}
        sides["costate"] = lambda: self.ours.solve(task)
        answers = {}
        # In turn, so that whatever slows the machine down slows all.
        for _ in range(self.options.repeats):
            for label, solve in sides.items():
                earlier = answers.get(label)
                if earlier and (earlier.seconds > LONG or not earlier.solved):
                    continue
                answer = solve()
                if earlier is None or answer.seconds < earlier.seconds:
                    answers[label] = answer
        row = {"task": task.name, "class": task.kind, "title": CLASSES[task.kind][0], "robot": task.robot.name, "n": task.n,
               "elements": self.options.elements}
        judgements = {label: self.judge.judge(task, answer.motion) for label, answer in answers.items()}
        row["sides"] = {label: self.side(answer, judgements[label]) for label, answer in answers.items()}
        row["best"] = self.best(task, answers, row["sides"]) if self.options.best else None
        return row

    def side(self, answer, judgement):
        found = {"status": answer.status, "says": answer.solved, "solved": answer.solved and bool(judgement and judgement.accepted()),
                 "told": number(answer.cost), "duration": number(answer.duration), "iterations": answer.iterations,
                 "ms": round(1e3 * answer.seconds, 3), "process_ms": round(1e3 * answer.process_seconds, 3)}
        if judgement:
            found |= {key: number(getattr(judgement, key)) for key in ("cost", "gap", "end", "at_points", "between")}
        return found

    def best(self, task, answers, sides):
        """Least cost of a motion on a mesh where the error of the cost is small: the peer's on a finer one from several starts,
        and costate's."""
        peer = next(iter(self.peers.values()))
        coarse = [answer for label, answer in answers.items() if sides[label]["solved"]]
        if all(answer.seconds < LONG for answer in coarse):
            coarse.append(peer.cheapest(task, self.options.elements, 1 + BENT))
        if task.obstacles:
            coarse.append(peer.solve(task.but(obstacles=[]), self.options.elements))
        fine = [peer.solve(task, FINER * self.options.elements, start.motion) for start in coarse if start.motion is not None]
        costs = [answer.cost for answer in fine if answer.solved]
        if sides["costate"]["solved"]:
            costs.append(sides["costate"]["cost"])
        return min((cost for cost in costs if math.isfinite(cost)), default=None)


def number(value):
    """None for what JSON cannot hold."""
    return float(value) if value is not None and math.isfinite(value) else None


def excess(row, label):
    """Cost above the best one known, relative; None where one of the two is missing."""
    side, best = row["sides"].get(label), row["best"]
    if not side or not side["solved"] or not best:
        return None
    return (side["cost"] - best) / abs(best)


