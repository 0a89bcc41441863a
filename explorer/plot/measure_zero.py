"""Pictures of the law P(theta_min < delta) = C delta."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import NullLocator

from explorer.measure.laws import OFF, PLATEAU, SHAPE_BINS, known_laws
from explorer.plot.captions import Question, captioned
from explorer.plot.style import DARK, SERIES, SMALL, axes_or_new, dress, legend_below, mark_beyond, styled

_SHARE = r"$P(\theta_{\min} < \delta)$"
_TUBES, _PLAIN = SERIES[1], SERIES[2]
_TUBES_NAME = "draws beside $F$, weighted"


@captioned(
    Question.HOW_RARELY,
    "The probability to come flatter than δ, over fifteen decades. Estimates with their intervals lie on the "
    "line Cδ, whose C is computed without any sample; two other laws, drawn in, miss them.",
)
def falling_ladder(summary: dict[str, Any], ax: Axes | None = None, **look: Any) -> Axes:
    """Draw estimates of P(theta_min < delta) with intervals, the line C delta, and laws that it is not.

    Parameters
    ----------
    summary : dict
        Of a run of scene measure-zero.
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib for the points.

    Returns
    -------
    Axes
        delta (rad) and the probability, both logarithmic; the broken line bounds the probability of falling.

    Examples
    --------
    >>> import explorer as ex
    >>> run = ex.run("measure-zero", out="zero", samples=10_000)  # doctest: +SKIP
    >>> ax = ex.plot.falling_ladder(run.summary)  # doctest: +SKIP
    """
    ax = axes_or_new(ax)
    rows = summary["ladder"]
    delta = np.array([row["delta"] for row in rows])
    constant = summary["constant_predicted"]
    if constant > 0.0:
        ax.loglog(delta, constant * delta, color=DARK, lw=1.2, label=rf"$C\,\delta$, $C={constant:.5f}$")
        top = summary.get("law_limit", delta[0])
        styles = {
            "dimension_two": (SERIES[4], ":", r"rejected: $\propto\delta^2$"),
            "plateau": (SERIES[4], "--", rf"rejected: falls with $P = 10^{{{np.log10(PLATEAU):.0f}}}$"),
        }
        for name, (colour, style, label) in styles.items():
            shares = known_laws(constant, top)[name](delta)
            ax.loglog(delta[shares < 1.0], shares[shares < 1.0], color=colour, ls=style, lw=1.6, label=label)
    tubes = [(row["delta"], row["estimate"], row["interval_95_simultaneous"]) for row in rows]
    _points(ax, tubes, _TUBES, "o", f"{_TUBES_NAME}, 95 %", look)
    hits = [(row["delta"], row["plain"]["value"], row["plain"]["interval_95"]) for row in rows if row["count"]]
    _points(ax, hits, _PLAIN, "s", f"{summary['samples']:,} plain draws, 95 %", look)
    bound = summary["upper_bound_95"]
    ax.axhline(bound, color=_PLAIN, lw=1.0, ls="-.")
    digit, _, power = f"{bound:.0e}".partition("e")
    text = rf"{summary['falls']} of these fell: $P(0) \leq {digit} \times 10^{{{int(power)}}}$"
    ax.annotate(text, (delta[-1], bound), xytext=(2, -13), textcoords="offset points", fontsize=SMALL)
    if constant > 0.0:
        ax.set_ylim(0.1 * constant * delta[-1], 3.0)
    legend_below(ax, ncols=2)
    return dress(
        ax, r"$\delta$ (rad)", _SHARE, f"Falling has measure zero, {summary['disks'][0]['name']} disk", grid=True
    )


@captioned(
    Question.HOW_RARELY,
    "The estimates of the ladder divided by the law Cδ. All intervals hold 1 as soon as δ is small.",
)
def ladder_ratio(summary: dict[str, Any], ax: Axes | None = None, **look: Any) -> Axes:
    """Draw the estimates over their line C delta, where an error of some percent in C can be seen.

    Parameters
    ----------
    summary : dict
        Of a run of scene measure-zero.
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib for the points.

    Returns
    -------
    Axes
        delta (rad), logarithmic, and P / (C delta); shaded where the law is tested.

    Examples
    --------
    >>> import explorer as ex
    >>> run = ex.run("measure-zero", out="zero", samples=10_000)  # doctest: +SKIP
    >>> ax = ex.plot.ladder_ratio(run.summary)  # doctest: +SKIP
    """
    ax = axes_or_new(ax)
    constant = summary["constant_predicted"]
    rows = []
    for row in summary["ladder"]:
        unit = constant * row["delta"]
        ends = [end / unit for end in row["interval_95_simultaneous"]]
        rows.append((row["delta"], row["estimate"] / unit, ends))
    ax.set_xscale("log")
    ax.axhline(1.0, color=DARK, lw=1.2)
    ax.axhline(1.0 + OFF, color=SERIES[4], lw=1.4, ls=":", label=f"rejected: $C$ off by {100 * OFF:.0f} %")
    ax.axvspan(summary["ladder"][-1]["delta"] / 3.0, 2.0 * summary["law_limit"], color=DARK, alpha=0.06, lw=0)
    _points(ax, rows, _TUBES, "o", f"{_TUBES_NAME}, 95 % (all at once)", look)
    # The first four rungs lie above the range of the law and may leave the picture.
    reach = max(1.5 * OFF, 1.3 * max(abs(end - 1.0) for _, _, ends in rows[4:] or rows for end in ends))
    ax.set_ylim(1.0 - reach, 1.0 + reach)
    beyond = [row for row in rows if not 1.0 - reach <= row[1] <= 1.0 + reach]
    texts = [f"{value:.2f}" for _, value, _ in beyond]
    x, y = (np.array([row[place] for row in beyond]) for place in (0, 1))
    mark_beyond(ax, x, y, _TUBES, texts)
    legend_below(ax, ncols=2)
    return dress(
        ax, r"$\delta$ (rad)", r"$P / (C\,\delta)$", "The same over the law; tested where shaded", grid=True
    )


def _points(ax: Axes, rows: list[Any], colour: str, marker: str, label: str, look: dict[str, Any]) -> None:
    """Draw rows of delta, estimate and interval; an estimate of zero has no place on a logarithmic axis."""
    if not rows:
        return
    x, y, ends = (np.array(column) for column in zip(*rows, strict=True))
    shown = y > 0.0
    spread = np.maximum(np.stack([y - ends[:, 0], ends[:, 1] - y]), 0.0)[:, shown]
    style = styled(look, fmt=marker, color=colour, ms=5, mfc="none", mew=1.3, capsize=2, lw=1.2)
    ax.errorbar(x[shown], y[shown], spread, label=label, **style)


def _bars(ax: Axes, x: Any, y: Any, spread: Any, label: str, look: dict[str, Any]) -> None:
    ax.errorbar(x, y, spread, **styled(look, fmt="o", color=_TUBES, ms=5, lw=1.4, capsize=3, label=label))


@captioned(
    Question.HOW_RARELY,
    "The constant C from the first N draws, relative to the one from quadrature. It settles on zero as fast "
    "as counting allows, which is the grey wedge. Each point holds the draws of those before, so neighbours err "
    "together.",
)
def constant_convergence(summary: dict[str, Any], ax: Axes | None = None, **look: Any) -> Axes:
    """Draw how the estimate of C settles with the number of draws, beside the prediction.

    Parameters
    ----------
    summary : dict
        Of a run of scene measure-zero.
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib for the points.

    Returns
    -------
    Axes
        Draws in tubes, logarithmic, and the estimate over the prediction less one.

    Examples
    --------
    >>> import explorer as ex
    >>> run = ex.run("measure-zero", out="zero", samples=10_000)  # doctest: +SKIP
    >>> ax = ex.plot.constant_convergence(run.summary)  # doctest: +SKIP
    """
    ax = axes_or_new(ax)
    rows, predicted = summary["convergence"], summary["constant_predicted"]
    draws = np.array([row["draws"] for row in rows])
    off = np.array([row["value"] for row in rows]) / predicted - 1.0
    low, high = np.array([row["interval_95"] for row in rows]).T / predicted - 1.0
    ax.axhline(0.0, color=DARK, lw=1.2, label=f"quadrature over F: $C={predicted:.6f}$")
    name = "scrambled Sobol points" if summary["sampling"] == "sobol" else "independent draws"
    _bars(ax, draws, off, np.stack([off - low, high - off]), f"{name}, 95 %", look)
    guide = (high - off)[-1] * np.sqrt(draws[-1] / draws)
    ax.fill_between(draws, -guide, guide, color=DARK, alpha=0.08, lw=0, label=r"$\propto N^{-1/2}$")
    ax.set_xscale("log")
    ax.set_xticks(
        draws[:: max(1, len(draws) // 6)], [f"{n:,.0f}" for n in draws[:: max(1, len(draws) // 6)] / 1e3]
    )
    ax.xaxis.set_minor_locator(NullLocator())
    legend_below(ax)
    title = "The constant $C$ settles on its prediction"
    return dress(
        ax, "draws beside $F$, from the first on (thousands)", "$C$ from draws / predicted − 1", title, grid=True
    )


@captioned(
    Question.HOW_RARELY,
    "The density of the smallest tilt among the draws that come flatter than δ, against the even one that the law "
    "Cδ says. The axis shows a percent or so on either side of 1: what is left is the noise of counting.",
)
def tilt_density(summary: dict[str, Any], ax: Axes | None = None, **look: Any) -> Axes:
    """Draw theta_min / delta of the hits beside the constant density that the law predicts.

    Parameters
    ----------
    summary : dict
        Of a run of scene measure-zero.
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib for the points.

    Returns
    -------
    Axes
        theta_min / delta and the density, both dimensionless.

    Examples
    --------
    >>> import explorer as ex
    >>> run = ex.run("measure-zero", out="zero", samples=10_000)  # doctest: +SKIP
    >>> ax = ex.plot.tilt_density(run.summary)  # doctest: +SKIP
    """
    ax = axes_or_new(ax)
    tilt = summary["splits"]["tilt"]
    middle = (np.arange(SHAPE_BINS) + 0.5) / SHAPE_BINS
    share, error = np.array(tilt["share"]) * SHAPE_BINS, np.array(tilt["error"]) * SHAPE_BINS
    ax.axhline(1.0, color=DARK, lw=1.2, label="the law: even")
    _bars(ax, middle, share, 1.96 * error, "draws, 95 %", look)
    legend_below(ax)
    p = summary.get("splits", {}).get("tilt", {}).get("p_value")
    told = "" if p is None else f" ($p$ = {p:.2g})"
    title = f"Tilts below δ are spread evenly{told}"
    return dress(ax, r"$\theta_{\min}/\delta$", "density", title, grid=True)
