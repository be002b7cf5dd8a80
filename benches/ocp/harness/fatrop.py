"""FATROP's answers in the comparison: equal meshes, costate's mesh, three tolerances, and IPOPT on the same program."""

from peer import Peer
from same_mesh import SameMesh
from solvers import LOOSE, MIDDLE, TIGHT, Fatrop, Ipopt
from staged import Staged

INTERVALS, TOLERANCES = (5, 10, 20, 40, 80), (TIGHT, MIDDLE, LOOSE)
# IPOPT's label, and how those of FATROP begin.
IPOPT, PREFIX = "ipopt staged", "fatrop"


def label(mesh, tolerance=TIGHT):
    """`mesh` is a number of intervals, or "mesh" for costate's."""
    return f"{PREFIX} {mesh} {tolerance:g}"


# What stands beside other solvers, and what counts for the best cost known.
FATROP, FINEST = label(20), label(INTERVALS[-1])


def is_fatrop(name):
    return name.split()[0] == PREFIX


def sides(points, limit):
    """Peers with their numbers of intervals, and peers on the mesh of costate's first answer, by label; `points` makes those of
    a robot with so many spheres in its way."""
    by = {tolerance: Peer(points, Fatrop(tolerance), Staged) for tolerance in TOLERANCES}
    equal = {label(count, tolerance): (peer, count) for count in INTERVALS for tolerance, peer in by.items()}
    equal[IPOPT] = Peer(points, Ipopt(limit), Staged), 20
    return equal, {label("mesh", tolerance): SameMesh(peer) for tolerance, peer in by.items()}
