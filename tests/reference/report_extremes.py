"""Writes results/extremes/: the exact layer at the extremes against 30 digits, and its cost against eta.

    python tests/reference/report_extremes.py      # under a minute once compiled

Errors are of the angles (rad) and relative of duration and theta_min. Costs are ratios within this run
to the cost at |eta_hat| = 0.1.
"""

import json
import time
from pathlib import Path

import numpy as np

import explorer as ex
from explorer.commands.made_by import leave_page

HERE = Path(__file__).parent
OUT = HERE.parents[1] / "results" / "extremes"
LADDER = (1e-11, 1e-8, 1e-5, 1e-2)


# The row that is also done in other units: m (kg), r (m), g (m/s^2).
SCALED = "eta_hat = 1e-3"
SCALES = {
    "coin of 24 mm": (0.0057, 0.0121, 9.81),
    "disk of 2 km": (8e12, 1000.0, 9.81),
    "on the Moon": (1.0, 0.3, 1.62),
}


def rows():
    """The reference rows, one of them also in other units: name, row, (m, r, g)."""
    for row in json.loads((HERE / "extremes.json").read_text(encoding="utf-8")):
        yield row["name"], row, (1.0, 1.0, 1.0)
        if row["name"] == SCALED:
            for name, scale in SCALES.items():
                yield name, row, scale


def measure(row, scale):
    """The tightest accuracy of the ladder that is met, and there: status, errors of angles and of scales,
    estimate. Unresolved at all of them: the last one's answer."""
    m, r, g = scale
    rate = (g / r) ** 0.5
    disk = ex.Disk(m, r, g, row["I1"] * m * r * r, row["I3"] * m * r * r)
    start = (row["sigma3_bar"] * rate, row["eta_hat"] * rate, row["phidot"] * rate)
    for accuracy in LADDER:
        got = ex.passages(disk, *start, accuracy=accuracy)
        if got.status[0] == ex.Status.OK:
            break
    want = {key: float(row[key]) for key in ("delta_chi", "delta_psi", "duration", "theta_min")}
    want["duration"] /= rate
    angle = max(abs(getattr(got, key)[0] - want[key]) for key in ("delta_chi", "delta_psi"))
    relative = max(abs(getattr(got, key)[0] / want[key] - 1.0) for key in ("duration", "theta_min"))
    return accuracy, ex.Status(got.status[0]), angle, relative, got.error_estimate[0]


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


def main():
    OUT.mkdir(parents=True, exist_ok=True)
    lines = [
        "# The extremes",
        "",
        "Made by `python tests/reference/report_extremes.py`; references by `tests/reference/make_extremes.py`.",
        "Quadrature against 34-digit arithmetic, m = r = g = 1 unless said. *Accuracy*: the tightest of 1e-11,",
        "1e-8, 1e-5 and 1e-2 that is met; where none is, the status says so and no number is given.",
        "",
        "| extreme | accuracy | status | error of angles (rad) | of times, relative | estimate |",
        "|---|---|---|---|---|---|",
    ]
    for name, row, units in rows():
        accuracy, status, angle, relative, estimate = measure(row, units)
        ok = status == ex.Status.OK
        shown = f"{angle:.0e} | {relative:.0e} | {estimate:.0e}" if ok else "- | - | -"
        lines.append(f"| {name} | {accuracy if ok else 'none'} | {status.name.lower()} | {shown} |")
    lines += [
        "",
        "Rocking near flat, eta_hat = 1e-60: period over its limit 2^(3/2) sqrt(M) sqrt(E - V0).",
        "",
        "| E - V0 | status | ratio - 1 | estimate |",
        "|---|---|---|---|",
    ]
    lines += [f"| {e:g} | {s} | {r - 1:+.1e} | {est:.0e} |" for e, s, r, est in rocking()]
    lines += [
        "",
        "Cost of a passage over that at |eta_hat| = 0.1, in one run (picture: `../scaling/cost.png`):",
        "",
    ]
    for method, eta, ratio in costs():
        pairs = ", ".join(f"{e:.0e}: {r:.2f}" for e, r in zip(eta, ratio, strict=True))
        lines.append(f"- {method}: {pairs}")
    leave_page(OUT, lines, "python tests/reference/report_extremes.py")


if __name__ == "__main__":
    main()
