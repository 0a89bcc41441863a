"""Steady motions: where they lie and which are stable."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.patches import Patch

from explorer.errors import InputError
from explorer.phase.bifurcation import (
    fold_curve,
    last_unstable_tilt,
    rolling_threshold,
    spinning_threshold,
    stability_edges,
)
from explorer.phase.disk import Disk
from explorer.phase.falling_set import well
from explorer.phase.linear_constants import line_slope
from explorer.phase.potential import potential
from explorer.phase.steady import circular_rolling, steady_motions
from explorer.pictures.register import Question, picture
from explorer.pictures.style import (
    BOUNCES,
    DARK,
    HALF_PI,
    SERIES,
    SMALL,
    UNSTABLE,
    dress,
    label,
    legend_below,
    rates_of,
)

RADII = (0.5, 1.0, 2.0, 5.0)  # of the circles that are marked, in radii of the disk


@picture(
    Question.WHICH_MOTIONS,
    "The plane of the constants of motion: the lines of the falling motions, and a curve with four cusps. Inside "
    "this curve there is an unstable steady motion between two stable ones. At two of its cusps upright spinning "
    "becomes stable, at the other two straight rolling.",
    group="phase",
)
def steady_plane(ax: Axes, disk: Disk) -> None:
    """Draw the plane of constants: the lines l_+-, where they have wells, and where two steady motions merge."""
    x, y = fold_curve(disk)
    ax.fill(x, y, color=UNSTABLE, lw=0)
    width, height = 2.2 * abs(x).max(), 1.7 * abs(y).max()
    slope, most = line_slope(disk), well(disk).sigma3_bar * disk.rate_unit
    ends, inner = np.array([-3.0, 3.0]) * width, np.array([-most, most])
    for face, names in ((1, (r"$l_+$, $l_-$: falling", "with a well on it")), (-1, (None, None))):
        ax.plot(ends, face * slope * ends, color=DARK, lw=1.4, label=names[0])
        ax.plot(inner, face * slope * inner, color=DARK, lw=5.0, label=names[1])
    ax.plot(x, y, color=SERIES[1], lw=2.4, label="two steady motions merge")
    spin, roll = spinning_threshold(disk), rolling_threshold(disk)
    marks = [spin, -spin, 0.0, 0.0], [0.0, 0.0, roll, -roll]
    ax.plot(*marks, "D", color=DARK, mfc="white", ms=7, label="upright becomes stable")
    line: dict[str, Any] = {"arrowstyle": "-", "color": DARK, "lw": 0.8}
    for share, away in ((-0.6, 0.6), (-1.65, 0.0)):
        at = share * spin, 1e-3 * disk.rate_unit
        count = len(potential(disk, at[0], sigma4_bar=at[1]).equilibria)
        words = f"{count} steady\nmotion{'s' if count > 1 else ''}"
        to = (-1.6 * spin, away * height) if away else at
        ax.annotate(words, at, to, ha="center", va="center", fontsize=SMALL, arrowprops=line if away else None)
    ax.set_xlim(-width, width)
    ax.set_ylim(-height, height)
    legend_below(ax, ncols=2)
    title = f"Steady motions, and where the disk falls: {disk.name}"
    label(ax, disk, "sigma3_bar", "sigma4_bar", title)


@picture(
    Question.WHICH_MOTIONS,
    "Circular rolling by lean and precession: where it is stable, and where it is not. Along each line the disk "
    "rolls on circles of the same radius. In the dark tongue, where the precession is slow, rolling is unstable, "
    "and the disk falls over.",
    group="phase",
)
def steady_map(ax: Axes, disk: Disk) -> None:
    """Draw circular rolling over lean and precession: which motions are stable, and the radii of their circles.

    Spinning upright is at lean 0, and is stable above its threshold; straight rolling is the corner where lean and
    precession are 0.
    """
    unit = disk.rate_unit
    lean, precession = np.linspace(1e-3, HALF_PI - 1e-3, 241), np.linspace(0.02, 3.2, 321) * unit
    motions = steady_motions(disk, HALF_PI - lean[None, :], precession[:, None], face=-1)
    tints: dict[str, Any] = {"cmap": ListedColormap([UNSTABLE, BOUNCES]), "vmin": 0, "vmax": 1}
    ax.pcolormesh(lean, precession, motions.stable, **tints, rasterized=True, shading="nearest", zorder=0)
    lines = ax.contour(lean, precession, motions.radius / disk.r, levels=RADII, colors=DARK, linewidths=1.0)
    ax.clabel(lines, fmt=lambda value: f"R = {value:g} r", fontsize=SMALL, manual=_label_places(disk))
    phi = last_unstable_tilt(disk) * np.sin(np.linspace(0.0, HALF_PI, 200))[1:-1]
    fast, slow = stability_edges(disk, phi)
    edge = np.concatenate([phi, phi[::-1]]), np.concatenate([slow, fast[::-1]])
    ax.plot(*edge, color=SERIES[1], lw=2.4, label="edge of stability")
    spin = spinning_threshold(disk)
    upright: dict[str, Any] = {"color": DARK, "lw": 4.0, "clip_on": False}
    ax.plot([0.0, 0.0], [spin, precession[-1]], label="upright, stable", **upright)
    ax.plot([0.0, 0.0], [0.0, spin], ls=(0, (1.0, 0.8)), label="upright, unstable", **upright)
    ax.set_xlim(0.0, HALF_PI)
    ax.set_xticks([0.0, 0.5, 1.0, HALF_PI], ["0", "0.5", "1", "π/2"])
    ax.set_ylim(0.0, precession[-1])
    patches = [Patch(fc=tint, ec=DARK, label=name) for tint, name in ((BOUNCES, "stable"), (UNSTABLE, "unstable"))]
    legend_below(ax, handles=[*patches, *ax.get_legend_handles_labels()[0]], ncols=3)
    title = f"Circular rolling on circles of radius $R$: {disk.name}"
    dress(
        ax,
        r"lean $|\varphi|$ (rad); upright at 0, flat at π/2",
        rf"precession $\dot\chi$ ({rates_of(disk)})",
        title,
    )


def _label_places(disk: Disk) -> list[tuple[float, float]]:
    """Where lines of one radius are labelled: clear of the edge of stability."""
    places = []
    for radius in RADII:
        for lean in (1.25, 1.0, 0.5, 0.3, 0.15):
            try:
                rate = float(circular_rolling(disk, lean, radius * disk.r).precession)
            except InputError:
                continue
            if rate < 2.6 * disk.rate_unit:
                places.append((lean, rate))
                break
    return places
