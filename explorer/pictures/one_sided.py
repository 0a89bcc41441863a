"""The two one-sided limit motions, and the motions near F that tend to them."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from explorer.motion.both_sides import BothSides
from explorer.pictures.register import Question, picture
from explorer.pictures.style import (
    LAW,
    MARKERS,
    SERIES,
    SIDES,
    SIGN_COLOURS,
    SIZE,
    SMALL,
    arrow,
    dress,
    legend_below,
    number,
    times_of,
)

_FAINT = 0.13  # of bands
_LAW_ENDS = 0.02  # natural units; the law is of small eta
_BODY_NAMES = {"matching": r"flat body with $mr^2/I_1 = 3$"}


@picture(
    Question.EACH_SIDE,
    "How far a motion near F is from the limit motion of its own side, as η tends to 0. Lines are medians over "
    "the starts, bands reach up to the largest distance. Both fall like η ln(1/η): each side has its own limit.",
)
def one_sided_distance(ax: Axes, summary: dict[str, Any]) -> None:
    """Draw the distance to the limit motion of the same side against |eta_hat|, of the worse side, for each disk.

    summary: of a run of scene one-sided.
    """
    ax.set(xscale="log", yscale="log")
    anchors = []
    for index, (name, per_disk) in enumerate(summary["disks"].items()):
        rows = [row for row in per_disk["distances"] if "median_plus" in row or "median_minus" in row]
        if not rows:
            continue
        eta = np.array([row["eta_hat"] for row in rows])
        median, largest = (
            np.array([max(row.get(f"{what}_{side}", 0.0) for side in ("plus", "minus")) for row in rows])
            for what in ("median", "largest")
        )
        colour = SERIES[index % len(SERIES)]
        ax.plot(eta, median, label=name, color=colour, marker=MARKERS[index % len(MARKERS)], lw=1.6)
        ax.fill_between(eta, median, np.maximum(largest, median), color=colour, alpha=_FAINT, lw=0)
        anchors.append((eta.min(), median[eta.argmin()]))
    if anchors:
        smallest, height = anchors[0]
        eta = np.geomspace(smallest, max(_LAW_ENDS, 2.0 * smallest), 60)
        law = eta * np.log(1.0 / eta)
        name = r"$\propto \hat\eta\,\ln(1/\hat\eta)$"
        ax.plot(eta, 0.5 * height * law / law[0], color=LAW, lw=1.4, ls="--", label=name)
    band = Patch(color=LAW, alpha=_FAINT, lw=0, label="median to largest\nover the starts")
    legend_below(ax, ncols=3, handles=[*ax.get_legend_handles_labels()[0], band])
    title = "Each side of $F$ tends to its own limit motion"
    dress(ax, r"$|\hat\eta|$ ($\sqrt{g/r}$ of each disk)", "distance (rad; of paths, r)", title, grid=True)


@picture(
    Question.EACH_SIDE,
    "A motion just near F on both sides, with the limits. Above, the tilt φ: nothing in it tells the sides of F "
    "apart. Below, the angle of the contact point: at each near-fall, on the thin vertical lines, χ jumps by the "
    "race, κπ forwards on one side of F, κπ backwards on the other.",
    (SIZE[0], 6.4),
)
def one_sided_motion(figure: Figure, both: BothSides) -> None:
    """Draw the tilt and the angle of contact against time, as `explorer.both_sides` gives them."""
    tilt, angle = figure.subplots(2, 1, sharex=True)
    for sign, colour in SIGN_COLOURS.items():
        tilt.plot(both.t, both.motions[sign]["phi"], color=colour, lw=1.8, ls="-" if sign > 0 else (0, (4, 4)))
        angle.plot(both.t, both.motions[sign]["chi"], color=colour, lw=1.8, label=_side(both, sign))
        told = "limit of each side" if sign > 0 else None
        angle.plot(both.t, both.limits[sign].chi, color=LAW, lw=0.9, ls=":", label=told)
    limit = both.limits[1].phi
    tilt.plot(both.t, limit, color=LAW, lw=0.9, ls=":")
    places = {0.5 * np.pi: "flat, π/2", 0.0: "vertical", -0.5 * np.pi: "flat, −π/2"}
    shown = [at for at in places if limit.min() - 0.15 <= at <= limit.max() + 0.15]
    for at in shown:
        tilt.axhline(at, color=LAW, lw=0.6)
    tilt.set_yticks(shown, [places[at] for at in shown])
    for time in both.impacts:
        angle.axvline(time, color=LAW, lw=0.6, alpha=0.6)
    for sign in SIGN_COLOURS:
        _measure_jump(angle, both, sign)
    turns = round(both.disk.race_limit / np.pi)
    rest = 2.0 * both.disk.race_limit - 2.0 * np.pi * turns
    apart = "exactly" if abs(rest) < 1e-9 else f"{'+' if rest > 0.0 else '−'} {abs(rest):.3f} rad"
    legend_below(angle, ncols=3)
    dress(tilt, "", r"tilt $\varphi$ (rad)", f"{_named(both)}: both sides of $F$ fall and rise alike")
    dress(angle, f"t ({times_of(both.disk)})", r"$\chi$ (rad)")
    title = f"After a fall the sides are $2\\kappa\\pi$ apart: {turns} turns {apart}"
    angle.set_title(title, fontsize=SMALL)


def _measure_jump(ax: Axes, both: BothSides, sign: int) -> None:
    """A double arrow beside the first jump of a limit, from where it begins to where it ends."""
    row = int(np.searchsorted(both.t, both.impacts[0]))
    chi, jump, width = both.limits[sign].chi[row], sign * both.disk.race_limit, both.t[-1] - both.t[0]
    x = both.impacts[0] + 0.02 * width
    ends: dict[str, Any] = {"arrowstyle": "<->", "color": LAW, "lw": 1.1, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", (x, chi - jump), xytext=(x, chi), arrowprops=ends)
    text = f"{'+' if sign > 0 else '−'}κπ = {number(jump, '+.2f')}"
    ax.text(x + 0.01 * width, chi - 0.5 * jump, text, va="center", fontsize=SMALL)


@picture(
    Question.EACH_SIDE,
    "The path of the contact point on the table, seen from above, on both sides of F; arrows show the motion. "
    "Both start alike, race round the same circle in opposite senses where the disk nearly falls, and leave in "
    "directions that differ by 2κπ: in the same one where that is a number of whole turns.",
)
def contact_paths(ax: Axes, both: BothSides) -> None:
    """Draw the path of the contact point seen from above, as `explorer.both_sides` gives it.

    Dotted lines are the limit motions with their races.
    """
    r, apart = both.disk.r, abs(math.remainder(both.disk.gap, 2.0 * math.pi))
    for sign, colour in SIGN_COLOURS.items():
        path = both.motions[sign]["contact"][:, :2] / r
        ax.plot(*path.T, color=colour, lw=1.8, label=_side(both, sign))
        for row in (*_in_race(both, sign), len(path) - 1):
            arrow(ax, path, row, colour)
        if apart > 1e-9:  # else they cover each other
            other = both.motions[-sign]["contact"][:, :2] / r
            away = path[np.argmax([np.hypot(*(other - point).T).min() for point in path])]
            ax.annotate(SIDES[sign], away, (6, 6), textcoords="offset points", color=colour, fontsize=SMALL)
        limit = both.limit_path(sign) / r
        ax.plot(*limit.T, color=LAW, lw=0.9, ls=":", label="limit of each side" if sign > 0 else None)
    ax.plot(0.0, 0.0, marker="o", ls="", color=LAW, ms=6, label="start")
    ax.set_aspect("equal", adjustable="box")
    legend_below(ax, ncols=4 if both.disk.gap else 2)
    limits = (
        f"The sides leave each fall {apart:.3f} rad apart"
        if apart > 1e-9
        else "The limits of both sides are the same"
    )
    sigma3, speed = (float(values.ravel()[0]) for values in (both.start.sigma3, both.start.phidot))
    start = rf"$\sigma_3$ = {number(sigma3, '.3g')}, $\dot\varphi$ = {number(speed, '.3g')} at the start"
    dress(ax, "x (r)", "y (r)", f"{_named(both)}; {start}\n{limits}")


def _in_race(both: BothSides, sign: int) -> Iterator[int]:
    """Rows of the motion a quarter before and after the middle of each race."""
    chi, race = both.motions[sign]["chi"], sign * both.disk.race_limit
    for middle in np.searchsorted(both.t, both.impacts):
        around = np.arange(max(middle - len(chi) // 8, 0), min(middle + len(chi) // 8, len(chi)))
        for share in (-0.25, 0.25):
            yield int(around[abs(chi[around] - chi[middle] - share * race).argmin()])


def _named(both: BothSides) -> str:
    return _BODY_NAMES.get(both.disk.name, both.disk.name)


def _side(both: BothSides, sign: int) -> str:
    return rf"{SIDES[sign]}: $\hat\eta$ = {number(sign * both.eta_hat)}"
