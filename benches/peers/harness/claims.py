"""What the project claims about its peers, and whether the figures keep it."""

from statistics import median

ARMS = ("ur5", "panda")
CHAINS = ("chain12", "chain24", "chain48")
HUMANOIDS = ("humanoid32", "humanoid50", "talos")
EVERY = ARMS + CHAINS + HUMANOIDS
LONG = ("chain48",)
OTHERS = tuple(name for name in EVERY if name not in LONG)
TO_24 = ARMS + ("chain12", "chain24")
FLOATING = ("floating32", "floating50", "floating_talos")
STANDING = ("standing32", "standing50")

# claim, robots, quantity and labels of the peer, quantity and labels of costate, least ratio (None: reported only)
CLAIMS = (
    ("generic F at least as fast as Pinocchio's aba", ARMS, "a", "pinocchio", "F", "costate-native", 1.0),
    ("generic forward dynamics a(q, v, u) beside Pinocchio's aba", EVERY, "a", "pinocchio", "a", "costate-native", None),
    ("generic F and F_x together at least 3 times as fast as computeABADerivatives", ARMS, "a_z", "pinocchio", "F_x",
     "costate-native", 3.0),
    ("generic F and F_x together at least twice as fast as computeABADerivatives", CHAINS + HUMANOIDS, "a_z", "pinocchio",
     "F_x", "costate-native", 2.0),
    ("generic a, a_z, y'a_zz in at most the time of computeABADerivatives", OTHERS, "a_z", "pinocchio", "y_a_zz",
     "costate-native", 1.0),
    ("generic a, a_z, y'a_zz in at most 1.2 times the time of computeABADerivatives", LONG, "a_z", "pinocchio", "y_a_zz",
     "costate-native", 1 / 1.2),
    ("generic tau, tau_z, w'tau_zz in at most 0.7 of the time of computeABADerivatives", TO_24, "a_z", "pinocchio",
     "w_tau_zz", "costate-native", 1 / 0.7),
    ("generic tau, tau_z, w'tau_zz in at most 0.55 of the time of computeABADerivatives", LONG + HUMANOIDS, "a_z",
     "pinocchio", "w_tau_zz", "costate-native", 1 / 0.55),
    ("generic F, F_x, y'F_xx in at most the time of computeABADerivatives", OTHERS, "a_z", "pinocchio", "y_F_xx",
     "costate-native", 1.0),
    ("generic F, F_x, y'F_xx in at most 1.2 times the time of computeABADerivatives", LONG, "a_z", "pinocchio", "y_F_xx",
     "costate-native", 1 / 1.2),
    ("generic tau and its Jacobian at least 1.9 times as fast as computeRNEADerivatives", EVERY, "tau_z", "pinocchio",
     "tau_z", "costate-native", 1.9),
    ("generic M beside crba", EVERY, "M", "pinocchio", "M", "costate-native", None),
    ("generic inverse of M beside computeMinverse", EVERY, "Minv", "pinocchio", "Minv",
     "costate-native", None),
    ("generic a and a_z beside computeABADerivatives", EVERY, "a_z", "pinocchio", "a_z", "costate-native", None),
    ("generic F, F_x, y'F_xx beside second-order inverse dynamics of Pinocchio", EVERY, "w_tau_zz", "pinocchio",
     "y_F_xx", "costate-native", None),
    ("generic Hessian of w.tau beside the tensors of second-order inverse dynamics", EVERY, "w_tau_zz", "pinocchio",
     "w_tau_zz", "costate-native", None),
    ("generated F, F_x at least 1.8 times as fast as CasADi's, written by an expert", ARMS, "F_x", "casadi:expert", "F_x",
     "generated", 1.8),
    ("generated F, F_x, y'F_xx at least 2.5 times as fast as CasADi's, written by an expert", ARMS, "y_F_xx",
     "casadi:expert", "y_F_xx", "generated", 2.5),
    ("generated F, F_x beside CasADi's, everything by differentiating L", ARMS, "F_x", "casadi:plain", "F_x", "generated", None),
    ("generated F, F_x, y'F_xx beside CasADi's, everything by differentiating L", ARMS, "y_F_xx", "casadi:plain", "y_F_xx",
     "generated", None),
    ("generated F beside CasADi's, written by an expert", ARMS, "F", "casadi:expert", "F", "generated", None),
    ("generated a, a_z beside CasADi's, written by an expert", ARMS, "a_z", "casadi:expert", "a_z", "generated", None),
    ("generated a, a_z, y'a_zz beside CasADi's, written by an expert", ARMS, "y_a_zz", "casadi:expert", "y_a_zz",
     "generated", None),
    ("generated F, F_x beside CasADi's, written by a user", ARMS, "F_x", "casadi:user", "F_x", "generated", None),
    ("generated F, F_x, y'F_xx beside CasADi's, written by a user", ARMS, "y_F_xx", "casadi:user", "y_F_xx", "generated", None),
    ("generic F, F_x beside CasADi's generated code, written by an expert", ARMS, "F_x", "casadi:expert", "F_x",
     "costate-native", None),
    ("generic F, F_x, y'F_xx beside CasADi's generated code, written by an expert", ARMS, "y_F_xx", "casadi:expert",
     "y_F_xx", "costate-native", None),
)

