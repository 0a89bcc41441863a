"""Writes results/extremes/: the exact layer at the extremes against 40 digits.

    python tests/tools/report_extremes.py      # under a minute once compiled

Errors are of the angles (rad) and relative of duration and theta_min.
"""

import itertools
import sys
from pathlib import Path

import numpy as np

import explorer as ex

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from reference.motions import MOTIONS, PASSAGES, of_one_body

OUT = Path(__file__).parents[2] / "results" / "extremes"
LADDER = (1e-11, 1e-8, 1e-5, 1e-2)


def lines_of_kinds():
    """A line for each kind of passages of motions.csv, and for each decade of eta_hat of ordinary ones."""
    kinds = {kind: PASSAGES & (MOTIONS["kind"] == kind) for kind in np.unique(MOTIONS["kind"][PASSAGES])}
    ordinary, eta_hat = kinds.pop("passage"), abs(MOTIONS["eta_hat"])
    for low, high in itertools.pairwise((0.0, 1e-100, 1e-12, 1e-6, 1e-3, 2.0)):
        kinds[f"abs(eta_hat) from {low:g} to {high:g}"] = ordinary & (low <= eta_hat) & (eta_hat < high)
    for kind, chosen in kinds.items():
        found = [each for rows in of_one_body(chosen) for each in measured(MOTIONS[rows])]
        accuracy, angle, relative, estimate = np.array(found).T
        unmet = (accuracy != LADDER[0]).sum()
        most = " | ".join(f"{column.max():.0e}" for column in (angle, relative, estimate))
        yield f"| {kind} | {accuracy.size} | {unmet} | {most} |"


def measured(motions):
    """Of passages of one body: the tightest accuracy of the ladder that is met, the errors there, the estimate."""
    disk = ex.Disk(I1=motions["I1"][0], I3=motions["I3"][0])
    for row in motions:
        start = row["sigma3_bar"], row["eta_hat"], abs(row["phidot"]), row["face"]
        tried = (ex.passages(disk, *start, accuracy=accuracy) for accuracy in LADDER)
        got, accuracy = next(((got, a) for got, a in zip(tried, LADDER, strict=True) if got.ok), (None, None))
        if got is None:
            continue  # no limit motion has its energy
        angle = max(abs(got.delta_chi - row["chi_0"]), abs(got.delta_psi - row["psi_0"]))
        shares = got.duration / row["duration_0"] - 1.0, got.theta_min / row["theta_min_0"] - 1.0
        yield accuracy, angle, max(map(abs, shares)), got.error_estimate


def main():
    OUT.mkdir(parents=True, exist_ok=True)
    lines = [
        "# The extremes",
        "",
        "Made by `python tests/tools/report_extremes.py`; references by `tests/tools/make_motions.py`.",
        "Quadrature is compared with 40-digit arithmetic, with m = r = g = 1. Each row gives the largest errors",
        "among the passages of one kind; `tests/tools/make_motions.py` says what the kinds are. Each passage",
        "is computed at the finest accuracy that can be reached for it. *Not at 1e-11*: how many passages meet "
        "only 1e-8,",
        "1e-5 or 1e-2.",
        "",
        "| passages | number | not at 1e-11 | error of angles (rad) | of times, relative | estimate |",
        "|---|---|---|---|---|---|",
        *lines_of_kinds(),
    ]
    (OUT / "README.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
