"""Writes results/extremes/corners.md: error over estimate of passages drawn in the nastiest corners.

    python tests/tools/report_corners.py      # some twenty minutes; needs python-flint

The truth is 40-digit arithmetic, `many_digits`. Draws come from a fixed seed.
"""

import math
import sys
from pathlib import Path

import many_digits
import numpy as np
from flint import arb

import explorer as ex

OUT = Path(__file__).parents[2] / "results" / "extremes"
BODIES, PER_BODY = 68, 5  # for each corner
ACCURACIES = {
    "quadrature": (1e-3, 1e-6, 1e-8, 1e-10),
    "rk4": (1e-3, 1e-5),
    "rk8": (1e-3, 1e-6, 1e-8),
    "dopri5": (1e-3, 1e-6),
    "dop853": (1e-3, 1e-6, 1e-8),
}
ANSWERS = ("theta_min", "delta_chi", "delta_psi", "duration")
GIVEN = ("I1", "I3", "sigma3_bar", "eta_hat", "phidot")
UNIT = 2.0**-52


def powers(rng, low, high, size=None):
    """Ten to the power of a number between low and high."""
    return 10.0 ** rng.uniform(low, high, size)


def any_body(rng):
    """I1 and I3 between a heavy core and nearly all thickness."""
    I1 = powers(rng, -1.5, 0.3)
    return I1, I1 * rng.uniform(0.3, 2.0)


def crest_speed(inertia, sigma3_bar, eta_hat, share):
    """Speed at the vertical with which the energy is 1 + share times that of the highest point on the way."""
    of = many_digits.body(*inertia)
    constants = arb(sigma3_bar) / of.r0, of.k * of.r0 * arb(eta_hat)
    V = np.array([float(of.at(arb(x), *constants).V) for x in np.linspace(-3.0, 0.0, 200)])
    return float(np.sqrt(max(2.0 * (V.max() - V[-1]) / float(of.M) * (1.0 + share), 0.0)))


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
                    passage, fall = truth(inertia, *start)
                except ArithmeticError:
                    print("no truth:", corner, inertia, *start, file=sys.stderr)
                    continue
                row = {"corner": corner, "I1": inertia[0], "I3": inertia[1]}
                row |= dict(zip(("sigma3_bar", "eta_hat", "phidot"), start, strict=True)) | {"face": face}
                values = dict(zip(ANSWERS, (float(x) for x in passage), strict=True))
                values["fall_angle"] = None if fall is None else float(fall)
                yield row | values | {"delta_psi": face * values["delta_psi"]}


def truth(inertia, sigma3_bar, eta_hat, phidot):
    """The passage on face +1 and its fall angle in 40 digits."""
    found = many_digits.from_constants(inertia, 0.0, phidot, sigma3_bar, eta_hat)
    return found.stretches[0], found.fall_angle


def condition(row):
    """How far the answers move, in all, when each of the numbers given moves by one unit of its rounding."""
    moved = np.zeros(len(ANSWERS) + 1)
    for name in (None, *GIVEN):
        I1, I3, *start = (row[each] * (1.0 + UNIT * (each == name)) for each in GIVEN)
        passage, fall = truth((I1, I3), *start)
        if fall is None:
            return math.inf
        found = passage.theta_min.log(), passage.chi, passage.psi, passage.time.log(), fall
        if name is None:
            first = found
        moved += [abs(float((x - y).mid())) for x, y in zip(found, first, strict=True)]
    return moved.max()


def compared(rows, accuracy, method="quadrature"):
    """Status, largest error and estimate of every row."""
    status, error, estimate = np.zeros(len(rows), int), np.full(len(rows), np.nan), np.full(len(rows), np.nan)
    bodies = {}
    for i, row in enumerate(rows):
        bodies.setdefault((row["I1"], row["I3"]), []).append(i)
    for (I1, I3), at in bodies.items():
        start = [[rows[i][name] for i in at] for name in ("sigma3_bar", "eta_hat", "phidot", "face")]
        got = ex.passages(ex.Disk(I1=I1, I3=I3), *start, method=method, accuracy=accuracy)
        want = {name: np.array([rows[i][name] for i in at], float) for name in (*ANSWERS, "fall_angle")}
        apart = [abs(getattr(got, name) - want[name]) for name in ("delta_chi", "delta_psi", "fall_angle")]
        apart += [abs(getattr(got, name) / want[name] - 1.0) for name in ("duration", "theta_min")]
        status[at], error[at], estimate[at] = got.status, np.max(apart, axis=0), got.error_estimate
    return status, error, estimate


def table(rows):
    """Lines of the table."""
    corners = np.array([row["corner"] for row in rows])
    falls = np.array([row["fall_angle"] is not None for row in rows])
    lines, conditions = [], {}
    for method, accuracies in ACCURACIES.items():
        for accuracy in accuracies:
            status, error, estimate = compared(rows, accuracy, method)
            possible = falls.copy()
            if method == "quadrature":
                refused = np.flatnonzero(falls & (status != ex.Status.OK))
                for i in refused:
                    conditions[i] = conditions.get(i) or condition(rows[i])
                    possible[i] = conditions[i] <= accuracy
            for corner in CORNERS:
                here = corners == corner
                ok = here & (status == ex.Status.OK)
                share = (ok & possible).sum() / (here & possible).sum()
                lines.append(
                    f"| {method} | {accuracy:g} | {corner} | {here.sum()} | {ok.sum() / here.sum():.1%} "
                    f"| {share:.1%} {ratios(error[ok], estimate[ok])}"
                )
    return lines


def ratios(error, estimate):
    """The end of a line."""
    if not error.size:
        return "| - | - | - | - |"
    ratio = error / estimate
    return f"| {error.max():.0e} | {np.median(ratio):.2g} | {ratio.max():.2g} | {(ratio > 10).sum()} |"


def main():
    OUT.mkdir(parents=True, exist_ok=True)
    rows = list(truths())
    page = [
        "# Errors and their estimates in the corners",
        "",
        "Made by `python tests/tools/report_corners.py`. Random passages on both faces are compared with",
        "40-digit arithmetic that shares no code with the package. The error of a passage is the largest of",
        "those of its angles (rad), of the angles of its limit motion, of the duration and of theta_min",
        "(relative). *Largest error* is of the passages that are answered. *Median* and *largest* are of the",
        "ratio of error to estimate. *Over 10*: how many errors are more than ten times their estimate.",
        "",
        "*Of those that can be*: the share that is answered of the passages that have an answer of that",
        "accuracy. Two kinds of passages have none. Some have no limit motion of their energy, from which the",
        "race is measured. For others, one unit of rounding in the five given numbers changes the answer by more",
        "than the accuracy.",
        "",
        "| method | accuracy | corner | passages | answered | of those that can be | largest error | median "
        "| largest | over 10 |",
        "|---|---|---|---|---|---|---|---|---|---|",
        *table(rows),
    ]
    (OUT / "corners.md").write_text("\n".join(page) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