# The same of robots with a floating base.
FREE_CLAIMS = (
    ("generic F and F_x on a floating base at least twice as fast as computeABADerivatives", FLOATING, "a_z", "pinocchio",
     "F_x", "costate-native", 2.0),
    ("generic F and F_x on two feet at least twice as fast as computeConstraintDynamicsDerivatives", STANDING, "contact",
     "pinocchio", "contact", "costate-native", 2.0),
    ("generic F at least as fast as Pinocchio's aba", FLOATING, "a", "pinocchio", "F", "costate-native", 1.0),
    ("generic forward dynamics a(q, v, u) beside Pinocchio's aba", FLOATING, "a", "pinocchio", "a", "costate-native", None),
    ("generic a and a_z beside computeABADerivatives", FLOATING, "a_z", "pinocchio", "a_z", "costate-native", None),
    ("generic F, F_x, y'F_xx beside second-order inverse dynamics of Pinocchio", FLOATING, "w_tau_zz", "pinocchio",
     "y_F_xx", "costate-native", None),
    ("generic Hessian of w.tau beside the tensors of second-order inverse dynamics", FLOATING, "w_tau_zz", "pinocchio",
     "w_tau_zz", "costate-native", None),
    ("generic tau and its Jacobian at least 1.6 times as fast as computeRNEADerivatives", FLOATING, "tau_z", "pinocchio",
     "tau_z", "costate-native", 1.6),
    ("generic a, a_z, y'a_zz in at most 1.2 times the time of computeABADerivatives", FLOATING, "a_z", "pinocchio",
     "y_a_zz", "costate-native", 1 / 1.2),
    ("generic tau, tau_z, w'tau_zz in at most 0.6 of the time of computeABADerivatives", FLOATING, "a_z", "pinocchio",
     "w_tau_zz", "costate-native", 1 / 0.6),
    ("generic F, F_x, y'F_xx in at most 1.2 times the time of computeABADerivatives", FLOATING, "a_z", "pinocchio",
     "y_F_xx", "costate-native", 1 / 1.2),
    ("generic M beside crba", FLOATING, "M", "pinocchio", "M", "costate-native", None),
    ("generic inverse of M beside computeMinverse", FLOATING, "Minv", "pinocchio", "Minv", "costate-native", None),
)


def fastest(figures, robot, quantity, who):
    """The row with the smallest median among those whose label begins with `label`, way with `way` (`label:way`)."""
    label, _, way = who.partition(":")
    rows = [row for row in figures if row.get("robot") == robot and row.get("quantity") == quantity
            and row["label"].startswith(label) and row["way"].startswith(way)]
    return min(rows, key=lambda row: row["ns"], default=None)


def ratio(a, b):
    """How many times the time of b that of a is: the median over batches, of which those with one number ran one after
    the other, while the machine was as fast."""
    return median(x / y for x, y in zip(a["times"], b["times"], strict=True))


def verdicts(figures, claims=CLAIMS):
    """(claim, measured ratios as text, verdict) of every claim: what is missed or slower first, then what has a
    threshold."""
    rows = []
    for claim, robots, peer_quantity, peer, own_quantity, own, least in claims:
        ratios = {}
        for robot in robots:
            a, b = fastest(figures, robot, peer_quantity, peer), fastest(figures, robot, own_quantity, own)
            if a and b:
                ratios[robot] = ratio(a, b)
        text = ", ".join(f"{robot} {ratio:.2f}" for robot, ratio in ratios.items()) or "-"
        rows.append((claim, text, verdict(ratios, len(robots), least), least))
    rows.sort(key=lambda row: (row[2].startswith(("kept", "faster")), row[3] is None))
    return [row[:3] for row in rows]


def verdict(ratios, expected, least):
    if not ratios:
        return "not measured"
    if least is None:
        slower = sorted(robot for robot, ratio in ratios.items() if ratio < 1)
        return f"slower on {', '.join(slower)}" if slower else "faster"
    missed = sorted(robot for robot, ratio in ratios.items() if ratio < least)
    if missed:
        return f"**missed** on {', '.join(missed)}"
    return "kept" if len(ratios) == expected else "kept where measured"
