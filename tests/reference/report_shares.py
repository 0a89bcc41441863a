"""Writes results/trade/shares.md: whether passages and motions in time pay for the accuracy asked and no more.

python tests/reference/report_shares.py      # some three minutes
"""

import sys
from pathlib import Path

import explorer as ex
from explorer.motion.reference_samples import RACING, ReferencePassages
from explorer.motion.vertical import starts_at_vertical

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from conftest import BODIES
from reference.motions import MOTIONS, PASSAGES, of_one_body
from shares import ACCURACIES, ENDS, INTEGRATORS, Curves, Motions, Passages, counted, line_of, table_of

OUT = Path(__file__).parents[2] / "results" / "trade" / "shares.md"
COUNT, CURVES, SEED = 10_000, 500, 21


def rows_of(samples, methods):
    """The Share at each accuracy, by method and body."""
    rows = {}
    for method in methods:
        for name in BODIES:
            rows[method, name] = [samples[name].share(method, accuracy) for accuracy in ACCURACIES]
            print(line_of((method, name), rows[method, name]), flush=True)
    return rows


def table(rows):
    return [counted(rows.values()), "", *table_of(("method", "disk"), [line_of(*item) for item in rows.items()])]


def doubt_of_rules():
    """The largest error of passages by adaptive rules, of those from usual starts that are known in 40 digits."""
    usual, errors = PASSAGES & (MOTIONS["kind"] == "passage") & (MOTIONS["I1"] > 0.01) & (MOTIONS["I3"] > 0.01), []
    for rows in of_one_body(usual):
        row = MOTIONS[rows]
        disk, given = ex.Disk(I1=row["I1"][0], I3=row["I3"][0]), (row["sigma3_bar"], row["eta_hat"])
        found = ReferencePassages(
            disk, starts_at_vertical(disk, *given, abs(row["phidot"]), row["face"].astype(float))
        ).exact
        errors += [found.delta_chi - row["chi_0"], found.delta_psi - row["psi_0"]]
        errors += [found.duration / row["duration_0"] - 1.0, found.theta_min / row["theta_min_0"] - 1.0]
    return max(abs(error).max() for error in errors)


def of_passages():
    samples = {name: Passages(disk, COUNT, SEED) for name, disk in BODIES.items()}
    known = sum(each.samples.known.sum() for each in samples.values())
    return [
        "## Passages",
        "",
        f"{COUNT:,} of each body, {known:,} in all with a known answer. The error is the largest of those of race",
        "angle, delta_chi, delta_psi (rad), duration and theta_min (relative). The reference is quadrature along",
        "arcs at 1e-11, which uses none of the tables. It differs from passages that are known in 40 digits",
        f"(`tests/reference/motions.csv`) by {doubt_of_rules():.0e} at most. *Over estimate* is here relative to",
        "the sum of both estimates.",
        "",
        *table(rows_of(samples, ("quadrature", *INTEGRATORS))),
    ]


def of_motions():
    samples = {name: Motions(disk, COUNT, SEED) for name, disk in BODIES.items()}
    known, doubt = (sum(s.known.sum() for s in samples.values()), max(s.doubt() for s in samples.values()))
    ends = ", ".join(f"{end:g}" for end in ENDS)
    return [
        "## Motions in time",
        "",
        f"{COUNT:,} of each body. A quarter of them ends at each of t = {ends} (natural units); a passage takes",
        f"about 2. {known:,} of them have a known answer and end outside of a race, with a tilt of {RACING:g} rad",
        "or more. The error is the largest of those of phi, chi, psi (rad) and path (r) at the end, divided by",
        "the number of passages. The reference is rk8 with far finer steps than any accuracy needs. The 99th",
        f"percentile of its difference from dop853 at its finest is {doubt:.0e}.",
        "",
        *table(rows_of(samples, INTEGRATORS)),
    ]


def of_curves():
    samples = {name: Curves(disk, CURVES, SEED) for name, disk in BODIES.items()}
    known = sum(s.known.sum() for s in samples.values())
    return [
        "## Curves",
        "",
        f"These are motions as `simulate` records them if no times are given: {CURVES:,} of each body, {known:,}",
        f"in all with a known answer. The error is the largest of those at {Curves.shares.size} moments on the",
        "way, outside of races. The estimate is that of the motion, and includes how far its points stray from",
        "the energy.",
        "",
        *table(rows_of(samples, INTEGRATORS)),
    ]


def main():
    page = [
        "# Passages and motions: the accuracy asked and the accuracy paid for",
        "",
        "Made by `python tests/reference/report_shares.py`. Bounces: [bounces.md](bounces.md).",
        "",
        "The tables give the 99th percentile of the true error, divided by the accuracy asked, for each method",
        "and body. Public calls are used. Up to 1 the accuracy is met. Below 0.01 the method does more work than",
        "necessary. Starts are at the vertical, with abs(eta_hat), the distance from the falling set F, from 1e-8",
        "to 1, log-uniform and on both sides, abs(sigma3_bar) up to 2, and phidot from 0.3 to 2 (natural units).",
        "*Over estimate*: the largest ratio of an error to its estimate, at any accuracy. *Answered*: the least",
        "share of samples with an answer. *Wrong way*: answers on the other side of F, at any accuracy.",
        "",
        *of_passages(),
        "",
        *of_motions(),
        "",
        *of_curves(),
    ]
    OUT.write_text("\n".join(page) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
