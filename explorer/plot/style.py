"""How pictures look: sizes, colours that colour-blind readers can tell apart, plain axes."""

from collections.abc import Callable
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

# Okabe & Ito's palette: blue for eta > 0, vermilion for eta < 0, everywhere.
PLUS, MINUS, THIRD, FOURTH, DARK = "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#222222"
SIGN_COLOURS = {1: PLUS, -1: MINUS}
DISK_COLOURS = (PLUS, MINUS, THIRD, FOURTH, "#E69F00", "#56B4E9")
MARKERS = ("o", "s", "^", "D", "v", "P")
# Perceptually even and readable in grey; the flattest states are brightest.
TILT_COLOURS = "cividis_r"

SIZE = (6.4, 4.8)
TEXT, SMALL = 12, 10.5

NAMES = {
    "phi": r"$\varphi$",
    "phidot": r"$\dot\varphi$",
    "sigma3": r"$\sigma_3$",
    "sigma4": r"$\sigma_4$",
}
UNITS = {"phi": "rad"}


def axes_or_new(ax: Axes | None) -> Axes:
    """The axes given, or those of a new figure that no window manager knows."""
    return ax if ax is not None else Figure(figsize=SIZE, layout="constrained").subplots()


def figure_of(draw: Callable[..., Axes], *arguments: Any) -> Figure:
    """The figure of one picture."""
    figure = draw(*arguments).figure
    assert isinstance(figure, Figure)
    return figure


def stacked(*draws: Callable[[Axes], Axes], height: float = 6.4) -> Figure:
    """Pictures above each other on one horizontal axis."""
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


def axis_label(name: str) -> str:
    """Symbol and unit of a coordinate of the phase space."""
    return f"{NAMES[name]} ({UNITS.get(name, 'rad per unit of time')})"


def legend(ax: Axes, **options: Any) -> None:
    """A legend that does not hide what it explains."""
    ax.legend(fontsize=SMALL, framealpha=0.9, **options)
