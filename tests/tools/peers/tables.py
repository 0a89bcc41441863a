"""What the rows of a run say, as Markdown: nothing is in them that was not measured."""

import re

from tools.peers import cpp
from tools.peers.measuring import ASKED, METHODS, PEER, PUBLIC

INTEGRATED = tuple(f"passages, {method}" for method in METHODS)
QUADRATURE = "passages, quadrature"
FRONT = (
    "| speed of calls on one core at an error below 10⁻⁶, as a multiple of that of heyoka, a fast Taylor solver, "
    "in batches"
)
ORIGIN = "The speeds were measured in one run on "
REST = 1e-9  # the least error at which most peers have a row at all


def reaching(rows, names, target):
    """The fastest row of these with a 99th percentile within the target and every trajectory right, or None."""
    good = [row for row in rows if row.name in names and row.p99 <= target and row.wrong == row.unresolved == 0]
    return max(good, key=lambda row: row.rate, default=None)


def most_accurate(rows, name):
    """The row of a solver with the least 99th percentile, every trajectory right, or None."""
    good = [row for row in rows if row.name == name and row.wrong == row.unresolved == 0]
    return min(good, key=lambda row: row.p99, default=None)


def times(row, other):
    """How many times as fast one row is as another, in words; - where one of them is missing."""
    if row is None or other is None:
        return "-"
    ratio = row.rate / other.rate
    return f"{ratio:.1f}" if ratio < 100 else f"{ratio:,.0f}"


def asked_at(rows, name, accuracy):
    """The row of a public call at the accuracy asked, if it holds it with every trajectory right, or None."""
    return reaching([row for row in rows if row.setting == accuracy], (name,), accuracy)


def best_asked(rows, names, accuracy):
    """The fastest of several public calls at that accuracy, or None."""
    held = [asked_at(rows, name, accuracy) for name in names]
    return max(filter(None, held), key=lambda row: row.rate, default=None)


def names_of(rows, kind):
    """Solvers of a kind, in their order."""
    return list(dict.fromkeys(row.name for row in rows if row.kind == kind))


def _table(heads, lines):
    return [f"| {' | '.join(heads)} |", "|---" * len(heads) + "|", *(f"| {' | '.join(line)} |" for line in lines)]


def public_calls(rows):
    """What was asked of each call, what it gave, and how many times as fast as heyoka in batches it is."""
    heads = ("call", "accuracy asked", "99th percentile", "not resolved", "wrong way", "passages/s")
    heads += ("× heyoka batch, plain", "× heyoka batch, regularised")
    heyoka = [f"heyoka batch, {kind}" for kind in ("plain", "regularised")]
    lines = []
    for row in rows:
        if row.kind == PUBLIC:
            own = row if row.p99 <= row.setting and row.wrong == row.unresolved == 0 else None
            peers = [reaching(rows, (name,), row.setting) for name in heyoka]
            if row.name == QUADRATURE and row.setting < REST:
                peers = [most_accurate(rows, name) for name in heyoka]
            said = (f"{row.setting:g}", f"{row.p99:.0e}", f"{row.unresolved}", f"{row.wrong}", f"{row.rate:,.0f}")
            lines.append((row.name, *said, *(times(own, peer) for peer in peers)))
    return _table(heads, lines)


def ratios(rows):
    """How many times as fast as each peer: the best integrator of `passages`, `simulate`, and quadrature."""
    heads = ["peer"]
    heads += [f"{call}, {accuracy:g}" for call in ("integrated", "simulate") for accuracy in ASKED]
    heads += ["quadrature, 0.001", "quadrature, 1e-06", "quadrature, 1e-11, peer at 1e-09", "peer at its best"]
    lines = []
    exact = asked_at(rows, QUADRATURE, 1e-11)
    for name in names_of(rows, PEER):
        peers = [reaching(rows, (name,), accuracy) for accuracy in ASKED]
        cells = [times(best_asked(rows, INTEGRATED, at), peer) for at, peer in zip(ASKED, peers, strict=True)]
        cells += [times(asked_at(rows, "simulate", at), peer) for at, peer in zip(ASKED, peers, strict=True)]
        cells += [times(asked_at(rows, QUADRATURE, at), peer) for at, peer in zip(ASKED[:2], peers, strict=False)]
        cells += [times(exact, peers[2]), times(exact, most_accurate(rows, name))]
        lines.append((name, *cells))
    return _table(heads, lines)


def quoted(rows):
    """The row of the front page: the public calls at 1e-6 against heyoka in batches, plain and regularised."""
    peers = [reaching(rows, (f"heyoka batch, {kind}",), 1e-6) for kind in ("plain", "regularised")]
    exact, integrated = asked_at(rows, QUADRATURE, 1e-6), best_asked(rows, INTEGRATED, 1e-6)
    (plain, regular), (stepped, easier) = ([times(ours, peer) for peer in peers] for ours in (exact, integrated))
    said = "if heyoka solves the plain equations: quadrature, which computes a passage as an integral, "
    said += f"{plain}, and our Runge–Kutta {stepped}; if it solves our equations, which stay smooth at flat: "
    said += f"{regular} and {easier}"
    return f"{FRONT} | {said} | 1 |"


def with_quoted(text, rows, where):
    """The front page with the row of this run and the machine that it ran on; all else is left as it is."""
    lines = text.split("\n")
    for begin, line in ((FRONT, quoted(rows)), (ORIGIN, None)):
        (place,) = (i for i, old in enumerate(lines) if old.startswith(begin))
        lines[place] = line or re.sub(rf"^{ORIGIN}.*? \(", f"{ORIGIN}{where} (", lines[place])
    return "\n".join(lines)


def every(rows):
    """All rows."""
    heads = ("solver", "setting", "median error", "99th percentile", "wrong way", "unresolved", "trajectories/s")
    lines = [
        (row.name, f"{row.setting:g}", f"{row.median:.0e}", f"{row.p99:.0e}", f"{row.wrong}", f"{row.unresolved}",
         f"{row.rate:,.0f}")
        for row in rows
    ]  # fmt: skip
    return _table(heads, lines)


def loop_in_words():
    """What the loop in C++ is, or why it is not here."""
    if cpp.compiler() is None:
        return f"C++: {cpp.NO_COMPILER}."
    return (
        "C++: `tests/tools/peers/fixed_steps.cpp` has our Runge-Kutta coefficients and our equations, for several"
        " motions side by side (in lanes). It is compiled with"
        f" `{' '.join(cpp.options(False)[1:])}` (its steps differ from ours by rounding) or"
        " `-ffp-contract=fast`. It does not put its steps back onto the constants of motion. It locates no"
        " events: it is told the s at which each motion ends."
    )
