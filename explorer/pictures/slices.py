"""Slices of the phase space: how flat the disk comes, which way it races, or any observable."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from explorer.errors import InputError, one_of
from explorer.measure.slices import Slice, SliceMap, slice_map
from explorer.motion.plan import method_in_words
from explorer.motion.scan import Scan
from explorer.phase.columns import COLUMNS
from explorer.phase.states import COORDINATES, Array
from explorer.pictures.register import Question, picture
from explorer.pictures.style import (
    DARK,
    HALO,
    LAW,
    MINUS,
    OTHER_COLOURS,
    PLUS,
    SIDES,
    SIGNED_COLOURS,
    SMALL,
    TILT_COLOURS,
    colour_bar,
    coordinate_label,
    dress,
    label,
    legend_below,
    say_if_nothing,
    values_label,
)

_FLATTEST, _TOP = (
    -3.0,
    float(np.log10(0.5 * np.pi)),
)  # colours end at 1e-3 rad: a picture resolves no narrower valley
_DECADES = (-2.0, -1.0, 0.0)  # of the tilt, on the bar of sides
# Strongest where flattest, and there the two meet: F is the edge between them.
_BOTH_SIDES = LinearSegmentedColormap.from_list(
    "sides", [(0.0, "#FBEDE2"), (0.5, MINUS), (0.5, PLUS), (1.0, "#E6F1F8")], N=512
).with_extremes(bad="#A8A8A8")
_HATCH = "#00000030"
_NO_FALL, _STEP = r"$\eta = 0$, no fall", "step: another well"
_NAMED = 0.03  # of the picture: smaller parts have no room for a name


def colour_tilt(ax: Axes, x: Array, y: Array, theta: Array, method: str) -> None:
    """A map of theta_min on a logarithmic scale, with its bar."""
    with np.errstate(divide="ignore", invalid="ignore"):
        tilt = np.log10(theta)
    mesh = ax.pcolormesh(x, y, tilt, cmap=TILT_COLOURS, vmin=_FLATTEST, vmax=_TOP, rasterized=True)
    text = rf"$\theta_{{\min}}$ (rad), {method_in_words(method)}"
    colour_bar(ax, mesh, text, (-3.0, *_DECADES), ("0.001", "0.01", "0.1", "1"), extend="min")
    say_if_nothing(ax, theta, "no sample was computed")


@picture(
    Question.FROM_WHERE,
    "How flat the disk comes, for every start in a plane of the phase space. The bright valleys are the falling "
    "set F, and the lines drawn on them are F as the algebra gives it. The tilt moves like a particle in a "
    "potential; beyond an abrupt change of colour it is in another well (valley) of this potential. F ends "
    "there; the thin lines that continue it show where η is 0 although the disk does not fall.",
)
def slice_of_tilts(ax: Axes, cut: SliceMap) -> None:
    """Draw theta_min on what `explorer.slice_map` returned, and the exact falling set over it.

    Lines are F, broken on face +1 and dotted on face -1; thin ones are eta = 0 where the disk would not fall.
    """
    colour_tilt(ax, cut.x, cut.y, cut["theta_min"], cut.method)
    handles = {line.get_label(): line for face in (1, -1) for line in _lines_of_f(ax, cut, face)}
    if _NO_FALL in handles:
        one, other = colormaps[TILT_COLOURS]([0.5, 0.9])
        look: dict[str, Any] = {"color": one, "markerfacecoloralt": other, "mec": "none", "fillstyle": "left"}
        handles[_STEP] = Line2D([], [], ls="", marker="s", ms=11, label=_STEP, **look)
    if handles:
        legend_below(ax, handles=[*handles.values()], handlelength=3.2)
    _label(ax, cut, "Where the disk falls:\n")


def _label(ax: Axes, cut: SliceMap, words: str) -> None:
    """Say what the axes are, and after these words what is held."""
    title = words + values_label(cut.slice.fixed, cut.disk, cut.degrees)
    label(ax, cut.disk, *cut.slice.axes, title, cut.degrees)


def _lines_of_f(ax: Axes, cut: SliceMap, face: int) -> Iterator[Line2D]:
    """Draw eta = 0 on one face, and return what the legend says of it."""
    from scipy.ndimage import binary_dilation

    distance, could = _of_face(cut, face)
    name, falls = ("+", (0, (8, 5))) if face > 0 else ("−", (0, (1, 2)))  # gaps let the valley show
    # A state that hardly moves could fall on one side of F alone: with eta set to 0 it would be below its own V.
    near = binary_dilation(could, np.ones((3, 3)))
    for mask, words, style, width in ((near, f"$F$, face {name}1", falls, 1.8), (~could, _NO_FALL, "-", 0.7)):
        if _zero_line(ax, cut, np.where(mask, distance, np.nan), style, width):
            yield Line2D([], [], color=LAW, ls=style, lw=width, label=words)


def _of_face(cut: SliceMap, face: int) -> tuple[Array, NDArray[np.bool_]]:
    """The distance from the line of a face, and where the disk could fall on it."""
    falls = cut.falls
    return (
        (falls.distance_plus, falls.could_fall_plus)
        if face > 0
        else (falls.distance_minus, falls.could_fall_minus)
    )


def _zero_line(ax: Axes, cut: SliceMap, values: Array, style: object, width: float) -> bool:
    """Draw where values change their sign; whether they do: matplotlib warns of contours that are not there."""
    finite = values[np.isfinite(values)]
    if not (finite.size and finite.min() <= 0.0 <= finite.max()):
        return False
    drawn = ax.contour(cut.x, cut.y, values, [0.0], colors=LAW, linewidths=width, linestyles=[style])
    return any(np.size(path.vertices) for path in drawn.get_paths())


@picture(
    Question.FROM_WHERE,
    "Which way the contact point races, for every start in a plane of the phase space: blue on one side of F, "
    "vermilion on the other. The flatter the disk comes, the stronger is the colour. F is where the strong "
    "colours meet. From a hatched region the disk cannot fall: even from the start with η = 0 and the same φ, "
    "energy and σ̄₃ (a constant of motion) it does not fall. The tilt moves like a particle in a potential; "
    "beyond an abrupt change of colour it is in another well (valley) of this potential.",
    group="slices",
    portraits=lambda asked: (
        (f"slice-{number}", (slice_map(asked.disk, where),))
        for number, where in enumerate(Slice.defaults(asked.disk), 1)
    ),
)
def slice_of_sides(ax: Axes, cut: SliceMap) -> None:
    """Draw what `explorer.slice_map` returned: to which side the contact point races, and how flat the disk comes.

    Blue where eta > 0 on the nearer face, vermilion where eta < 0; the smaller theta_min, the stronger the colour.
    Hatched where the disk would not fall on that face if eta were exactly 0 at the same phi, sigma3_bar and
    energy.
    """
    signed = signed_tilt(cut)
    mesh = ax.pcolormesh(cut.x, cut.y, signed, cmap=_BOTH_SIDES, vmin=-1.0, vmax=1.0, rasterized=True)
    heights = (np.array(_DECADES) - _FLATTEST) / (_TOP - _FLATTEST)
    names = ("1", "0.1", "0.01", "$F$", "0.01", "0.1", "1")
    text = r"$\eta < 0$      $\theta_{\min}$ (rad)      $\eta > 0$"
    colour_bar(ax, mesh, text, (*-heights[::-1], 0.0, *heights), names)
    say_if_nothing(ax, signed, "no sample was computed")
    _name_sides(ax, cut, signed)
    handles: list[Patch | Line2D] = []
    never = cut.side == 0
    if never.any() and not never.all():
        marks = ax.contourf(cut.x, cut.y, never, [0.5, 1.5], colors="none", hatches=["////"])
        marks.set_edgecolor(_HATCH)
        marks.set_linewidth(0.0)
        words = r"no fall at $\eta = 0$, same $\varphi$, $\bar\sigma_3$, $E$"
        handles.append(Patch(fc="white", ec=_HATCH, hatch="////", label=words))
    if cut.falls.face.min() < cut.falls.face.max():
        # The face is not known on a line where both are as near: a contour of it would only follow rounding.
        smooth = abs(cut.falls.distance_plus) - abs(cut.falls.distance_minus)
        ax.contour(cut.x, cut.y, smooth, [0.0], colors=DARK, linewidths=0.9, linestyles=":")
        handles.append(Line2D([], [], color=DARK, lw=0.9, ls=":", label="both faces are equally near"))
    if handles:
        legend_below(ax, handles=handles, ncols=1)
    _label(ax, cut, "Strong colours meet on $F$:\n")


def signed_tilt(cut: SliceMap) -> Array:
    """Sign of eta on the nearer face times log theta_min, from 0 (1e-3 rad or flatter) to 1 (pi/2)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        height = np.clip((np.log10(cut["theta_min"]) - _FLATTEST) / (_TOP - _FLATTEST), 1e-9, 1.0)
    return np.asarray(np.sign(cut.falls.distance) * height)


