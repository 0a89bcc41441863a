"""The law P(theta_min < delta) = C delta, of a run of scene measure-zero."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from explorer.measure.laws import OFF, PLATEAU, known_laws
from explorer.pictures.register import Question, picture
from explorer.pictures.style import DARK, SERIES, SIZE, TEXT, dress, legend_of_all, mark_beyond

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
    legend_of_all(figure, (above, below), ncols=1)


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
