"""The whole comparison; started by benches/peers/run."""

import argparse
import json
from pathlib import Path

import agreement
import builds
import claims
import machine
import measurement
import report
import robots
import symbolic

ROOT = Path(__file__).resolve().parents[3]


def arguments():
    parser = argparse.ArgumentParser(prog="benches/peers/run", description="costate beside Pinocchio and CasADi")
    parser.add_argument("--cache", type=Path, required=True, help=argparse.SUPPRESS)
    parser.add_argument("--write", action="store_true", help="write the tables of BENCHMARKS.md")
    parser.add_argument("--floating", action="store_true", help="robots with a floating base, in parts of their own")
    parser.add_argument("--robots", nargs="*", choices=robots.FIXED + robots.FREE, metavar="ROBOT",
                        help="of " + ", ".join(robots.FIXED) + "; with --floating of " + ", ".join(robots.FREE))
    parser.add_argument("--quantities", nargs="*", default=[], choices=report.TITLES, metavar="QUANTITY",
                        help="all, or of " + ", ".join(report.TITLES))
    parser.add_argument("--peers", nargs="*", choices=builds.PEERS, metavar="PEER",
                        help="of " + ", ".join(builds.PEERS))
    parser.add_argument("--forms", nargs="*", default=list(symbolic.LARGEST), choices=symbolic.LARGEST, metavar="FORM",
                        help="CasADi's: of " + ", ".join(symbolic.LARGEST))
    parser.add_argument("--flags", nargs="*", default=list(builds.FLAGS), choices=builds.FLAGS, metavar="FLAGS",
                        help="costate's: of " + ", ".join(builds.FLAGS))
    parser.add_argument("--compilers", nargs="+", default=machine.chosen, choices=machine.COMPILERS, metavar="COMPILER",
                        help="of " + ", ".join(machine.COMPILERS))
    parser.add_argument("--states", type=int, default=16, help="random states a robot (16)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--batches", type=int, default=12, help="batches a round (12)")
    parser.add_argument("--rounds", type=int, default=3, help="processes one after the other (3)")
    parser.add_argument("--milliseconds", type=float, default=1.0, help="length of a batch (1)")
    parser.add_argument("--tolerance", type=float, default=1e-9, help="largest relative difference of values (1e-9)")
    parser.add_argument("--from", dest="source", type=Path, metavar="FILE", help="no run: report the figures in FILE")
    options = parser.parse_args()
    all_robots = robots.FREE if options.floating else robots.FIXED
    options.robots = all_robots if options.robots is None else options.robots
    if not set(options.robots) <= set(all_robots):
        parser.error("robots with a floating base go with --floating, others without")
    # CasADi's formulations have no quaternions; generated code is compared on fixed bases.
    with_floating = ("pinocchio", "costate")
    if options.peers is None:
        options.peers = list(with_floating if options.floating else builds.PEERS)
    if options.floating and not set(options.peers) <= set(with_floating):
        parser.error(f"with --floating there are {' and '.join(with_floating)}")
    return options


def main():
    options = arguments()
    machine.chosen[:] = options.compilers
    of = claims.FREE_CLAIMS if options.floating else claims.CLAIMS
    file = options.source or options.cache / ("floating.jsonl" if options.floating else "figures.jsonl")
    if options.source is None:
        figures = [machine.describe(options)]
        prepared = []
        for name in options.robots:
            robot = robots.prepare(ROOT, options.cache, name, options.states, options.seed)
            prepared.append((robot, builds.build(ROOT, options.cache, robot, options.peers, options.forms, options.flags)))
        for (robot, _), (times, values) in zip(prepared, measurement.run(options, prepared)):
            differences = agreement.check(robot.name, values, options.tolerance)
            figures += [{"robot": robot.name, "n": robot.n, **row} for row in times + differences]
            report.print_robot(robot.name, figures)
        file.write_text("".join(json.dumps(row) + "\n" for row in figures))
        print(f"\nfigures: {file}")
    figures = [json.loads(line) for line in file.read_text().splitlines()]
    right = agreement.right(figures)
    report.print_verdicts(right, of)
    if options.write:
        report.write(ROOT / "BENCHMARKS.md", right, of, options.floating)
    agreement.stop_at_disagreement(figures)


if __name__ == "__main__":
    main()
