"""The points of the peer with costate's own functions inside: the C that `costate codegen` writes for a robot, called by
CasADi as externals. tau, tau_z and w'tau_zz come from there, clearances of obstacles from CasADi as before.

The same entries in the same places as `points.build`, compiled with the same flags: transcription, IPOPT and MUMPS see no
difference."""

import re
import subprocess

import casadi as ca
import numpy

import obstacles
from external import interface
from model import Model
from points import Points, entries, library
from shell import stop

# Quantity of `costate codegen`, alone, for each function of the points.
QUANTITIES = {"value": "inverse_dynamics", "jacobian": "tau_z", "hessian": "y_tau_zz"}
TOLERANCE = 1e-10
STATES = 5


def build(cache, costate, robot, spheres, own):
    """The functions of `own`, the peer's points, by costate; ends the comparison if they differ."""
    parts = clearances(robot, spheres) if spheres else {}
    found = {key: ca.external(key, str(library(cache, f"{robot.name}{spheres or ''}_inside_{key}",
                                               source(costate, robot, spheres, key, own, parts))))
             for key in QUANTITIES}
    inside = Points(*found.values(), own.jacobian_at, own.hessian_at, own.rows)
    check(robot, inside, own, spheres)
    return inside


def clearances(robot, spheres):
    """CasADi's functions of clearances alone, (z, par) or (z, par, lam) -> entries, and the places of these."""
    n = robot.n
    q, par = ca.SX.sym("q", n), ca.SX.sym("par", 4 * spheres)
    value = obstacles.clearances(Model(robot), q, par, spheres)
    lam, options = ca.SX.sym("lam", value.numel()), {"cse": True}
    jacobian, hessian = ca.jacobian(value, q), ca.tril(ca.hessian(ca.dot(lam, value), q)[0])
    places = lambda matrix: list(zip(*matrix.sparsity().get_triplet()))
    return {
        "value": (ca.Function("c_value", [q, par], [ca.densify(value)], options), None),
        "jacobian": (ca.Function("c_jacobian", [q, par], [entries(jacobian)], options), places(jacobian)),
        "hessian": (ca.Function("c_hessian", [q, par, lam], [entries(hessian)], options), places(hessian)),
    }


def generated(costate, robot, quantity):
    """The text of a quantity, its function made static, and the name of that."""
    command = [costate, "codegen", *robot.flags(), "--quantity", quantity, "--coordinates", "lagrangian", "--lang", "c",
               "--only", "--limit", "100000", robot.path]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        stop(f"costate codegen failed on {robot.name}: {done.stderr.strip()}")
    name = re.search(r"^void (\w+)\(", done.stdout, re.MULTILINE).group(1)
    return done.stdout.replace(f"void {name}(", f"static void {name}("), name


def source(costate, robot, spheres, key, own, parts):
    """C of one function of the points: costate's, CasADi's clearances, and the few lines that put their entries where the
    peer has its own."""
    n = robot.n
    text, name = generated(costate, robot, QUANTITIES[key])
    # What is computed, one after the other in the work vector; then the clearances; then a zero.
    size = {"value": n, "jacobian": 3 * n * n, "hessian": 5 * n * n}[key]
    clearance, places = parts.get(key, (None, None))
    zero = size + (clearance.nnz_out(0) if clearance else 0)
    at, more = numpy.array(where(key, n, own, size, places or [], zero)).T
    count = len(at)
    inputs = [3 * n, 4 * spheres] + [own.rows] * (key == "hessian")
    call = {"value": "w", "jacobian": "w", "hessian": f"arg[2] ? arg[2] : none, w, w + {4 * n * n}"}[key]
    if key == "hessian":
        call = "z, z + N, z + 2 * N, " + call
    else:
        call = f"z, z + N, z + 2 * N, {call}"
    work = [len(inputs), 1, 0, zero + 1]
    lines = [text]
    if clearance:
        generator = ca.CodeGenerator("clearances.c", {"with_header": False})
        generator.add(clearance)
        lines.append(generator.dump())
        work = [work[0] + clearance.sz_arg(), 1 + clearance.sz_res(), clearance.sz_iw(), work[3] + clearance.sz_w()]
    lines += [
        "#define INT long long int",
        f"#define N {n}",
        f"static const double none[{max(inputs)}] = {{0}};",
        f"static const int at[] = {{{', '.join(map(str, at))}}};",
        f"static const int more[] = {{{', '.join(map(str, more))}}};",
        f"int {key}(const double **arg, double **res, INT *iw, double *w, int mem) {{",
        "  const double *z = arg[0] ? arg[0] : none;",
        "  if (!res[0]) return 0;",
        f"  {name}({call});",
        f"  w[{zero}] = 0;",
    ]
    if clearance:
        third = ["  own[2] = arg[2] ? arg[2] + N : none;"] if key == "hessian" else []
        lines += [
            f"  const double **own = arg + {len(inputs)};",
            "  own[0] = z; own[1] = arg[1];", *third,
            f"  res[1] = w + {size};",
            f"  if ({clearance.name()}(own, res + 1, iw, w + {zero + 1}, mem)) return 1;",
        ]
    both = " + w[more[k]]" if (more != zero).any() else ""
    lines += [f"  for (int k = 0; k < {count}; k++) res[0][k] = w[at[k]]{both};", "  return 0;", "}"]
    shapes = {label: (rows, 1) for label, rows in zip(("z", "par", "lam"), inputs)}
    return "\n".join(lines + interface(key, shapes, (count, 1), work)) + "\n"


def where(key, n, own, size, places, zero):
    """Two places in the work vector for each entry of the peer, whose sum it is."""
    if key == "value":
        return [(k, zero) for k in range(own.rows)]
    clear = {place: size + k for k, place in enumerate(places)}
    if key == "jacobian":
        return [(3 * n * i + j if i < n else clear[i - n, j], zero) for i, j in zip(*own.jacobian_at)]
    # Lower triangle: (q, v) with itself, a with q; a with v and with a is zero.
    found = []
    for i, j in zip(*own.hessian_at):
        dynamics = 2 * n * i + j if i < 2 * n else 4 * n * n + n * (i - 2 * n) + j if j < n else zero
        found.append((dynamics, clear.get((i, j), zero)))
    return found


def check(robot, inside, own, spheres, seed=1):
    """All three functions at random states beside the peer's."""
    rng = numpy.random.default_rng([seed, robot.n, spheres])
    for _ in range(STATES):
        arguments = [rng.uniform(-1, 1, 3 * robot.n), rng.uniform(0.2, 1, 4 * spheres), rng.uniform(-1, 1, own.rows)]
        for key in QUANTITIES:
            given = arguments if key == "hessian" else arguments[:2]
            ours, theirs = (numpy.array(getattr(side, key)(*given)) for side in (inside, own))
            difference = abs(ours - theirs).max() / max(abs(theirs).max(), 1e-300) if len(theirs) else 0.0
            if not difference <= TOLERANCE:
                stop(f"{robot.name}: {key} by costate's code and by the peer's differ by {difference:.1e}")
