"""FATROP's answers in the comparison: equal meshes, costate's mesh, two tolerances, and IPOPT on the same program."""

from peer import Peer
from same_mesh import SameMesh
from solvers import LOOSE, TIGHT, Fatrop, Ipopt
from staged import Staged

INTERVALS, TOLERANCES = (5, 10, 20, 40, 80), (TIGHT, LOOSE)
# IPOPT's label, and how those of FATROP begin.
IPOPT, PREFIX = "ipopt staged", "fatrop"


def label(mesh, tolerance=TIGHT):
    """`mesh` is a number of intervals, or "mesh" for costate's."""
    return f"{PREFIX} {mesh} {tolerance:g}"


# What stands beside other solvers, and what counts for the best cost known.
FATROP, FINEST = label(20), label(INTERVALS[-1])


def is_fatrop(name):
    return name.split()[0] == PREFIX


def sides(build, limit):
    """Peers with their numbers of intervals, and peers on the mesh of costate's first answer, by label; `build` makes the stages
    of a robot with so many spheres in its way."""
    ipopt = Peer(build, Ipopt(limit), Staged)
    # Stages are built once.
    by = {tolerance: Peer(ipopt.points, Fatrop(tolerance), Staged) for tolerance in TOLERANCES}
    equal = {label(count, tolerance): (peer, count) for count in INTERVALS for tolerance, peer in by.items()}
    return equal | {IPOPT: (ipopt, 20)}, {label("mesh", tolerance): SameMesh(peer) for tolerance, peer in by.items()}
