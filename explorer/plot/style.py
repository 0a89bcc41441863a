"""The look of all pictures: sizes, colours that colour-blind users can tell apart, axes and their units."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from explorer.phase.disk import Disk

# Okabe & Ito's palette: blue for eta > 0, vermilion for eta < 0, everywhere.
PLUS, MINUS, THIRD, FOURTH, DARK = "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#222222"
SIGN_COLOURS = {1: PLUS, -1: MINUS}
DISK_COLOURS = (PLUS, MINUS, THIRD, FOURTH, "#E69F00", "#56B4E9")
MARKERS = ("o", "s", "^", "D", "v", "P")
# Perceptually even and readable in grey; the flattest states are brightest.
TILT_COLOURS = "cividis_r"

SIZE = (6.4, 4.8)
TEXT, SMALL = 12, 10.5

# Tints of parts of a phase space, light enough for lines to stand out.
FALLS, BOUNCES, UNSTABLE = "#F6D6C2", "#DCEAF5", "#F3E3EE"

HALF_PI = 0.5 * np.pi
FLAT_TICKS = ([-HALF_PI, -0.5, 0.0, 0.5, HALF_PI], [r"$-\pi/2$", "-0.5", "0", "0.5", r"$\pi/2$"])
_SYMBOLS = {
    "phi": r"$\varphi$",
    "phidot": r"$\dot\varphi$",
    "sigma3": r"$\sigma_3$",
    "sigma4": r"$\sigma_4$",
    "sigma3_bar": r"$\bar\sigma_3$",
    "sigma4_bar": r"$\bar\sigma_4$",
    "eta_hat": r"$\hat\eta$",
    "energy": "$E$",
}


def axes_or_new(ax: Axes | None) -> Axes:
    """The axes given, or those of a new figure that no window manager knows."""
    return ax if ax is not None else Figure(figsize=SIZE, layout="constrained").subplots()


def figure_of(draw: Callable[..., Any] | Figure, *arguments: Any) -> Figure:
    """The figure that one picture makes for itself.

    Parameters
    ----------
    draw : callable or Figure
        A function of `explorer.plot`; a figure is returned as it is.
    *arguments
        What it is called with.

    Returns
    -------
    Figure
        Not shown and not registered anywhere: save it with its `savefig`.

    Examples
    --------
    >>> from explorer import plot
    >>> from explorer.portrait.bodies import race_numbers
    >>> figure = plot.figure_of(plot.race_number, race_numbers())
    >>> figure.axes[0].get_xlabel()
    '$m r^2/I_1$'
    """
    drawn = draw if isinstance(draw, Figure) else draw(*arguments)
    figure = drawn if isinstance(drawn, Figure) else drawn.figure
    assert isinstance(figure, Figure)
    return figure


def stacked(*draws: Callable[[Axes], Axes], height: float = 6.4) -> Figure:
    """Pictures above each other on one horizontal axis, whose name only the lowest keeps.

    Parameters
    ----------
    *draws : callables
        Each takes the Axes to draw on.
    height : float
        Of the whole figure, in inches.

    Returns
    -------
    Figure

    Examples
    --------
    >>> from explorer import plot
    >>> from explorer.portrait.bodies import race_numbers
    >>> numbers = race_numbers()
    >>> draw = [lambda ax: plot.race_number(numbers, ax=ax), lambda ax: plot.race_gap(numbers, ax=ax)]
    >>> figure = plot.stacked(*draw)
    >>> [ax.get_xlabel() for ax in figure.axes]
    ['', '$m r^2/I_1$']
    """
    figure = Figure(figsize=(SIZE[0], height), layout="constrained")
    for draw, ax in zip(draws, figure.subplots(len(draws), 1, sharex=True), strict=True):
        draw(ax)
        if ax is not figure.axes[-1]:
            ax.set_xlabel("")
    return figure


def dress(ax: Axes, x: str, y: str, title: str = "") -> Axes:
    """Label the axes, with units, in sizes that survive a small picture."""
    ax.set_xlabel(x, fontsize=TEXT)
    ax.set_ylabel(y, fontsize=TEXT)
    if title:
        ax.set_title(title, fontsize=TEXT)
    ax.tick_params(labelsize=SMALL)
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
    return ax


def rates_of(disk: Disk) -> str:
    """The unit of rates on an axis: sqrt(g/r) where that is 1, else the disk's, with the size of sqrt(g/r)."""
    return _unit(r"\sqrt{g/r}", disk.rate_unit)


def times_of(disk: Disk) -> str:
    """As `rates_of`, of times."""
    return _unit(r"\sqrt{r/g}", disk.time_unit)


def _unit(symbol: str, size: float) -> str:
    return f"${symbol}$" if size == 1.0 else f"units of the disk; ${symbol}$ = {size:.4g}"


def coordinate_label(name: str, disk: Disk) -> str:
    """Symbol and unit of a coordinate of the phase space."""
    unit = {"phi": "rad", "energy": _unit("m g r", disk.energy_unit)}.get(name) or rates_of(disk)
    return f"{_SYMBOLS[name]} ({unit})"


def values_label(fixed: Mapping[str, float]) -> str:
    """Coordinates that are held, with their values."""
    return ", ".join(f"{_SYMBOLS[name]} = {value:g}" for name, value in fixed.items())


def legend(ax: Axes, **options: Any) -> None:
    """A legend that does not hide what it explains."""
    ax.legend(fontsize=SMALL, framealpha=0.9, **options)
