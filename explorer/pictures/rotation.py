"""Turns of the contact point in one period, over all constants of motion at one energy."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.contour import ContourSet
from matplotlib.lines import Line2D
from matplotlib.patches import Ellipse

from explorer.errors import InputError
from explorer.motion.periods import periods
from explorer.phase.disk import Disk
from explorer.phase.linear_constants import line_slope
from explorer.phase.states import Array, phi_to_states
from explorer.pictures.register import Question, picture
from explorer.pictures.style import (
    DARK,
    HALO,
    SIGNED_COLOURS,
    SMALL,
    TEXT,
    colour_bar,
    label,
    legend_below,
    number,
)


@picture(
    Question.WHERE_TO,
    "By how many turns the contact point advances in one period, over the constants of motion at one energy: "
    "green one way, violet the other. The turns jump at the lines l₊ and l₋, where the disk comes flat, by twice "
    "the race. On the thin numbered lines, the resonances, the number of turns is whole, and the disk may wander "
    "off without bound.",
    group="rotation",
)
def rotation(ax: Axes, disk: Disk, energy: float = 2.0, points: int = 300) -> None:
    """Draw the turn of chi in one period tau, chi(tau)/2pi modulo 1, over (sigma3_bar, sigma4_bar), eq. (3.13).

    energy: in m g r; it must exceed 1, the energy of the upright disk. points: how many in each direction; an even
    number, so that none is on an axis.
    """
    x, y, turns = rotation_numbers(disk, energy, points)
    most = float(np.nanmax(abs(turns)))
    colours = ax.pcolormesh(x, y, turns, cmap=SIGNED_COLOURS, vmin=-most, vmax=most, rasterized=True)
    # Cells at the edge are whole or missing: cut through those that are whole.
    inner = 2.0 * (1.0 - 1.5 / points) * points / (points - 1)
    colours.set_clip_path(Ellipse((0.0, 0.0), inner * x[-1], inner * y[-1], transform=ax.transData))
    colour_bar(ax, colours, "turns per period")
    slope = line_slope(disk)
    above = [np.greater.outer(y, sign * slope * x) for sign in (1, -1)]
    for part in (above[0] & above[1], above[0] & ~above[1], ~above[0] & above[1], ~(above[0] | above[1])):
        there = np.where(part, turns, np.nan)  # no contour runs along a jump
        levels = np.arange(np.ceil(np.nanmin(there)) + 0.0, np.floor(np.nanmax(there)) + 1.0)  # of no -0
        if levels.size:
            _number(ax, ax.contour(x, y, there, levels, colors=DARK, linewidths=0.9, linestyles="-"))
    legend_below(ax, handles=[Line2D([], [], color=DARK, lw=0.9, label="a whole number of turns")])
    for sign, name in ((1, "$l_+$"), (-1, "$l_-$")):
        out = 1.0 / np.hypot(1.0 / x[-1], slope / y[-1])
        ax.plot([-out, out], [-sign * slope * out, sign * slope * out], color=DARK, lw=2.4)
        for edge in (-1.1, 1.1):
            ax.text(edge * out, edge * sign * slope * out, name, fontsize=TEXT, ha="center", va="center")
    ax.set_ylim(-1.2 * y[-1], 1.2 * y[-1])
    label(ax, disk, "sigma3_bar", "sigma4_bar", f"Turns jump where the disk comes flat ($E$ = {energy:g} $mgr$)")


def _number(ax: Axes, lines: ContourSet) -> None:
    """Write beside each contour its value, on the side away from the middle."""
    for level, path in zip(lines.levels, lines.get_paths(), strict=True):
        points = np.asarray(path.vertices)
        if points.size:
            x, y = points[np.argmax(abs(points[:, 0 if level else 1]))]
            place: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": SMALL}
            away = (8.0 * np.sign(level), 0.0) if level else (8.0, -12.0 * np.sign(y))
            ax.annotate(number(level), (x, y), away, textcoords="offset points", path_effects=HALO, **place)


def rotation_numbers(disk: Disk, energy: float, points: int) -> tuple[Array, Array, Array]:
    """(sigma3_bar, sigma4_bar, turns): sides of the grid, units of the disk, and turns (points, points).

    By sigma4_bar and by sigma3_bar, NaN where no motion of this energy passes the vertical, and on F. Raises
    InputError where there is none at all.
    """
    body, unit, free = disk.body, disk.rate_unit, energy - 1.0
    if not free > 0.0:
        raise InputError(f"energy = {energy!r}: upright, the disk has 1 m g r; give more")
    inside = (np.arange(points) + 0.5) * 2.0 / points - 1.0
    # At the vertical the energy is M phidot^2 / 2 + I1 sigma3^2 / 2 + J sigma4^2 / 2 + m g r.
    x, y = np.sqrt(2.0 * free / body.I1) * inside, np.sqrt(2.0 * free / body.J) * inside
    left = 2.0 * free - body.I1 * x**2 - (body.J * y**2)[:, None]
    rows, columns = np.nonzero(left > 0.0)
    phidot = np.sqrt(left[rows, columns] / body.M)
    states = phi_to_states(disk, 0.0, phidot * unit, x[columns] * unit, y[rows] * unit)
    turns = np.full(left.shape, np.nan)
    turns[rows, columns] = periods(states, accuracy=1e-4).chi / (2.0 * np.pi)  # a hundredth of what a colour shows
    return x * unit, y * unit, turns
