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
from explorer.phase.states import Array
from explorer.plot.portrait import _FLAT_TICKS, _HALF, _RATE, BOUNCES, FALLS, UNSTABLE
from explorer.plot.style import (
    DARK,
    DISK_COLOURS,
    FOURTH,
    MINUS,
    PLUS,
    SMALL,
    TEXT,
    THIRD,
    axes_or_new,
    dress,
    legend,
)
from explorer.portrait.potential import CENTRE, SADDLE
from explorer.portrait.steady import (
    PATHS,
    Branch,
    last_unstable_tilt,
    rolling_threshold,
    spinning_threshold,
    stability_edges,
    steady_motions,
)

TILTS = (0.2, 0.5, 0.8, 1.1, 1.4)


RADII = (0.5, 1.0, 2.0, 5.0)


def fold_curve(disk: Disk, points: int = 400) -> tuple[Array, Array]:
    """(sigma3_bar, sigma4_bar) where two steady motions merge (V' = V'' = 0), a closed curve with four cusps.

    The cusps are the thresholds of spinning upright and of straight rolling. Inside there is a saddle.
    """
    # In t both ends, where the two edges meet, and the vertical are smooth; t = 0 is kept out
    t = _HALF * (1.0 - np.linspace(0.0, 1.0, points)[:-1] ** 2)
    phi = last_unstable_tilt(disk) * (1.0 - 1e-12) * np.sin(t)
    fast, slow = (np.nan_to_num(row) for row in stability_edges(disk, phi))
    tilts = np.concatenate([-phi[::-1], -phi, phi[::-1], phi])
    turns = np.concatenate([slow[::-1], fast, fast[::-1], slow])
    half = steady_motions(disk, tilts, turns)
    x = np.concatenate([half.sigma3_bar, -half.sigma3_bar, half.sigma3_bar[:1]])
    return x, np.concatenate([half.sigma4_bar, -half.sigma4_bar, half.sigma4_bar[:1]])


def steady_plane(disk: Disk, ax: Axes | None = None) -> Axes:
    """The plane (sigma3_bar, sigma4_bar): l_+-, steady motions at several tilts, and where wells beside F exist.

    Each coloured curve holds the constants with a steady motion at one tilt |phi|; dashed where it is unstable.
    """
    ax = axes_or_new(ax)
    unit = disk.rate_unit
    x, y = fold_curve(disk)
    ax.fill(x, y, color=UNSTABLE, lw=0, label="a saddle exists")
    ax.plot(x, y, color=FOURTH, lw=1.6)
    width = 1.7 * max(float(abs(x).max()), float(abs(y).max()))
    turn = np.geomspace(1e-3, 1e3, 1200) * unit
    for colour, tilt in zip(DISK_COLOURS, TILTS, strict=False):
        for phi in (tilt, -tilt):
            for sign in (1.0, -1.0):
                found = steady_motions(disk, phi, sign * turn)
                label = rf"$|\varphi|$ = {tilt:g}" if phi > 0.0 < sign else None
                for stable, style in ((True, "-"), (False, "--")):
                    where = found.stable == stable
                    bar3, bar4 = (np.where(where, v, np.nan) for v in (found.sigma3_bar, found.sigma4_bar))
                    if where.any():
                        ax.plot(bar3, bar4, color=colour, ls=style, lw=1.2, label=label if stable else None)
    slope, most = line_slope(disk), well(disk)[1] * unit
    for number, face in enumerate((1, -1)):
        ends, inner = np.array([-3.0, 3.0]) * width, np.array([-most, most])
        ax.plot(ends, face * slope * ends, color=DARK, lw=1.2, label=None if number else r"$l_+$, $l_-$: falling")
        ax.plot(
            inner,
            face * slope * inner,
            color=DARK,
            lw=4.5,
            label=None if number else "a well besides",
        )
    spin, roll = spinning_threshold(disk), rolling_threshold(disk)
    ax.plot(
        [spin, -spin, 0.0, 0.0], [0.0, 0.0, roll, -roll], "D", color=DARK, mfc="white", ms=7, label="thresholds"
    )
    ax.set_xlim(-width, width)
    ax.set_ylim(-width, width)
    legend(ax, loc="center left", bbox_to_anchor=(1.01, 0.5))
    return dress(
        ax,
        rf"$\bar\sigma_3$ {_RATE}",
        rf"$\bar\sigma_4$ {_RATE}",
        f"Steady motions and the falling lines: {disk.name}",
    )


