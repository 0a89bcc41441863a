"""Writes results/trade/bounces.md: whether bounces have the accuracy asked, and how much more, body by body.

python tests/reference/report_bounces.py      # three minutes
"""

import sys
from pathlib import Path

import numpy as np

import explorer as ex

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shares import ACCURACIES, anywhere, counted, line_of, near_flat, share_of, slow, table_of, upright

OUT = Path(__file__).parents[2] / "results" / "trade" / "bounces.md"
BODIES = {
    "uniform": ex.Disk.uniform(),
    "hoop": ex.Disk.hoop(),
    "matching": ex.Disk.matching(),
    "annulus": ex.Disk.annulus(0.4),
    "coin": ex.Disk.uniform(m=5.67e-3, r=12.1e-3, g=9.81),
    **{
        f"I1 = {I1:g}, I3 = {I3:g}": ex.Disk(I1=I1, I3=I3)
        for I1, I3 in ((1e-3, 2e-3), (0.02, 0.04), (0.5, 0.3), (0.25, 0.02), (5.0, 3.0), (1e3, 2e3))
    },
}
COUNT = 1000


def apart(found, best):
    """Of each state the error of delta_chi, and the largest of angles (rad), duration and theta_min (relative)."""
    angles = [abs(getattr(found, name) - getattr(best, name)) for name in ("delta_chi", "delta_psi")]
    shares = [abs(getattr(found, name) / getattr(best, name) - 1.0) for name in ("duration", "theta_min")]
    return np.array([angles[0], np.max([*angles, *shares], axis=0)])[:, :, 0]


def row(disk, made):
    """The Share at each accuracy.

    The best of each state is that of 1e-13, or of 1e-11 where rounding leaves no more. Whether a bounce is
    answered is counted of all states, also where no best one is known.
    """
    states = made(disk, COUNT, 8)
    best, second = (ex.bounces(states, accuracy=accuracy) for accuracy in (1e-13, 1e-11))
    sharp, known = best.ok[:, 0], (best.ok | second.ok)[:, 0]
    doubt = np.where(sharp, best.error_estimate[:, 0], second.error_estimate[:, 0])
    shares = []
    for accuracy in ACCURACIES:
        found = ex.bounces(states, accuracy=accuracy)
        turned, errors = np.where(sharp, apart(found, best), apart(found, second))
        estimates, both = found.error_estimate[:, 0] + doubt, known & found.ok[:, 0]
        share = share_of(accuracy, errors, estimates, both, turned > disk.race_limit)
        shares.append(share._replace(answered=found.ok.mean()))
    return shares


def main():
    rows, lines = [], []
    for name, disk in BODIES.items():
        for made in (upright, anywhere, near_flat, slow):
            rows.append(row(disk, made))
            lines.append(line_of((name, made.__name__.replace("_", " ")), rows[-1]))
            print(lines[-1], flush=True)
    page = [
        "# Bounces: the accuracy asked and the accuracy paid for",
        "",
        "Made by `python tests/reference/report_bounces.py`. Passages and motions: [shares.md](shares.md).",
        "",
        f"The table gives the 99th percentile of the true error, divided by the accuracy asked, of {COUNT:,}",
        "motions for each row. Up to 1 the accuracy is met. Most entries are below 0.01, because doubling the",
        "nodes of a quadrature rule about squares its error, and estimates must not be smaller than errors. The",
        "error is the largest of those of delta_chi and delta_psi (rad), duration and theta_min (relative) of the",
        "first bounce. The reference is computed at an accuracy of 1e-13, or of 1e-11 where rounding allows no",
        "better. *Over estimate*: the largest ratio of an error to the sum of its estimate and that of the",
        "reference, at any accuracy. *Answered*: the least share of motions with an answer. *Wrong way*: answers",
        "at any accuracy whose delta_chi is off by more than a race, kappa pi. *Near flat*: tilts from 1e-7 to",
        "the vertical, log-uniform. *Slow*: speeds 1e-5 to 1 at the vertical.",
        "",
        counted(rows),
        "",
        *table_of(("disk", "states"), lines),
    ]
    OUT.write_text("\n".join(page) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
