"""Writes results/peers/: nearflat and its peers on the same work, in one run on one core.

    pip install "nearflat[peers]"
    OMP_NUM_THREADS=1 taskset -c 0 python -m peers.report_peers      # in tests/; some minutes

Rates are trajectories per second per core; compile time is not in them. Compare within one run only.
"""

import time
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from peers import ours, solvers
from peers.peak import operations, peak
from peers.problem import COUNT, work

from explorer.commands.made_by import leave_made_by
from explorer.plot.captions import Question, captioned, save
from explorer.plot.style import DARK, MARKERS, SERIES, dress

OUT = Path(__file__).parents[2] / "results" / "peers"
TIGHT = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13)
TARGETS = (1e-3, 1e-6, 1e-9)
OWN = tuple(f"{name}, to t = 1.6" for name in ("rk4", "rk8", "dopri5", "dop853"))
WRONG = 3.0  # rad: a race the other way round is off by 2 kappa pi = 14


def peers():
    """name, maker, tolerances, how many trajectories are worth the time."""
    for regular in (False, True):
        on = "regularised" if regular else "plain"
        yield f"heyoka batch, {on}", solvers.heyoka_batch(regular), (1e-2, *TIGHT), COUNT
        yield f"heyoka, {on}", solvers.heyoka_scalar(regular), TIGHT[::2], COUNT
        yield f"numbalsoda dop853, {on}", solvers.numbalsoda_on("dop853", regular), TIGHT[1:], COUNT
        yield f"numbalsoda lsoda, {on}", solvers.numbalsoda_on("lsoda", regular), TIGHT[3::2], COUNT
        yield f"CyRK DOP853, {on}", solvers.cyrk_on(regular), TIGHT[1::2], COUNT
        yield f"SciPy RK45, {on}", solvers.scipy_on("RK45", regular), (1e-3, 1e-6, 1e-9), 32
        yield f"SciPy DOP853, {on}", solvers.scipy_on("DOP853", regular), (1e-4, 1e-7, 1e-10, 1e-13), 32
        yield f"diffrax Dopri8, {on}", solvers.diffrax_on(regular), (1e-4, 1e-7, 1e-10), COUNT


def mine():
    """The same of nearflat; the last column says what is solved."""
    steps4, steps8 = (0.5, 0.4, 0.3, 0.2, 0.1, 0.05), (1.2, 1.0, 0.8, 0.6, 0.5, 0.4, 0.3, 0.2, 0.15)
    for whole in (True, False):
        what = "to t = 1.6" if whole else "half, doubled"
        yield f"rk4, {what}", ours.integrator("rk4", whole), steps4, COUNT
        yield f"rk8, {what}", ours.integrator("rk8", whole), steps8, COUNT
        yield f"dopri5, {what}", ours.integrator("dopri5", whole), TIGHT[1:9], COUNT
        yield f"dop853, {what}", ours.integrator("dop853", whole), TIGHT, COUNT
    yield "quadrature", ours.quadrature(), (1e-11,), COUNT


def measure(solve, n, exact, repeats=5):
    """99th percentile and median of the error, races the wrong way, unresolved, rate."""
    chi = solve(n)
    best = np.inf
    for _ in range(repeats):
        start = time.perf_counter()
        solve(n)
        best = min(best, time.perf_counter() - start)
    error = np.abs(chi - exact[:n]).astype(float)
    resolved = np.isfinite(error)
    percentiles = np.percentile(error[resolved], (50, 99))
    return *percentiles, int((error > WRONG).sum()), int((~resolved).sum()), best


def rows():
    """(name, setting, median, p99, wrong, unresolved, rate), ours first."""
    for source, own in ((mine, True), (peers, False)):
        for name, maker, settings, n in source():
            exact = work().passage if own and ("half" in name or name == "quadrature") else work().chi
            for setting in settings:
                solve = maker(setting)
                median, p99, wrong, unresolved, seconds = measure(solve, n, exact, 5 if n == COUNT else 1)
                count = COUNT * ours.COPIES if own else n
                row = (name, setting, median, p99, wrong, unresolved, count / seconds, own)
                print(name, f"{setting:g} {median:.1e} {p99:.1e} {wrong} {unresolved} {row[6]:.0f}", flush=True)
                yield row
                if n != COUNT and seconds > 60:
                    break


def at(found, name, target):
    """Highest rate of a solver over settings with a 99th percentile within the target, or NaN."""
    rates = [row[6] for row in found if row[0] == name and row[3] <= target and row[4] == row[5] == 0]
    return max(rates, default=np.nan)


# Solvers of one family share a colour, none of which is a side of F; ours are dark.
FAMILIES = {
    "heyoka": SERIES[1],
    "numbalsoda": SERIES[2],
    "CyRK": SERIES[3],
    "SciPy": SERIES[4],
    "diffrax": SERIES[5],
}
PEERS = {
    "heyoka batch": ("o", "-"),
    "heyoka": ("s", "--"),
    "numbalsoda dop853": ("o", "-"),
    "numbalsoda lsoda": ("s", "--"),
    "CyRK DOP853": ("o", "-"),
    "SciPy DOP853": ("o", "-"),
    "SciPy RK45": ("s", "--"),
    "diffrax Dopri8": ("o", "-"),
}


