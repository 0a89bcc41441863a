"""Writes results/extremes/: the exact layer at the extremes against 30 digits, and its cost against eta.

    python tests/reference/report_extremes.py      # under a minute once compiled

Errors are of the angles (rad, divided by their size where that exceeds one) and relative of
duration and theta_min. Costs are ratios within this run to the cost at |eta_hat| = 0.1.
"""

import json
import time
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import explorer as ex

HERE = Path(__file__).parent
OUT = HERE.parents[1] / "results" / "extremes"
ACCURACY = 1e-11


def against_digits():
    for row in json.loads((HERE / "extremes.json").read_text(encoding="utf-8")):
        disk = ex.Disk(I1=row["I1"], I3=row["I3"])
        got = ex.passages(disk, row["sigma3_bar"], row["eta_hat"], row["phidot"], accuracy=ACCURACY)
        want = {key: float(row[key]) for key in ("delta_chi", "delta_psi", "duration", "theta_min")}
        errors = [abs(getattr(got, k)[0] - want[k]) / max(1.0, abs(want[k])) for k in ("delta_chi", "delta_psi")]
        errors += [abs(getattr(got, k)[0] / want[k] - 1.0) for k in ("duration", "theta_min")]
        yield (
            row["name"],
            ex.Status(got.status[0]).name.lower(),
            max(errors[:2]),
            max(errors[2:]),
            got.error_estimate[0],
        )


def rocking():
    """Periods near flat as E tends to V_0: T / sqrt(E - V_0) tends to 2^(3/2) sqrt(M) (after Lemma 5)."""
    disk = ex.Disk.uniform()
    b = disk.body
    for excess in (1e-3, 1e-6, 1e-9, 1e-12, 1e-15):
        states = ex.theta_to_states(disk, excess, 0.0, 0.5 * excess**2 / b.r0, 1.0 / (b.k * b.r0))
        got = ex.periods(states, 1e-9, eta_hat=1e-60)
        ratio = got.period[0] / np.sqrt(excess) / (2.0**1.5 * np.sqrt(b.M))
        yield excess, ex.Status(got.status[0]).name.lower(), ratio, got.error_estimate[0]


def costs():
    """Time per passage at each |eta_hat| over that at 0.1, for each method; medians of five."""
    disk, n = ex.Disk.uniform(), 20_000
    rng = np.random.default_rng(0)
    s3, speed = rng.uniform(-2, 2, n), rng.uniform(0.5, 2, n)
    for method, exponents in (
        ("quadrature", (-1, -2, -4, -8, -16, -32, -64, -128, -256, -300)),
        ("dopri5", (-1, -2, -4, -6, -8, -10)),
        ("rk4", (-1, -2, -4, -6, -8)),
    ):
        eta = [np.full(n, 10.0**k) for k in exponents]
        times = np.empty((5, len(eta)))
        for i in range(5):
            for j, value in enumerate(eta):
                start = time.perf_counter()
                ex.passages(disk, s3, value, speed, method=method, accuracy=1e-4)
                times[i, j] = time.perf_counter() - start
        middle = np.median(times, axis=0)
        yield method, 10.0 ** np.array(exponents, dtype=float), middle / middle[0]


def draw(found):
    figure = Figure(figsize=(6.4, 4.2), layout="constrained")
    ax = figure.subplots()
    for (method, eta, ratio), marker, colour in zip(found, "os^", ("#0072B2", "#D55E00", "#009E73"), strict=True):
        ax.semilogx(eta, ratio, marker=marker, color=colour, label=method)
    ax.set_xlim(1e1, 1e-303)
    ax.set_ylim(bottom=0.0)
    ax.set_xlabel(r"$|\hat\eta|$ (natural units), towards the falling set", fontsize=12)
    ax.set_ylabel("time per passage / that at 0.1", fontsize=12)
    ax.set_title("Cost against distance from the falling set, accuracy 1e-4", fontsize=12)
    ax.legend(fontsize=11)
    ax.grid(alpha=0.3)
    figure.savefig(OUT / "cost.png", dpi=150)


def main():
    OUT.mkdir(parents=True, exist_ok=True)
    lines = [
        "# The extremes",
        "",
        "Made by `python tests/reference/report_extremes.py`; references by `tests/reference/make_extremes.py`.",
        f"Quadrature at accuracy {ACCURACY:g} against 30-digit arithmetic, m = r = g = 1.",
        "",
        "| extreme | status | error of angles | error of times | estimate |",
        "|---|---|---|---|---|",
    ]
    for name, status, angle, scale, estimate in against_digits():
        lines.append(f"| {name} | {status} | {angle:.0e} | {scale:.0e} | {estimate:.0e} |")
    lines += [
        "",
        "Rocking near flat, eta_hat = 1e-60: period over its limit 2^(3/2) sqrt(M) sqrt(E - V0).",
        "",
        "| E - V0 | status | ratio - 1 | estimate |",
        "|---|---|---|---|",
    ]
    lines += [f"| {e:g} | {s} | {r - 1:+.1e} | {est:.0e} |" for e, s, r, est in rocking()]
    found = list(costs())
    draw(found)
    lines += ["", "Cost of a passage over that at |eta_hat| = 0.1, in one run:", ""]
    for method, eta, ratio in found:
        pairs = ", ".join(f"{e:.0e}: {r:.2f}" for e, r in zip(eta, ratio, strict=True))
        lines.append(f"- {method}: {pairs}")
    lines += ["", "![cost](cost.png)"]
    (OUT / "README.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
