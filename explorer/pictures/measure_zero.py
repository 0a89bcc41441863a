"""The law P(theta_min < delta) = C delta, of a run of scene measure-zero."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from explorer.measure.laws import OFF, PLATEAU, SHAPE_BINS, known_laws
from explorer.pictures.register import Question, picture
from explorer.pictures.style import DARK, SERIES, SIZE, TEXT, dress, legend_below, legend_of_all, mark_beyond

_TUBES, _PLAIN = SERIES[1], SERIES[2]
_POINTS: dict[str, Any] = {"ms": 5, "mfc": "none", "mew": 1.3, "capsize": 2, "lw": 1.2}
_NEAR = "draws near $F$, 95 % all at once"
_REJECTED = 0.05  # p-value below which a law is called rejected


@picture(
    Question.HOW_RARELY,
    "The probability that the disk comes flatter than δ, over fifteen decades. Estimates with their intervals "
    "lie on the line Cδ, whose C is computed without any sample. Two other laws are drawn in, and the legend "
    "says whether the draws reject them. Below, the estimates divided by the law: all intervals contain 1 once "
    "δ is small.",
    (SIZE[0], 9.0),
)
def probability(figure: Figure, summary: dict[str, Any]) -> None:
    """Draw estimates of P(theta_min < delta) with intervals, the line C delta, and wrong laws."""
    if summary["constant"]:
        above, below = figure.subplots(2, 1, sharex=True)
        _ratio(below, summary)
    else:
        above = below = figure.subplots()
    _estimates(above, summary)
    below.set_xlabel(r"$\delta$ (rad)", fontsize=TEXT)
    legend_of_all(figure, dict.fromkeys((above, below)), ncols=1)


def _estimates(ax: Axes, summary: dict[str, Any]) -> None:
    rows, constant = summary["ladder"], summary["constant_predicted"]
    delta = np.array([row["delta"] for row in rows])
    if constant > 0.0:
        ax.loglog(delta, constant * delta, color=DARK, lw=1.2, label=rf"$C\,\delta$, $C={constant:.5f}$")
        laws = known_laws(constant, summary.get("law_limit", delta[0]))
        plateau = rf"falls with $P = 10^{{{np.log10(PLATEAU):.0f}}}$"
        for name, colour, style, formula in (
            ("dimension_two", SERIES[6], ":", r"$\propto\delta^2$"),
            ("plateau", SERIES[4], "--", plateau),
        ):
            shares, label = laws[name](delta), f"{_verdict(summary, name)}: {formula}"
            ax.loglog(delta[shares < 1.0], shares[shares < 1.0], color=colour, ls=style, lw=1.8, label=label)
    tubes = [(row["delta"], row["estimate"], row["interval_95_simultaneous"]) for row in rows]
    _points(ax, tubes, fmt="o", color=_TUBES, label=_NEAR)
    hits = [(row["delta"], row["plain"]["value"], row["plain"]["interval_95"]) for row in rows if row["count"]]
    _points(ax, hits, fmt="s", color=_PLAIN, label=f"{summary['samples']:,} plain draws, 95 %")
    bound = summary["upper_bound_95"]
    digit, _, exponent = f"{bound:.0e}".partition("e")
    text = rf"{summary['falls']} of the plain draws fell: $P(0) \leq {digit} \times 10^{{{int(exponent)}}}$"
    ax.axhline(bound, color=_PLAIN, lw=1.0, ls="-.", label=text)
    if constant > 0.0:
        ax.set_ylim(0.1 * constant * delta[-1], 3.0)
    title = f"Falling has measure zero, {summary['disks'][0]['name']} disk"
    dress(ax, "", r"$P(\theta_{\min} < \delta)$", title, grid=True)


def _verdict(summary: dict[str, Any], law: str) -> str:
    """Whether the draws of the run suffice to reject a wrong law."""
    return "rejected" if summary["p_value"].get(law, 1.0) < _REJECTED else "not rejected"


def _ratio(ax: Axes, summary: dict[str, Any]) -> None:
    """The estimates over their line, where an error of some percent in C can be seen; tested where shaded."""
    rows = []
    for row in summary["ladder"]:
        unit = summary["constant_predicted"] * row["delta"]
        rows.append(
            (row["delta"], row["estimate"] / unit, [end / unit for end in row["interval_95_simultaneous"]])
        )
    ax.set_xscale("log")
    ax.axhline(1.0, color=DARK, lw=1.2)
    label = f"{_verdict(summary, 'constant_off')}: $C$ off by {100 * OFF:.0f} %"
    ax.axhline(1.0 + OFF, color=SERIES[3], lw=1.8, label=label)
    ax.axvspan(summary["ladder"][-1]["delta"] / 3.0, 2.0 * summary["law_limit"], color=DARK, alpha=0.06, lw=0)
    _points(ax, rows, fmt="o", color=_TUBES, label=_NEAR)
    # The first four estimates lie above the range of the law and may leave the picture.
    reach = max(1.5 * OFF, 1.3 * max(abs(end - 1.0) for _, _, ends in rows[4:] or rows for end in ends))
    ax.set_ylim(1.0 - reach, 1.0 + reach)
    beyond = [(delta, value) for delta, value, _ in rows if not abs(value - 1.0) <= reach]
    if beyond:
        x, y = np.transpose(beyond)
        mark_beyond(ax, x, y, _TUBES, [f"{value:.2f}" for value in y])
    dress(ax, "", r"$P / (C\,\delta)$", "The same over the law; tested where shaded", grid=True)


def _points(ax: Axes, rows: list[Any], **look: Any) -> None:
    """Draw rows of delta, estimate and interval; an estimate of zero has no place on a logarithmic axis."""
    rows = [row for row in rows if row[1] > 0.0]
    if rows:
        x, y, ends = (np.array(column) for column in zip(*rows, strict=True))
        spread = np.maximum(np.stack([y - ends[:, 0], ends[:, 1] - y]), 0.0)
        ax.errorbar(x, y, spread, **_POINTS, **look)


@picture(
    Question.HOW_RARELY,
    "How far the constant C of the law P = Cδ, estimated from the first N draws, is from the C that quadrature "
    "gives. The relative difference goes to zero as fast as the statistical error of N draws, which the grey "
    "wedge shows. Each point includes the draws of all points before it, so neighbouring points err together.",
)
def constant_convergence(ax: Axes, summary: dict[str, Any]) -> None:
    """Draw how the estimate of C converges with the number of draws, beside the prediction."""
    rows, predicted = summary["convergence"], summary["constant_predicted"]
    draws = np.array([row["draws"] for row in rows])
    off = np.array([row["value"] for row in rows]) / predicted - 1.0
    low, high = np.array([row["interval_95"] for row in rows]).T / predicted - 1.0
    ax.axhline(0.0, color=DARK, lw=1.2, label=f"quadrature over F: $C={predicted:.6f}$")
    _bars(ax, draws, off, np.stack([off - low, high - off]), "independent draws, 95 %")
    guide = (high - off)[-1] * np.sqrt(draws[-1] / draws)
    ax.fill_between(draws, -guide, guide, color=DARK, alpha=0.08, lw=0, label=r"$\propto N^{-1/2}$")
    ax.set_xscale("log")
    some = draws[:: max(1, len(draws) // 6)]
    ax.set_xticks(some, [f"{n:.2g}" for n in some / 1e6])
    ax.xaxis.set_minor_locator(NullLocator())
    legend_below(ax)
    title = "The constant $C$ settles on its prediction"
    dress(ax, "draws near $F$, from the first on (millions)", "$C$ from draws / predicted − 1", title, grid=True)


@picture(
    Question.HOW_RARELY,
    "The density of the smallest tilt among the draws that come flatter than δ, beside the uniform density that "
    "the law Cδ predicts. The axis shows only a percent or so on either side of 1: the differences that can "
    "still be seen are the noise of counting.",
)
def tilt_density(ax: Axes, summary: dict[str, Any]) -> None:
    """Draw the density of theta_min / delta of draws that come flatter than delta; by the law it is constant."""
    tilt = summary["splits"]["tilt"]
    middle = (np.arange(SHAPE_BINS) + 0.5) / SHAPE_BINS
    share, error = np.array(tilt["share"]) * SHAPE_BINS, np.array(tilt["error"]) * SHAPE_BINS
    ax.axhline(1.0, color=DARK, lw=1.2, label="the law: even")
    _bars(ax, middle, share, 1.96 * error, "draws, 95 %")
    legend_below(ax)
    p = tilt.get("p_value")
    title = f"Tilts below δ are spread evenly{'' if p is None else f' ($p$ = {p:.2g})'}"
    dress(ax, r"$\theta_{\min}/\delta$", "density over that of the law", title, grid=True)


def _bars(ax: Axes, x: Any, y: Any, spread: Any, name: str) -> None:
    ax.errorbar(x, y, spread, fmt="o", color=_TUBES, ms=5, lw=1.4, capsize=3, label=name)