@captioned(
    Question.HOW_GOOD,
    "Trajectories per second against error, ours in black and other solvers in colour: on the plain equations on "
    "the left, as a user would write them, and on our regularised ones on the right. Further up and further right "
    "is better. Hollow: of some trajectories the side was not known, or the contact point raced the wrong way "
    "round, which is what an error of 7 rad or more is.",
)
def draw(found):
    """Two panels: peers on the plain and on the regularised equations, ours in both."""
    figure = Figure(figsize=(7.6, 6.4), layout="constrained")
    for ax, kind in zip(figure.subplots(1, 2, sharex=True, sharey=True), ("plain", "regularised"), strict=True):
        for place, own in enumerate((*OWN, "quadrature")):
            star = own == "quadrature"
            look = {"marker": "*", "ms": 14} if star else {"marker": MARKERS[place], "ms": 5}
            _line(ax, found, own, {**look, "color": DARK, "label": f"{own.partition(',')[0]} (ours)"})
        for peer, (marker, style) in PEERS.items():
            look = {"marker": marker, "ms": 5, "ls": style, "color": FAMILIES[peer.partition(" ")[0]]}
            _line(ax, found, f"{peer}, {kind}", {**look, "label": peer})
        dress(ax, "error of χ, 99th percentile (rad)", "", f"Peers on the {kind} equations")
        ax.grid(alpha=0.3)
        ax.text(0.97, 0.02, "better ↗", ha="right", fontsize=10.5, transform=ax.transAxes)
    ax.set(xscale="log", yscale="log")
    ax.invert_xaxis()
    figure.axes[0].set_ylabel("trajectories per second per core", fontsize=12)
    handles, names = figure.axes[0].get_legend_handles_labels()
    hollow = Line2D([], [], marker="o", color=DARK, mfc="white", ls="")
    handles, names = [*handles, hollow], [*names, "hollow: some unresolved or wrong"]
    figure.legend(handles, names, loc="outside lower center", ncols=3, fontsize=10.5, frameon=False)
    return figure


def _line(ax, found, name, look):
    """One solver, settings in their order; hollow where a trajectory is unresolved or went the wrong way."""
    chosen = [row for row in found if row[0] == name]
    ax.plot([row[3] for row in chosen], [row[6] for row in chosen], **look)
    doubtful = [row for row in chosen if row[4] or row[5]]
    hollow = {**look, "ls": "", "mfc": "white", "label": None, "zorder": 5}
    ax.plot([row[3] for row in doubtful], [row[6] for row in doubtful], **hollow)


def machine_lines():
    """How near the machine's limit fixed steps run."""
    limit, counts = peak(), operations()
    lines = ["", f"Multiply-adds per second of this core, measured in this run: {limit:.1e}.", ""]
    for name, control in (("rk4", 0.01), ("rk8", 0.05)):
        solve = ours.integrator(name, True)(control)
        seconds = measure(solve, COUNT, work().chi, 3)[-1]
        rate = solve.steps() * COUNT * ours.COPIES / seconds
        share = rate * counts[name] / (2.0 * limit)
        lines.append(
            f"- {name} with small steps: {rate / 1e6:.0f} million steps/s of {counts[name]} additions and"
            f" multiplications, {share:.0%} of the peak."
        )
    return lines


def ratios(found):
    """A table of how many times as fast as each peer."""
    quadrature = next(row for row in found if row[0] == "quadrature")[6]
    heads = [f"integrator, p99 <= {t:g}" for t in TARGETS]
    heads += ["quadrature, peer at p99 <= 1e-9", "quadrature, peer at its best"]
    yield "| peer | " + " | ".join(heads) + " |"
    yield "|---|" + "---|" * len(heads)
    for name in dict.fromkeys(row[0] for row in found if not row[7]):
        cells = [np.nanmax([at(found, own, t) for own in OWN]) / at(found, name, t) for t in TARGETS]
        right = [row for row in found if row[0] == name and row[4] == 0]
        best = min(right, key=lambda row: row[3])[6] if right else np.nan
        cells += [quadrature / at(found, name, 1e-9), quadrature / best]
        yield f"| {name} | " + " | ".join("-" if np.isnan(c) else f"{c:.1f}" for c in cells) + " |"


def every(found):
    """A table of all rows."""
    yield "| solver | setting | median error | 99th percentile | wrong way | unresolved | trajectories/s |"
    yield "|---|---|---|---|---|---|---|"
    for name, setting, median, p99, wrong, unresolved, rate, _own in found:
        yield f"| {name} | {setting:g} | {median:.0e} | {p99:.0e} | {wrong} | {unresolved} | {rate:,.0f} |"


def main():
    OUT.mkdir(parents=True, exist_ok=True)
    found = list(rows())
    save(draw(found), OUT / "peers.png")
    lines = [
        "# nearflat and its peers",
        "",
        "Made by `python -m peers.report_peers` in `tests/`, on one core, all rows in one run. The work is in",
        "`tests/peers/problem.py`: chi at t = 1.6, just after the first passage, of 256 trajectories with",
        "|eta_hat| from 1e-6 to 1e-1. *half, doubled*: integration to the turning point and the symmetry of a",
        "passage; *quadrature*: the whole passage, vertical to vertical. *Wrong way*: the contact point races the",
        "wrong way round. Machines differ: the ratios are what counts.",
        "",
        "How many times as fast as the peer at a 99th percentile of the error (fastest setting of each that",
        "reaches it with every trajectory resolved and none the wrong way; - where the peer has none). The",
        "integrator is followed to t = 1.6 as the peers are. Last column: against the peer's most accurate row.",
        "",
        *ratios(found),
        *machine_lines(),
        "",
        "![error and rate of all solvers](peers.png)",
        "",
        *every(found),
    ]
    (OUT / "README.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
    leave_made_by(OUT, "python -m peers.report_peers")


if __name__ == "__main__":
    main()