def _name_sides(ax: Axes, cut: SliceMap, signed: Array) -> None:
    """Write the side into the middle of each large part: in grey both colours are the same."""
    from scipy.ndimage import distance_transform_edt
    from scipy.ndimage import label as numbered

    for side, name in SIDES.items():
        parts, count = numbered(np.sign(signed) == side)
        for part in range(1, count + 1):
            inside = parts == part
            if inside.mean() > _NAMED:
                depth = distance_transform_edt(np.pad(inside, 1))[1:-1, 1:-1]
                row, column = np.unravel_index(int(np.argmax(depth)), depth.shape)
                place: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": SMALL, "color": DARK}
                ax.text(cut.x[column], cut.y[row], name, path_effects=HALO, **place)


@picture(
    Question.FROM_WHERE,
    "An observable of the user's own over a plane of the phase space, or over the states that were scanned. On a "
    "plane the dashed lines are the falling set F as the algebra gives it.",
)
def observable(ax: Axes, found: SliceMap | Scan, name: str | None = None) -> None:
    """Draw an observable of `explorer.slice_map` or `explorer.scan`, in colour or as a line.

    name: which of its observables; the first by default.
    """
    name = next(iter(found)) if name is None else one_of("name", name, list(found))
    values = found[name]
    if values.shape != found.shape or values.dtype.kind not in "fiub" or not values.size:
        raise InputError(f"name = {name!r}: has not one number for each state; choose another observable")
    values = values.astype(np.float64)
    words = name.replace("_", " ")
    unit = COLUMNS[name].unit if name in COLUMNS else ""
    say_if_nothing(ax, values, f"{words} is not known of any state")
    with_unit = f"{words} ({unit})" if unit else words
    if isinstance(found, SliceMap):
        mesh = ax.pcolormesh(found.x, found.y, values, **_colours_of(values), rasterized=True)
        colour_bar(ax, mesh, with_unit)
        drawn = False
        for face in (1, -1):
            distance, could = _of_face(found, face)
            drawn |= _zero_line(ax, found, np.where(could, distance, np.nan), "--", 1.0)
        if drawn:
            legend_below(ax, handles=[Line2D([], [], color=LAW, ls="--", lw=1.0, label="falling set $F$")])
        return _label(ax, found, f"{words}: ")
    disk, columns = found.states.disk, {each: np.ravel(getattr(found.states, each)) for each in COORDINATES}
    free = [each for each, column in columns.items() if np.unique(column[np.isfinite(column)]).size > 1]
    if len(free) < 2:
        x = free[0] if free else COORDINATES[0]
        ax.plot(columns[x], values.ravel(), color=DARK, marker="." if values.size < 50 else "")
        dress(ax, coordinate_label(x, disk), with_unit)
        return None
    first, second = free[:2]
    colour_bar(
        ax, ax.scatter(columns[first], columns[second], c=values.ravel(), **_colours_of(values), s=6), with_unit
    )
    return label(ax, disk, first, second, words)


def _colours_of(values: Array) -> dict[str, Any]:
    """Colours of little and much or, where there are both signs, of two ways with zero in the middle."""
    known = values[np.isfinite(values)]
    if not (known.size and known.min() < 0.0 < known.max()):
        return {"cmap": OTHER_COLOURS}
    most = float(abs(known).max())
    return {"cmap": SIGNED_COLOURS, "vmin": -most, "vmax": most}