def steady_map(disk: Disk, ax: Axes | None = None) -> Axes:
    """Circular rolling over lean and rate of turning: which motions are stable, and the radii of their circles.

    At lean 0 stands spinning upright, stable above its threshold; straight rolling is the corner.
    """
    ax = axes_or_new(ax)
    unit = disk.rate_unit
    lean, turn = np.linspace(1e-3, 1.5, 241), np.linspace(0.02, 3.2, 321) * unit
    found = steady_motions(disk, -lean[None, :], turn[:, None])
    ax.pcolormesh(
        lean,
        turn,
        found.stable,
        cmap=ListedColormap([FALLS, BOUNCES]),
        vmin=0,
        vmax=1,
        rasterized=True,
        shading="nearest",
        zorder=0,
    )
    lines = ax.contour(lean, turn, found.radius / disk.r, levels=RADII, colors=DARK, linewidths=1.0)
    ax.clabel(lines, fmt=lambda value: f"R = {value:g} r", fontsize=SMALL)
    last = last_unstable_tilt(disk)
    phi = last * np.sin(np.linspace(0.0, _HALF, 200))[1:-1]
    fast, slow = stability_edges(disk, phi)
    ax.plot(
        np.concatenate([phi, phi[::-1]]),
        np.concatenate([slow, fast[::-1]]),
        color=FOURTH,
        lw=2.4,
        label=r"$V'' = 0$",
    )
    spin = spinning_threshold(disk)
    upright: dict[str, Any] = {"lw": 4.0, "clip_on": False}
    ax.plot([0.0, 0.0], [spin, turn[-1]], color=PLUS, label="upright, stable", **upright)
    ax.plot([0.0, 0.0], [0.0, spin], color=MINUS, ls=(0, (1.5, 1.0)), label="upright, unstable", **upright)
    ax.set_xlim(0.0, 1.5)
    ax.set_ylim(0.0, turn[-1])
    handles: list[Any] = [Patch(color=BOUNCES, label="stable"), Patch(color=FALLS, label="unstable")]
    legend(
        ax,
        handles=[*handles, *ax.get_legend_handles_labels()[0]],
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        ncols=3,
    )
    # Curves are everywhere inside: the legend goes between them and the title
    ax.set_title(f"Circular rolling: {disk.name}", fontsize=TEXT, pad=50)
    return dress(ax, r"lean $|\varphi|$ (rad)", rf"turning $\dot\chi$ {_RATE}")


_PATH_NAMES = {
    "spinning": (r"$\bar\sigma_3$", r"$\bar\sigma_4$ = 0: spinning upright"),
    "rolling": (r"$\bar\sigma_4$", r"$\bar\sigma_3$ = 0: straight rolling"),
    "line": (r"$\bar\sigma_3$", r"on $l_+$: beside the falling motions"),
}


def bifurcations(
    disk: Disk, path: str, branches: Sequence[Branch], marks: Sequence[float], ax: Axes | None = None
) -> Axes:
    """Tilts of all steady motions along a path through the plane of constants; marks: thresholds on it."""
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
    ax.set_yticks(*_FLAT_TICKS)
    for flat in (-_HALF, _HALF):
        ax.axhline(flat, color=DARK, lw=0.6)
    legend(ax, loc="upper right")
    symbol, name = _PATH_NAMES[path]
    return dress(ax, f"{symbol} {_RATE}", r"$\varphi$ of steady motions (rad)", f"{disk.name}, {name}")
