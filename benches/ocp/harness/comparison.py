"""One task solved by every side, judged, and set beside the best cost known."""

import math
from dataclasses import replace

import numpy

from classes import CLASSES
from fatrop import FINEST

# The peer's mesh for the best cost is this many times finer.
FINER = 4
# Starts among which the best cost is looked for: the answers found, and this many bent lines.
BENT = 3
# A cost that is this much above the best one known is another motion, relative; ..
NEAR = 1e-4
# .. so many starts tell whether costate finds the best one.
STARTS = 16
# Largest violation between points of a motion whose cost counts, in parts of the range: one that cuts a corner is no cheaper
# motion. Torques overshoot where they jump, which changes the cost little.
BETWEEN, BETWEEN_JUMPS = 1e-4, 1e-2
# Largest gap at which the cost of an answer counts as it is.
CLOSE = 1e-6
# A solver that took longer than this (s) is not repeated.
LONG = 2.0
# Both sides solve once, each time in a new process or with a new solver object of CasADi, and where they are repeated so many
# times in one: machine code of costate is there then, memory of IPOPT too.
TIMES = 3
# Sides whose answers count for the best cost known, and costate with the options of its command.
COUNTED, DEFAULT = ("peer", "costate", "accurate", FINEST), "default"


class Comparison:
    def __init__(self, peers, ours, meshes, judge, options):
        """`peers`, each with its number of intervals, `ours` and `meshes`, peers on the mesh of costate's first answer, by label;
        "peer" also finds the best costs."""
        self.peers, self.ours, self.meshes, self.judge, self.options = peers, ours, meshes, judge, options

    def run(self, task):
        """The row of figures of one task."""
        answers = self.answers(task)
        row = {"task": task.name, "class": task.kind, "title": CLASSES[task.kind][0], "robot": task.robot.name, "n": task.n,
               "elements": self.options.elements, "draws": task.draws, "peer_failed": task.peer_failed}
        judge = lambda label, answer: self.judge.judge(task, answer.motion) if answer.solved and label != DEFAULT else None
        row["sides"] = {label: self.side(answer, judge(label, answer), label != DEFAULT) for label, answer in answers.items()}
        self.with_times(answers, row["sides"])
        row["best"], row["best_by"] = self.best(task, answers, row["sides"]) if self.options.best else (None, None)
        row["starts"] = self.starts(task, row)
        return row

    def answers(self, task):
        """Of all sides, by label."""
        # Compiled before anything is timed.
        for peer in [*(peer for peer, _ in self.peers.values()), *self.meshes.values()]:
            peer.prepare(task)
        sides = {label: (lambda again, peer=peer, count=count: peer.solve(task, count, times=TIMES if again else 1))
                 for label, (peer, count) in self.peers.items()}
        sides |= {label: (lambda again, ours=ours: ours.solve(task, TIMES if again else 1))
                  for label, ours in self.ours.items()}
        answers = {}
        first = next(iter(self.ours))
        sides |= {label: (lambda again, same=same: same.solve(task, answers[first], TIMES if again else 1))
                  for label, same in self.meshes.items()}
        # In turn, so that whatever slows the machine down slows all.
        for number in range(self.options.repeats):
            for label, solve in sides.items():
                earlier = answers.get(label)
                if earlier and (earlier.seconds > LONG or not earlier.solved or label == DEFAULT):
                    continue
                answer = solve(number > 0)
                if earlier is None:
                    answers[label] = answer
                elif answer.seconds < earlier.seconds:
                    # With start: where it solved once.
                    answers[label] = replace(answer, process_seconds=earlier.process_seconds)
        return answers

    def beside(self, task):
        """The sides of the peers on costate's mesh and, without the judge, of costate at its first tolerance."""
        answers = self.answers(task)
        judge = lambda label, answer: self.judge.judge(task, answer.motion) if label in self.meshes else None
        return self.with_times(answers, {label: self.side(answer, judge(label, answer), label in self.meshes)
                                         for label, answer in answers.items()})

    def with_times(self, answers, sides):
        """Peers on costate's mesh know the time of costate beside which they were measured (ms)."""
        first = next(iter(self.ours))
        for label in self.meshes:
            sides[label]["beside_ms"] = round(1e3 * answers[first].seconds, 3)
        return sides

    def starts(self, task, row):
        """costate's cost from several starts where that from one is not the best one known; the best known then heeds it."""
        label, ours = next(iter(self.ours.items()))
        above = excess(row, label)
        if above is None or above <= NEAR:
            return None
        answer = ours.solve(task, starts=STARTS)
        found = self.side(answer, self.judge.judge(task, answer.motion))
        if not found["solved"]:
            return None
        if found["gap"] <= CLOSE and found["cost"] < row["best"]:
            row["best"], row["best_by"] = found["cost"], "starts"
        return found["cost"]

    def side(self, answer, judgement, judged=True):
        """The figures of an answer; one that is not judged is as its solver says."""
        accepted = bool(judgement and judgement.accepted()) or not judged
        found = {"status": answer.status, "says": answer.solved, "solved": answer.solved and accepted,
                 "told": number(answer.cost), "duration": number(answer.duration), "iterations": answer.iterations,
                 "ms": round(1e3 * answer.seconds, 3), "process_ms": round(1e3 * answer.process_seconds, 3)}
        if not judged:
            found["cost"] = found["told"]
        if judgement:
            for key in ("cost", "gap", "cut", "end", "held", "at_points", "between", "states"):
                found[key] = number(getattr(judgement, key))
        return found

    def best(self, task, answers, sides):
        """Least cost among those with a small error, and whose it is: the peer's on a finer mesh from several starts, and
        answers that obey the dynamics closely. Where the peer is slow, finer meshes are left out."""
        peer, _ = self.peers["peer"]
        solved = {label: sides[label] for label in COUNTED if label in sides and sides[label]["solved"]}
        coarse = [answers[label] for label in solved]
        most = BETWEEN_JUMPS if numpy.isfinite(task.u_max).any() else BETWEEN
        costs = [(side["cost"], label) for label, side in solved.items() if side["gap"] <= CLOSE and side["between"] <= most]
        if answers["peer"].seconds > LONG:
            coarse = []
        else:
            coarse.append(peer.cheapest(task, self.options.elements, 1 + BENT))
        if coarse and task.obstacles:
            coarse.append(peer.solve(task.but(obstacles=[]), self.options.elements))
        for start in coarse:
            if start.motion is not None:
                fine = peer.solve(task, FINER * self.options.elements, start.motion)
                judgement = self.judge.judge(task, fine.motion) if fine.solved else None
                if judgement and judgement.accepted() and judgement.between <= most:
                    costs.append((fine.cost, "peer, finer mesh"))
        return min((pair for pair in costs if math.isfinite(pair[0])), default=(None, None))


def number(value):
    """None for what JSON cannot hold."""
    return float(value) if value is not None and math.isfinite(value) else None


def excess(row, label):
    """Cost above the best one known, relative; None where one of the two is missing."""
    side, best = row["sides"].get(label), row["best"]
    if not side or not side["solved"] or not best:
        return None
    return (side["cost"] - best) / abs(best)


