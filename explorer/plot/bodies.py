"""Pictures over all bodies: the race number, and the gap between the two limit motions."""

from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from explorer.phase.states import Array
from explorer.plot.captions import Question, captioned
from explorer.plot.style import DARK, SERIES, SMALL, axes_or_new, dress, legend_below, stacked, styled
from explorer.portrait.bodies import MeasuredGaps, RaceNumbers

NAMED = {2.0: "hoop", 4.0: "uniform"}
_RATIO = r"$m r^2/I_1$"


@captioned(
    Question.HOW_FAR,
    "The race number κ against mr²/I₁: beside F the contact point races round the rim by κ half turns. "
    "Circles are measured on passages beside F and lie on the curve. At the diamonds κ is a whole number, and "
    "both limit motions agree.",
)
def race_number(
    numbers: RaceNumbers, measured: MeasuredGaps | None = None, ax: Axes | None = None, **look: Any
) -> Axes:
    r"""Draw kappa against m r^2/I1: beside F the contact point races by kappa pi.

    Parameters
    ----------
    numbers : RaceNumbers
        From `explorer.portrait.race_numbers`.
    measured : MeasuredGaps, optional
        Race angles of passages, drawn as circles.
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib for the curve.

    Returns
    -------
    Axes
        m r^2/I1 and kappa, both dimensionless. Diamonds are bodies whose two limit motions agree.

    References
    ----------
    Eq. (7.9) of the paper.

    Examples
    --------
    >>> from explorer import plot
    >>> from explorer.portrait import race_numbers
    >>> ax = plot.race_number(race_numbers(4.0))
    >>> [text.get_text() for text in ax.texts]
    ['hoop', 'uniform']
    """
    ax = axes_or_new(ax)
    style = styled(look, color=DARK, lw=1.8, label=r"$\kappa = \sqrt{1 + m r^2/I_1}$")
    ax.plot(numbers.ratio, numbers.kappa, **style)
    _matching(ax, numbers, np.sqrt(1.0 + numbers.matching))
    if measured is not None:
        _measured(ax, measured.ratio, measured.kappa)
    _named(ax, numbers, np.sqrt)
    ax.set_ylim(0.8, 1.08 * numbers.kappa[-1])
    ax.legend(handles=ax.lines[:1], fontsize=SMALL, loc="lower right", frameon=False)
    return dress(
        ax, _RATIO, r"race number $\kappa$ (half turns)", r"The contact point races by $\pm\kappa\pi$", grid=True
    )


@captioned(
    Question.EACH_SIDE,
    "How far apart the two limit motions leave a fall, as a distance on the circle, against mr²/I₁. At the "
    "diamonds it is zero: for these bodies both sides of F have the same limit.",
)
def race_gap(
    numbers: RaceNumbers, measured: MeasuredGaps | None = None, ax: Axes | None = None, **look: Any
) -> Axes:
    r"""Draw how far apart the two limits leave a fall, on the circle, against m r^2/I1: zero for matching bodies.

    Parameters
    ----------
    numbers : RaceNumbers
        From `explorer.portrait.race_numbers`.
    measured : MeasuredGaps, optional
        Race angles of passages, drawn as circles.
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib for the curve.

    Returns
    -------
    Axes
        m r^2/I1 (dimensionless) and the distance of 2 kappa pi from whole turns, 0 to pi (rad).

    References
    ----------
    Section 7.2 of the paper.

    Examples
    --------
    >>> from explorer import plot
    >>> from explorer.portrait import race_numbers
    >>> plot.race_gap(race_numbers(4.0)).get_ylabel()
    'apart after a fall (rad)'
    """
    ax = axes_or_new(ax)
    ax.plot(numbers.ratio, _on_circle(numbers.gap), **styled(look, color=DARK, lw=1.8))
    _matching(ax, numbers, 0.0 * numbers.matching)
    if measured is not None:
        _measured(ax, measured.ratio, _on_circle(measured.gap))
    _named(ax, numbers, lambda square: float(_on_circle(np.array(2.0 * np.pi * np.sqrt(square)))))
    ax.set_ylim(-0.2, np.pi + 0.45)
    ax.set_yticks([0.0, 0.5 * np.pi, np.pi], ["0", "π/2", "π"])
    legend_below(ax, ncols=2, bbox_to_anchor=(0.5, -0.2))
    return dress(
        ax,
        _RATIO,
        "apart after a fall (rad)",
        "How far the two limit motions part in a fall, on the circle",
        grid=True,
    )


def _on_circle(angle: Array) -> Array:
    """How far angles (rad) are from whole turns: 0 to pi."""
    distance: Array = abs(angle - 2.0 * np.pi * np.round(angle / (2.0 * np.pi)))
    return distance


def race_bodies(numbers: RaceNumbers, measured: MeasuredGaps | None = None) -> Figure:
    """Draw race number and gap above each other.

    Parameters
    ----------
    numbers, measured
        As for `race_number`.

    Returns
    -------
    Figure

    Examples
    --------
    >>> from explorer import plot
    >>> from explorer.portrait import race_numbers
    >>> len(plot.race_bodies(race_numbers(4.0)).axes)
    2
    """
    return stacked(
        lambda ax: race_number(numbers, measured, ax),
        lambda ax: race_gap(numbers, measured, ax),
        height=7.2,
    )


def _matching(ax: Axes, numbers: RaceNumbers, at: Array) -> None:
    ax.plot(numbers.matching, at, "D", color=SERIES[1], ms=7, label=r"$m r^2/I_1 = l^2 - 1$: both limits agree")


def _measured(ax: Axes, ratio: Array, value: Array) -> None:
    ax.plot(ratio, value, "o", mfc="none", mec=DARK, ms=12, label="measured beside $F$")


def _named(ax: Axes, numbers: RaceNumbers, height: Callable[[float], float]) -> None:
    for ratio, name in NAMED.items():
        if ratio <= numbers.ratio[-1]:
            at = ratio, height(1.0 + ratio)
            ax.plot(*[[value] for value in at], "s", color=SERIES[2], ms=6)
            ax.annotate(name, at, xytext=(11, -5), textcoords="offset points", ha="left", fontsize=SMALL)
