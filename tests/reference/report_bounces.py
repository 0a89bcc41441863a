"""Writes results/trade/bounces.md: whether bounces pay for the accuracy asked and no more, body by body.

python tests/reference/report_bounces.py      # a minute
"""

from pathlib import Path

import numpy as np

import explorer as ex

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
ACCURACIES = 10.0 ** -np.arange(2, 11)
COUNT = 1000


def upright(disk, random):
    """States at the vertical, at any distance from F between 1e-8 and 1."""
    unit = disk.rate_unit
    eta = 10.0 ** random.uniform(-8.0, 0.0, COUNT) * random.choice([-1.0, 1.0], COUNT)
    bar, speed = random.uniform(-1.5, 1.5, COUNT), random.uniform(0.3, 2.0, COUNT)
    return ex.constants_to_states(disk, unit * bar, unit * eta, unit * speed)


def anywhere(disk, random):
    """States all over the phase space, most of which do not cross the vertical."""
    rates = disk.rate_unit * random.uniform(-1.0, 1.0, (3, COUNT))
    return ex.phi_to_states(disk, random.uniform(-1.4, 1.4, COUNT), *rates)


def errors(found, best):
    """The largest error of angles (rad), duration and theta_min (relative) of each state."""
    angles = [abs(getattr(found, name) - getattr(best, name)) for name in ("delta_chi", "delta_psi")]
    shares = [abs(getattr(found, name) / getattr(best, name) - 1.0) for name in ("duration", "theta_min")]
    return np.max([*angles, *shares], axis=0)[:, 0]


def row(disk, made):
    """Of each accuracy the 99th percentile over it; the largest error over its estimate; the least share answered.

    The best of each state is that of 1e-13, or of 1e-11 where rounding leaves no more.
    """
    states = made(disk, np.random.default_rng(8))
    best, second = (ex.bounces(states, accuracy=accuracy) for accuracy in (1e-13, 1e-11))
    sharp, known = best.ok[:, 0], (best.ok | second.ok)[:, 0]
    shares, optimism, answered = [], [], []
    for accuracy in ACCURACIES:
        found = ex.bounces(states, accuracy=accuracy)
        error = np.where(sharp, errors(found, best), errors(found, second))
        doubt = np.where(sharp, best.error_estimate[:, 0], second.error_estimate[:, 0])
        both = known & found.ok[:, 0]
        shares.append(np.percentile(error[both], 99) / accuracy)
        optimism.append((error / (found.error_estimate[:, 0] + doubt))[both].max())
        answered.append(found.ok.mean())
    return shares, max(optimism), min(answered)


def main():
    rows, every = [], []
    for name, disk in BODIES.items():
        for made in (upright, anywhere):
            shares, optimism, answered = row(disk, made)
            numbers = " | ".join(f"{share:.2g}" for share in shares)
            rows.append(f"| {name} | {made.__name__} | {numbers} | {optimism:.2g} | {answered:.1%} |")
            every += shares
            print(rows[-1], flush=True)
    less, more = (np.array(every) < 0.01).sum(), (np.array(every) > 1.0).sum()
    lines = [
        "# Bounces: the accuracy asked and the accuracy paid for",
        "",
        "Made by `python tests/reference/report_bounces.py`.",
        "",
        f"The 99th percentile of the true error over the accuracy asked, of {COUNT:,} motions for each row:",
        "between 0.01 and 1 the accuracy is met, and hardly more is paid for. *Error*: the largest of",
        "delta_chi and delta_psi (rad), duration and theta_min (relative) of the first bounce, against an",
        "accuracy of 1e-13, or 1e-11 where rounding leaves no more. *Over estimate*: the largest error over",
        "the sum of both estimates, at any accuracy. *Answered*: the least share of motions with an answer.",
        "",
        f"Of {len(every)} shares {less} lie below 0.01 and {more} above 1.",
        "",
        "| disk | states | " + " | ".join(f"{a:.0e}" for a in ACCURACIES) + " | over estimate | answered |",
        "|---" * (len(ACCURACIES) + 4) + "|",
        *rows,
    ]
    OUT.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
