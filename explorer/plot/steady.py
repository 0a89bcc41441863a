"""Pictures of steady motions: where they lie, which are stable, and where that changes."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.patches import Patch

from explorer.errors import InputError, one_of
from explorer.phase.disk import Disk
from explorer.phase.lines import line_slope
from explorer.phase.membership import well
from explorer.phase.states import Array
from explorer.plot.captions import Question, captioned
from explorer.plot.style import (
    BOUNCES,
    DARK,
    FLAT_TICKS,
    HALF_PI,
    SERIES,
    SMALL,
    UNSTABLE,
    axes_or_new,
    coordinate_label,
    dress,
    legend_below,
    rates_of,
    styled,
)
from explorer.portrait.potential import CENTRE, SADDLE
from explorer.portrait.potentials import at_constants
from explorer.portrait.steady import (
    PATHS,
    Branch,
    circular_rolling,
    fold_curve,
    last_unstable_tilt,
    rolling_threshold,
    spinning_threshold,
    stability_edges,
    steady_motions,
)

TILTS = (0.2, 0.5, 0.8, 1.1, 1.4)
# Thresholds of the bodies that the paper names, in closed form.
_EXACT = {
    ("uniform", "rolling"): r" = ±$1/\sqrt{3}$",
    ("uniform", "spinning"): r" = ±$2/\sqrt{5}$",
    ("hoop", "rolling"): " = ±1/2",
    ("hoop", "spinning"): r" = ±$\sqrt{2/3}$",
}
RADII = (0.5, 1.0, 2.0, 5.0)  # of the circles that are marked, in radii of the disk
PATH_NAMES = {
    "spinning": (r"$\bar\sigma_3$", r"steady motions with $\bar\sigma_4$ = 0: spinning upright"),
    "rolling": (r"$\bar\sigma_4$", r"steady motions with $\bar\sigma_3$ = 0: straight rolling"),
    "line": (r"$\bar\sigma_3$", r"steady motions on the falling line $l_+$"),
}


@captioned(
    Question.WHICH_MOTIONS,
    "The plane of the constants of motion: the lines of the falling motions, the curves of steady motions, "
    "and the curve with four cusps inside which there is a saddle. The numbers count the equilibria.",
)
def steady_plane(disk: Disk, ax: Axes | None = None, **look: Any) -> Axes:
    """Draw the plane of constants: l_+-, steady motions at several tilts, and where wells beside F exist.

    Parameters
    ----------
    disk : Disk
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib for the lines.

    Returns
    -------
    Axes
        sigma3_bar and sigma4_bar. Each grey curve holds the constants with a steady motion at one tilt |phi|,
        broken where it is unstable, in one of four equal quadrants; tinted where a saddle exists.

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> plot.steady_plane(Disk.uniform()).get_title()
    'Falling lines, and how many steady motions there are: uniform'
    """
    ax = axes_or_new(ax)
    x, y = fold_curve(disk)
    ax.fill(x, y, color=UNSTABLE, lw=0)
    width = 1.7 * max(float(abs(x).max()), float(abs(y).max()))
    _tilt_curves(ax, disk, width, look)
    slope, most = line_slope(disk), well(disk).sigma3_bar * disk.rate_unit
    ends, inner = np.array([-3.0, 3.0]) * width, np.array([-most, most])
    for face, names in ((1, (r"$l_+$, $l_-$: falling", "with a well on it")), (-1, (None, None))):
        ax.plot(ends, face * slope * ends, color=DARK, lw=1.4, label=names[0])
        ax.plot(inner, face * slope * inner, color=DARK, lw=5.0, label=names[1])
    ax.plot(x, y, color=SERIES[1], lw=2.4, label="two steady motions merge")
    spin, roll = spinning_threshold(disk), rolling_threshold(disk)
    marks = [spin, -spin, 0.0, 0.0], [0.0, 0.0, roll, -roll]
    ax.plot(*marks, "D", color=DARK, mfc="white", ms=7, label="upright becomes stable")
    off = 1e-3 * disk.rate_unit
    for share in (-0.5, -1.4):
        at = share * spin, off
        ax.text(*at, f"{len(at_constants(disk, *at).equilibria)}", ha="center", va="center", fontsize=16)
    ax.set_xlim(-width, width)
    ax.set_ylim(-width, width)
    handles, labels = ax.get_legend_handles_labels()
    legend_below(ax, ncols=2, handles=handles, labels=labels)
    title = f"Falling lines, and how many steady motions there are: {disk.name}"
    return dress(ax, coordinate_label("sigma3_bar", disk), coordinate_label("sigma4_bar", disk), title)


def _tilt_curves(ax: Axes, disk: Disk, width: float, look: dict[str, Any]) -> None:
    """Constants with a steady motion of one tilt, in one quadrant: mirror images fill the others."""
    precession = np.geomspace(1e-3, 1e3, 1200) * disk.rate_unit
    for place, tilt in enumerate(TILTS):
        grey = str(0.78 - 0.17 * place)
        for phi in (tilt, -tilt):
            for sign in (1.0, -1.0):
                motions = steady_motions(disk, phi, sign * precession)
                inside = (motions.sigma3_bar >= 0.0) & (motions.sigma4_bar >= 0.0)
                for stable, style in ((True, "-"), (False, (0, (2, 1)))):
                    where = inside & (motions.stable == stable)
                    if not where.any():
                        continue
                    curve = [np.where(where, v, np.nan) for v in (motions.sigma3_bar, motions.sigma4_bar)]
                    label = f"_tilt {tilt:g}" if stable and phi > 0.0 < sign else None  # named at its end instead
                    ax.plot(*curve, **styled(look, color=grey, ls=style, lw=1.3, label=label))
                    if stable:
                        _name_tilt(ax, disk, tilt, (curve[0], curve[1]), width)


def _name_tilt(ax: Axes, disk: Disk, tilt: float, curve: tuple[Array, Array], width: float) -> None:
    """Write the tilt of a curve where it leaves the picture at the right, below l_+."""
    x, y = curve
    (out,) = np.nonzero((x[:-1] < width) != (x[1:] < width))
    for row in out[np.isfinite(x[out] + x[out + 1])]:
        if y[row] < line_slope(disk) * width:
            text = rf"$|\varphi|$ = {tilt:g}" if tilt == TILTS[0] else f"{tilt:g}"
            place: dict[str, Any] = {"xytext": (4, 0), "textcoords": "offset points", "annotation_clip": False}
            ax.annotate(text, (width, y[row]), va="center", fontsize=SMALL, **place)


def _label_places(disk: Disk) -> list[tuple[float, float]]:
    """Where lines of one radius are labelled: clear of the edge of stability."""
    places = []
    for radius in RADII:
        for lean in (1.25, 1.0, 0.5, 0.3, 0.15):
            try:
                rate = circular_rolling(disk, lean, radius * disk.r)
            except InputError:
                continue
            if rate < 2.6 * disk.rate_unit:
                places.append((lean, rate))
                break
    return places


@captioned(
    Question.WHICH_MOTIONS,
    "Circular rolling by lean and precession: where it is stable, and where it is not. Lines are circles of "
    "one radius; the unstable tongue is slow rolling that falls over.",
)
def steady_map(disk: Disk, ax: Axes | None = None, **look: Any) -> Axes:
    """Draw circular rolling over lean and precession: which motions are stable, and the radii of their circles.

    Parameters
    ----------
    disk : Disk
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib for the lines.

    Returns
    -------
    Axes
        Lean (rad) and dchi/dt. At lean 0 stands spinning upright, stable above its threshold; straight rolling is
        the corner.

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> plot.steady_map(Disk.uniform()).get_title()
    'Circular rolling on circles of radius $R$: uniform'
    """
    ax = axes_or_new(ax)
    unit = disk.rate_unit
    lean, precession = np.linspace(1e-3, HALF_PI - 1e-3, 241), np.linspace(0.02, 3.2, 321) * unit
    motions = steady_motions(disk, -lean[None, :], precession[:, None])
    tints: dict[str, Any] = {"cmap": ListedColormap([UNSTABLE, BOUNCES]), "vmin": 0, "vmax": 1}
    ax.pcolormesh(lean, precession, motions.stable, **tints, rasterized=True, shading="nearest", zorder=0)
    lines = ax.contour(lean, precession, motions.radius / disk.r, levels=RADII, colors=DARK, linewidths=1.0)
    ax.clabel(lines, fmt=lambda value: f"R = {value:g} r", fontsize=SMALL, manual=_label_places(disk))
    phi = last_unstable_tilt(disk) * np.sin(np.linspace(0.0, HALF_PI, 200))[1:-1]
    fast, slow = stability_edges(disk, phi)
    edge = np.concatenate([phi, phi[::-1]]), np.concatenate([slow, fast[::-1]])
    ax.plot(*edge, **styled(look, color=SERIES[1], lw=2.4, label="edge of stability"))
    spin = spinning_threshold(disk)
    upright: dict[str, Any] = {"lw": 4.0, "clip_on": False}
    ax.plot([0.0, 0.0], [spin, precession[-1]], color=DARK, label="upright, stable", **upright)
    ax.plot([0.0, 0.0], [0.0, spin], color=DARK, ls=(0, (1.0, 0.8)), label="upright, unstable", **upright)
    ax.set_xlim(0.0, HALF_PI)
    ax.set_xticks([0.0, 0.5, 1.0, HALF_PI], ["upright", "0.5", "1", "flat, π/2"])
    ax.set_ylim(0.0, precession[-1])
    patches: list[Any] = [
        Patch(facecolor=BOUNCES, edgecolor=DARK, label="stable"),
        Patch(facecolor=UNSTABLE, edgecolor=DARK, label="unstable"),
    ]
    handles = [*patches, *ax.get_legend_handles_labels()[0]]
    legend_below(ax, handles=handles, ncols=3)
    title = f"Circular rolling on circles of radius $R$: {disk.name}"
    return dress(ax, r"lean $|\varphi|$ (rad)", rf"precession $\dot\chi$ ({rates_of(disk)})", title)


@captioned(
    Question.WHICH_MOTIONS,
    "The tilt of steady motions along a path in the plane of constants, solid where stable and broken where "
    "unstable. At the threshold a branch appears, ends or changes its stability.",
)
def bifurcations(
    disk: Disk,
    path: str,
    branches: Sequence[Branch],
    marks: Sequence[float],
    ax: Axes | None = None,
    **look: Any,
) -> Axes:
    """Draw the tilts of all steady motions along a path through the plane of constants.

    Parameters
    ----------
    disk : Disk
    path : str
        "spinning", "rolling" or "line", as for `explorer.portrait.bifurcation`.
    branches : sequence of Branch
        From that function.
    marks : sequence of float
        Values of the parameter drawn as vertical lines, such as the thresholds of `path_values`.
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib for the lines.

    Returns
    -------
    Axes
        The path's parameter and phi (rad); solid where stable.

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> from explorer.portrait import bifurcation
    >>> disk = Disk.uniform()
    >>> branches = bifurcation(disk, "line", [0.1, 0.2, 0.3])
    >>> plot.bifurcations(disk, "line", branches, [0.34]).get_title()
    'uniform, steady motions on the falling line $l_+$'
    """
    one_of("path", path, PATHS)
    ax = axes_or_new(ax)
    looks: dict[str, tuple[Any, str]] = {CENTRE: ("-", "stable"), SADDLE: ((0, (3, 1.5)), "unstable")}
    seen: set[str] = set()
    for branch in branches:
        line, name = looks[branch.kind]
        style = styled(look, color=DARK, ls=line, lw=2.0, label=None if name in seen else name)
        ax.plot(branch.parameter, branch.phi, **style)
        seen.add(name)
    _thresholds(ax, disk, path, marks)
    _tilts(ax)
    if path == "line" and len(marks):
        _nothing_beyond(ax, max(marks))
    legend_below(ax, ncols=3)
    symbol, name = PATH_NAMES[path]
    title = f"{disk.name}, {name}"
    return dress(ax, f"{symbol} ({rates_of(disk)})", r"$\varphi$ (rad); flat at ±π/2", title)


def _nothing_beyond(ax: Axes, most: float) -> None:
    """Say that beyond the well there is no steady motion on the falling line."""
    ax.set_xlim(-1.4 * most, 1.4 * most)
    for end in (-1.2, 1.2):
        ax.text(end * most, 0.0, "no steady\nmotion", ha="center", va="center", fontsize=SMALL)


def _thresholds(ax: Axes, disk: Disk, path: str, marks: Sequence[float]) -> None:
    """Vertical lines at the thresholds, with their value, and its closed form where it has a short one."""
    for number, mark in enumerate(marks):
        exact = _EXACT.get((disk.name, path), "")
        name = f"threshold ±{abs(mark) / disk.rate_unit:.5f}{exact}"
        ax.axvline(mark, color=SERIES[1], lw=1.4, ls=":", label=None if number else name)


def _tilts(ax: Axes) -> None:
    """The vertical axis, from one flat state to the other."""
    ax.set_ylim(-1.68, 1.68)
    ax.set_yticks(*FLAT_TICKS)
    for flat in (-HALF_PI, HALF_PI):
        ax.axhline(flat, color=DARK, lw=0.6)
