"""Writes results/extremes/corners.md: error over estimate of passages drawn in the nastiest corners.

    python tests/reference/report_corners.py      # some ten minutes; needs python-flint

The truth is 60-digit arithmetic, `many_digits`. Draws come from a fixed seed; one in 27 of the bodies, with its
truth, is kept in corners.json for the tests.
"""

import json
import sys
from pathlib import Path

import many_digits
import numpy as np

import explorer as ex
from explorer.commands.made_by import leave_page

HERE = Path(__file__).parent
OUT = HERE.parents[1] / "results" / "extremes"
KEPT = HERE / "corners.json"
BODIES, PER_BODY = 68, 5  # for each corner
KEPT_EVERY = 27
ACCURACIES = {
    "quadrature": (1e-3, 1e-6, 1e-8, 1e-10),
    "rk4": (1e-3, 1e-5),
    "rk8": (1e-3, 1e-6, 1e-8),
    "dopri5": (1e-3, 1e-6),
    "dop853": (1e-3, 1e-6, 1e-8),
}
ANSWERS = ("theta_min", "delta_chi", "delta_psi", "duration")


def powers(rng, low, high, size=None):
    """Ten to the power of a number between low and high."""
    return 10.0 ** rng.uniform(low, high, size)


def any_body(rng):
    """I1 and I3 between a heavy core and nearly all thickness."""
    I1 = powers(rng, -1.5, 0.3)
    return I1, I1 * rng.uniform(0.3, 2.0)


def crest_speed(inertia, sigma3_bar, eta_hat, share):
    """Speed at the vertical with which the energy is 1 + share times that of the highest point on the way."""
    f = many_digits.Motion(inertia, sigma3_bar, eta_hat, 0.0)
    start = f.potential(f.end)
    highest = max(float(f.potential(f.end * float(x)) - start) for x in np.linspace(0.05, 1.0, 200))
    return float(np.sqrt(max(2.0 * highest / float(f.M) * (1.0 + share), 0.0)))


CORNERS = {  # name: body, |eta_hat|, phidot
    "slow start": (any_body, (-8, 0), (-9, -2)),
    "abs(eta_hat) near 1": (any_body, (-0.5, 0.5), (-3, 0.3)),
    "I1/(m r^2) from 1e-6 to 1e6": (None, (-6, 0), (-3, 0.3)),
    "I3 to 0": (None, (-6, 0), (-3, 0.3)),
    "separatrix": (any_body, (-1.5, 0), None),
    "all at once": (None, (-8, 0.5), (-9, 0.3)),
}


def body_in(corner, rng):
    """I1, I3 of a body for this corner."""
    if CORNERS[corner][0] is not None:
        return CORNERS[corner][0](rng)
    I1 = powers(rng, -2, 0) if corner == "I3 to 0" else powers(rng, -6, 6)
    return I1, I1 * (rng.uniform(0.3, 2.0) if corner.startswith("I1") else powers(rng, -6, 0.3))


def draws(corner, rng):
    """(inertia, sigma3_bar, eta_hat, phidot, face) for one body."""
    inertia = body_in(corner, rng)
    _body, eta, speed = CORNERS[corner]
    for _ in range(PER_BODY):
        sigma3_bar, eta_hat = rng.uniform(-2, 2), rng.choice([-1.0, 1.0]) * powers(rng, *eta)
        if speed is not None:
            phidot = powers(rng, *speed)
        else:
            share = rng.choice([-1.0, 1.0]) * powers(rng, -10, -1)
            phidot = crest_speed(inertia, sigma3_bar, eta_hat, share) or powers(rng, -9, -2)
        yield inertia, float(sigma3_bar), float(eta_hat), float(phidot), int(rng.choice([-1, 1]))


def truths(seed=5, bodies=BODIES):
    """Rows of all corners with their truth."""
    for number, corner in enumerate(CORNERS):
        for body in range(bodies):
            for inertia, *start, face in draws(corner, np.random.default_rng([seed, number, body])):
                try:
                    found = many_digits.passage(inertia, *start)
                except ArithmeticError:
                    found = None
                if found is None or not all(float(x.rad()) < 1e-15 * (1 + abs(float(x.mid()))) for x in found):
                    print("no truth:", corner, inertia, *start, file=sys.stderr)
                    continue
                row = {"corner": corner, "I1": inertia[0], "I3": inertia[1]}
                row |= dict(zip(("sigma3_bar", "eta_hat", "phidot"), start, strict=True)) | {"face": face}
                values = dict(zip(ANSWERS, (float(x.mid()) for x in found), strict=True))
                yield row | values | {"delta_psi": face * values["delta_psi"]}


def compared(rows, accuracy, method="quadrature"):
    """Status, largest error and estimate of every row."""
    status, error, estimate = np.zeros(len(rows), int), np.full(len(rows), np.nan), np.full(len(rows), np.nan)
    bodies = {}
    for i, row in enumerate(rows):
        bodies.setdefault((row["I1"], row["I3"]), []).append(i)
    for (I1, I3), at in bodies.items():
        start = [[rows[i][name] for i in at] for name in ("sigma3_bar", "eta_hat", "phidot", "face")]
        got = ex.passages(ex.Disk(I1=I1, I3=I3), *start, method=method, accuracy=accuracy)
        want = {name: np.array([rows[i][name] for i in at]) for name in ANSWERS}
        apart = [abs(getattr(got, name) - want[name]) for name in ("delta_chi", "delta_psi")]
        apart += [abs(getattr(got, name) / want[name] - 1.0) for name in ("duration", "theta_min")]
        status[at], error[at], estimate[at] = got.status, np.max(apart, axis=0), got.error_estimate
    return status, error, estimate


def table(rows):
    """Lines of the table."""
    corners = np.array([row["corner"] for row in rows])
    for method, accuracies in ACCURACIES.items():
        for accuracy in accuracies:
            status, error, estimate = compared(rows, accuracy, method)
            for corner in CORNERS:
                here = corners == corner
                ok = here & (status == ex.Status.OK)
                ratio = error[ok] / estimate[ok]
                most = (
                    f"{np.median(ratio):.2g} | {ratio.max():.2g} | {(ratio > 10).sum()}"
                    if ok.any()
                    else "- | - | -"
                )
                yield (
                    f"| {method} | {accuracy:g} | {corner} | {here.sum()} | {ok.sum() / here.sum():.1%} "
                    f"| {error[ok].max() if ok.any() else np.nan:.0e} | {most} |"
                )


def main():
    OUT.mkdir(parents=True, exist_ok=True)
    rows = list(truths())
    few = set(list(dict.fromkeys((row["I1"], row["I3"]) for row in rows))[::KEPT_EVERY])
    kept = [json.dumps(row) for row in rows if (row["I1"], row["I3"]) in few]
    KEPT.write_text("[\n" + ",\n".join(kept) + "\n]\n", encoding="utf-8")
    lines = [
        "# Errors and their estimates in the corners",
        "",
        "Made by `python tests/reference/report_corners.py`. Random passages on both faces against",
        "60-digit arithmetic that shares no code with the package. *Error*: the largest of angles (rad),",
        "duration and theta_min (relative), of those answered. *Median* and *largest* are of error over",
        "estimate; *over 10*: how many errors are more than ten times their estimate.",
        "",
        "| method | accuracy | corner | passages | answered | largest error | median | largest | over 10 |",
        "|---|---|---|---|---|---|---|---|---|",
        *table(rows),
    ]
    leave_page(OUT, lines, "python tests/reference/report_corners.py", name="corners.md")


if __name__ == "__main__":
    main()
