"""Pictures of steady motions: where they lie, which are stable, and where that changes."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.patches import Patch

from explorer.phase.disk import Disk
from explorer.phase.lines import line_slope
from explorer.phase.membership import well
from explorer.plot.captions import Question, captioned
from explorer.plot.style import (
    BOUNCES,
    DARK,
    DISK_COLOURS,
    FALLS,
    FLAT_TICKS,
    FOURTH,
    HALF_PI,
    MINUS,
    PLUS,
    SMALL,
    TEXT,
    THIRD,
    UNSTABLE,
    axes_or_new,
    dress,
    legend,
    rates_of,
)
from explorer.portrait.potential import CENTRE, SADDLE
from explorer.portrait.steady import (
    PATHS,
    Branch,
    fold_curve,
    last_unstable_tilt,
    rolling_threshold,
    spinning_threshold,
    stability_edges,
    steady_motions,
)

TILTS = (0.2, 0.5, 0.8, 1.1, 1.4)
RADII = (0.5, 1.0, 2.0, 5.0)  # of the circles that are marked, in radii of the disk
_PATH_NAMES = {
    "spinning": (r"$\bar\sigma_3$", r"$\bar\sigma_4$ = 0: spinning upright"),
    "rolling": (r"$\bar\sigma_4$", r"$\bar\sigma_3$ = 0: straight rolling"),
    "line": (r"$\bar\sigma_3$", r"on $l_+$: beside the falling motions"),
}


@captioned(
    Question.WHICH_MOTIONS,
    "The plane of the constants of motion: the lines of the falling motions, the curves of steady motions, "
    "and the curve with four cusps inside which there is a saddle. The numbers count the equilibria.",
)
def steady_plane(disk: Disk, ax: Axes | None = None) -> Axes:
    """Draw the plane of constants: l_+-, steady motions at several tilts, and where wells beside F exist.

    Parameters
    ----------
    disk : Disk
    ax : Axes, optional
        Where to draw; by default on a new figure.

    Returns
    -------
    Axes
        sigma3_bar and sigma4_bar. Each coloured curve holds the constants with a steady motion at one tilt |phi|,
        dashed where it is unstable; tinted where a saddle exists.

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> plot.steady_plane(Disk.uniform()).get_title()
    'Steady motions and the falling lines: uniform'
    """
    ax = axes_or_new(ax)
    unit = disk.rate_unit
    x, y = fold_curve(disk)
    ax.fill(x, y, color=UNSTABLE, lw=0, label="a saddle exists")
    ax.plot(x, y, color=FOURTH, lw=1.6)
    width = 1.7 * max(float(abs(x).max()), float(abs(y).max()))
    precession = np.geomspace(1e-3, 1e3, 1200) * unit
    for colour, tilt in zip(DISK_COLOURS, TILTS, strict=False):
        for phi in (tilt, -tilt):
            for sign in (1.0, -1.0):
                motions = steady_motions(disk, phi, sign * precession)
                label = rf"$|\varphi|$ = {tilt:g}" if phi > 0.0 < sign else None
                for stable, style in ((True, "-"), (False, "--")):
                    where = motions.stable == stable
                    bar3, bar4 = (np.where(where, v, np.nan) for v in (motions.sigma3_bar, motions.sigma4_bar))
                    if where.any():
                        ax.plot(bar3, bar4, color=colour, ls=style, lw=1.2, label=label if stable else None)
    slope, most = line_slope(disk), well(disk).sigma3_bar * unit
    ends, inner = np.array([-3.0, 3.0]) * width, np.array([-most, most])
    for face, names in ((1, (r"$l_+$, $l_-$: falling", "a well besides")), (-1, (None, None))):
        ax.plot(ends, face * slope * ends, color=DARK, lw=1.2, label=names[0])
        ax.plot(inner, face * slope * inner, color=DARK, lw=4.5, label=names[1])
    spin, roll = spinning_threshold(disk), rolling_threshold(disk)
    marks = [spin, -spin, 0.0, 0.0], [0.0, 0.0, roll, -roll]
    ax.plot(*marks, "D", color=DARK, mfc="white", ms=7, label="thresholds")
    ax.set_xlim(-width, width)
    ax.set_ylim(-width, width)
    legend(ax, loc="center left", bbox_to_anchor=(1.01, 0.5))
    title = f"Steady motions and the falling lines: {disk.name}"
    return dress(ax, rf"$\bar\sigma_3$ ({rates_of(disk)})", rf"$\bar\sigma_4$ ({rates_of(disk)})", title)


@captioned(
    Question.WHICH_MOTIONS,
    "Circular rolling by lean and precession: where it is stable, and where it is not. Lines are circles of "
    "one radius; the unstable tongue is slow rolling that falls over.",
)
def steady_map(disk: Disk, ax: Axes | None = None) -> Axes:
    """Draw circular rolling over lean and precession: which motions are stable, and the radii of their circles.

    Parameters
    ----------
    disk : Disk
    ax : Axes, optional
        Where to draw; by default on a new figure.

    Returns
    -------
    Axes
        Lean (rad) and dchi/dt. At lean 0 stands spinning upright, stable above its threshold; straight rolling is
        the corner.

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> plot.steady_map(Disk.uniform()).get_title()
    'Circular rolling: uniform'
    """
    ax = axes_or_new(ax)
    unit = disk.rate_unit
    lean, precession = np.linspace(1e-3, 1.5, 241), np.linspace(0.02, 3.2, 321) * unit
    motions = steady_motions(disk, -lean[None, :], precession[:, None])
    tints: dict[str, Any] = {"cmap": ListedColormap([FALLS, BOUNCES]), "vmin": 0, "vmax": 1}
    ax.pcolormesh(lean, precession, motions.stable, **tints, rasterized=True, shading="nearest", zorder=0)
    lines = ax.contour(lean, precession, motions.radius / disk.r, levels=RADII, colors=DARK, linewidths=1.0)
    ax.clabel(lines, fmt=lambda value: f"R = {value:g} r", fontsize=SMALL)
    phi = last_unstable_tilt(disk) * np.sin(np.linspace(0.0, HALF_PI, 200))[1:-1]
    fast, slow = stability_edges(disk, phi)
    edge = np.concatenate([phi, phi[::-1]]), np.concatenate([slow, fast[::-1]])
    ax.plot(*edge, color=FOURTH, lw=2.4, label=r"$V'' = 0$")
    spin = spinning_threshold(disk)
    upright: dict[str, Any] = {"lw": 4.0, "clip_on": False}
    ax.plot([0.0, 0.0], [spin, precession[-1]], color=PLUS, label="upright, stable", **upright)
    ax.plot([0.0, 0.0], [0.0, spin], color=MINUS, ls=(0, (1.5, 1.0)), label="upright, unstable", **upright)
    ax.set_xlim(0.0, 1.5)
    ax.set_ylim(0.0, precession[-1])
    patches: list[Any] = [Patch(color=BOUNCES, label="stable"), Patch(color=FALLS, label="unstable")]
    handles = [*patches, *ax.get_legend_handles_labels()[0]]
    legend(ax, handles=handles, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3)
    # Curves are everywhere inside: the legend goes between them and the title
    ax.set_title(f"Circular rolling: {disk.name}", fontsize=TEXT, pad=50)
    return dress(ax, r"lean $|\varphi|$ (rad)", rf"precession $\dot\chi$ ({rates_of(disk)})")


@captioned(
    Question.WHICH_MOTIONS,
    "The tilt of steady motions along a path in the plane of constants, solid where stable and broken where "
    "unstable. At the threshold a branch appears, ends or changes its stability.",
)
def bifurcations(
    disk: Disk, path: str, branches: Sequence[Branch], marks: Sequence[float], ax: Axes | None = None
) -> Axes:
    """Draw the tilts of all steady motions along a path through the plane of constants.

    Parameters
    ----------
    disk : Disk
    path : str
        "spinning", "rolling" or "line", as for `explorer.portrait.steady.bifurcation`.
    branches : sequence of Branch
        From that function.
    marks : sequence of float
        Values of the parameter drawn as vertical lines, such as the thresholds of `path_values`.
    ax : Axes, optional
        Where to draw; by default on a new figure.

    Returns
    -------
    Axes
        The path's parameter and phi (rad); solid where stable.

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> from explorer.portrait.steady import bifurcation
    >>> disk = Disk.uniform()
    >>> branches = bifurcation(disk, "line", [0.1, 0.2, 0.3])
    >>> plot.bifurcations(disk, "line", branches, [0.34]).get_title()
    'uniform, on $l_+$: beside the falling motions'
    """
    ax = axes_or_new(ax)
    assert path in PATHS
    looks = {CENTRE: (PLUS, "-", "stable"), SADDLE: (MINUS, "--", "unstable")}
    seen: set[str] = set()
    for branch in branches:
        colour, style, name = looks[branch.kind]
        ax.plot(branch.parameter, branch.phi, color=colour, ls=style, lw=2.0, label=None if name in seen else name)
        seen.add(name)
    for number, mark in enumerate(marks):
        ax.axvline(mark, color=THIRD, lw=1.2, ls=":", label=None if number else f"threshold {abs(mark):.6g}")
    ax.set_ylim(-1.68, 1.68)
    ax.set_yticks(*FLAT_TICKS)
    for flat in (-HALF_PI, HALF_PI):
        ax.axhline(flat, color=DARK, lw=0.6)
    legend(ax, loc="upper right")
    symbol, name = _PATH_NAMES[path]
    title = f"{disk.name}, {name}"
    return dress(ax, f"{symbol} ({rates_of(disk)})", r"$\varphi$ of steady motions (rad)", title)
