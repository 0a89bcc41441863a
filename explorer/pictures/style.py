"""The look of all pictures: sizes, colours that colour-blind users can tell apart, axes and their units."""

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import cycle
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from explorer.phase.columns import ANGLE, COLUMNS, ENERGY
from explorer.phase.coordinates import ANGULAR
from explorer.phase.disk import Disk
from explorer.phase.states import Array

# Okabe & Ito's palette. Blue is eta > 0 and vermilion eta < 0, the sides of F, and neither is anything else.
PLUS, MINUS = "#0072B2", "#D55E00"
DARK = "#222222"
SIGN_COLOURS = {1: PLUS, -1: MINUS}
SIDES = {1: r"$\eta > 0$", -1: r"$\eta < 0$"}  # said in words too: blue and vermilion are one grey in print
# Bodies, methods and other series: told apart by lightness too, and none like a side of F.
SERIES = (DARK, "#009E73", "#CC79A7", "#A08000", "#8A8A8A", "#004D40", "#7A4B91", "#B9B07A")
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<")
ACCENT, LAW = SERIES[2], DARK  # what a picture points at; laws and exact results are dark
# Colour and marker of each method and of each body, the same in all pictures.
METHODS = {
    "quadrature": (DARK, "*"),
    "rk4": (SERIES[1], "o"),
    "rk8": (SERIES[2], "s"),
    "dopri5": (SERIES[3], "^"),
    "dop853": (SERIES[4], "D"),
}
_BODIES = {"uniform": (SERIES[5], "o"), "hoop": (SERIES[6], "s"), "matching": (SERIES[3], "D")}
_OTHER_BODIES = tuple(zip((SERIES[1], SERIES[2], SERIES[4], SERIES[7]), "^vPX", strict=True))
# Perceptually even and readable in grey; the flattest states are brightest.
TILT_COLOURS = "cividis_r"
OTHER_COLOURS = "YlGn"  # of quantities other than the tilt, from little to much
SIGNED_COLOURS = "PRGn"  # of those with a sign: violet below 0, green above

# At 420 pixels, as the gallery shows them, also indices and exponents, 0.7 of their line, have 8.
SIZE = (5.6, 4.4)
TEXT, SMALL = 12, 11

# Tints of parts of a phase space, light enough for lines to stand out, and apart in grey.
FALLS, BOUNCES, UNSTABLE = "#C9BFD9", "#F8F6EE", "#D9D4C5"

HALF_PI = 0.5 * np.pi
FLAT_TICKS = ([-HALF_PI, -0.5, 0.0, 0.5, HALF_PI], ["−π/2", "−0.5", "0", "0.5", "π/2"])
HALO = [withStroke(linewidth=2.5, foreground="#FFFFFFB0")]  # of words that stand on colours
BEYOND = "beyond"  # gid of what marks data outside the axes
_SYMBOLS = {
    "phi": r"$\varphi$",
    "phidot": r"$\dot\varphi$",
    "sigma3": r"$\sigma_3$",
    "sigma4": r"$\sigma_4$",
    "sigma3_bar": r"$\bar\sigma_3$",
    "sigma4_bar": r"$\bar\sigma_4$",
    "eta_hat": r"$\hat\eta$",
    "energy": "$E$",
    "theta": r"$\theta$",
    "thetadot": r"$\dot\theta$",
    **{name: name.replace("_", " ") for name in ("tilt", "tilt_rate", "precession", "spin", "face")},
}


def axes_or_new(ax: Axes | None) -> Axes:
    """The axes given, or those of a new figure that no window manager knows."""
    return ax if ax is not None else Figure(figsize=SIZE, layout="constrained").subplots()


def body_looks(names: Iterable[str]) -> dict[str, tuple[str, str]]:
    """Colour and marker of each body: its own, or one that is left."""
    others = cycle(_OTHER_BODIES)
    return {name: _BODIES.get(name) or next(others) for name in names}


def dress(ax: Axes, x: str, y: str, title: str = "", grid: bool = False) -> Axes:
    """Label the axes, with units, in sizes that survive a small picture."""
    ax.set_xlabel(x, fontsize=TEXT)
    ax.set_ylabel(y, fontsize=TEXT)
    if title:
        ax.set_title(title, fontsize=TEXT)
    ax.tick_params(labelsize=SMALL)
    if grid:
        ax.grid(alpha=0.3)
    open_frame(ax)
    return ax


def label(ax: Axes, disk: Disk, x: str, y: str, title: str, degrees: bool = False) -> None:
    """As `dress`, of axes that are coordinates of the phase space."""
    dress(ax, coordinate_label(x, disk, degrees), coordinate_label(y, disk, degrees), title)


def colour_bar(
    ax: Axes, drawn: Any, text: str, ticks: Sequence[float] = (), names: Sequence[str] = (), **look: Any
) -> None:
    """A bar that says what colours mean, with ticks where they are given."""
    bar = ax.figure.colorbar(drawn, ax=ax, **look)
    if ticks:
        bar.set_ticks(list(ticks), labels=list(names) or [f"{tick:g}" for tick in ticks])
    bar.set_label(text, fontsize=TEXT)
    bar.ax.tick_params(labelsize=SMALL)


def open_frame(ax: Axes) -> None:
    """Leave out the lines of the frame that carry no axis."""
    ax.spines[["top", "right"]].set_visible(False)


def rates_of(disk: Disk) -> str:
    """The unit of rates on an axis: sqrt(g/r) where that is 1, else the disk's, with the size of sqrt(g/r)."""
    return _unit(r"\sqrt{g/r}", disk.rate_unit)


def times_of(disk: Disk) -> str:
    """As `rates_of`, of times."""
    return _unit(r"\sqrt{r/g}", disk.time_unit)


def _unit(symbol: str, size: float) -> str:
    return f"${symbol}$" if size == 1.0 else f"units of the disk; ${symbol}$ = {size:.4g}"


def coordinate_label(name: str, disk: Disk, degrees: bool = False) -> str:
    """Symbol and unit of a coordinate of the phase space."""
    return f"{_SYMBOLS[name]} ({_unit_of(name, disk, degrees)})"


def _unit_of(name: str, disk: Disk, degrees: bool) -> str:
    unit = COLUMNS[name].unit
    if degrees and name in ANGULAR:
        return unit.replace("rad", "degrees")
    return {ANGLE: "rad", ENERGY: _unit("m g r", disk.energy_unit)}.get(unit) or rates_of(disk)


def values_label(fixed: Mapping[str, float], disk: Disk, degrees: bool = False) -> str:
    """Coordinates that are held, with their values and units; in words these have room on the axes only."""
    natural = disk.rate_unit == disk.energy_unit == 1.0
    said = []
    for name, value in fixed.items():
        size = math.degrees(value) if degrees and name in ANGULAR else value
        unit = f" {_unit_of(name, disk, degrees)}" if natural and value else ""
        said.append(f"{_SYMBOLS[name]} = {number(size)}{unit}")
    return ", ".join(said)


def number(value: float, form: str = "g") -> str:
    """A number as it is printed, with a minus sign rather than a hyphen."""
    return format(value, form).replace("-", "−")


def power(value: float) -> str:
    """A number for mathematics of matplotlib, as a power of ten where it is a small one."""
    exponent = math.log10(value) if value > 0.0 else 0.5
    return f"10^{{{exponent:.0f}}}" if abs(exponent - round(exponent)) < 1e-9 and exponent < 0 else f"{value:g}"


def legend_below(ax: Axes, ncols: int = 2, **options: Any) -> None:
    """A legend under the name of the horizontal axis, where it covers nothing, to be read by rows."""
    place: dict[str, Any] = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.17), "columnspacing": 1.2}
    handles = options.pop("handles", None) or ax.get_legend_handles_labels()[0]
    if handles:
        ax.legend(handles=by_rows(handles, ncols), fontsize=SMALL, frameon=False, ncols=ncols, **(place | options))


def legend_of_all(figure: Figure, panels: Iterable[Axes], ncols: int = 2, more: Iterable[Artist] = ()) -> None:
    """A legend under a figure, of all that its panels name, and more."""
    handles = by_rows([*more, *(each for ax in panels for each in ax.get_legend_handles_labels()[0])], ncols)
    figure.legend(handles=handles, loc="outside lower center", fontsize=SMALL, frameon=False, ncols=ncols)


def by_rows(entries: Iterable[Any], ncols: int) -> list[Any]:
    """Entries in the order in which matplotlib, which fills columns, puts them into rows; each label once."""
    named: dict[str, Any] = {}
    for each in entries:
        named.setdefault(each.get_label(), each)
    return [each for column in range(ncols) for each in [*named.values()][column::ncols]]


def arrow(ax: Axes, path: Array, row: int, colour: str, size: float = 17.0) -> None:
    """An arrow head on row `row` of a path (n, 2), in the direction of the motion there."""
    path = np.asarray(path)[: row + 1]
    away = np.hypot(*(path - path[-1]).T)
    far = np.flatnonzero(away > 0.02 * np.nanmax(away))
    if far.size == 0:
        return
    look: dict[str, Any] = {"arrowstyle": "-|>", "color": colour, "lw": 0.0, "mutation_scale": size}
    look |= {"shrinkA": 0, "shrinkB": 0}
    ax.annotate("", tuple(path[-1]), xytext=tuple(path[far[-1]]), arrowprops=look, zorder=6)


def say_if_nothing(ax: Axes, values: Array, text: str) -> None:
    """Say in the middle of a picture why it is empty, where none of what it shows is known."""
    if not np.isfinite(values).any():
        ax.text(0.5, 0.5, text, ha="center", va="center", transform=ax.transAxes, fontsize=TEXT)


def mark_beyond(ax: Axes, x: Array, y: Array, colour: str, texts: Sequence[str] = ()) -> None:
    """Mark points that lie above or below the axes by a triangle at the edge, with what they are."""
    low, high = ax.get_ylim()
    for i, (at, value) in enumerate(zip(x, y, strict=True)):
        if low <= value <= high:
            continue
        above = value > high
        edge, marker, away = (high, "^", -12) if above else (low, "v", 6)
        ax.plot([at], [edge], marker, color=colour, ms=7, clip_on=False, gid=BEYOND, zorder=7)
        if i < len(texts):
            place: dict[str, Any] = {"xytext": (8, away), "textcoords": "offset points"}
            ax.annotate(texts[i], (at, edge), fontsize=SMALL, color=colour, **place)
