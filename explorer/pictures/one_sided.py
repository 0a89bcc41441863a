"""The two one-sided limit motions, and the motions near F that tend to them."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from explorer.motion.both_sides import BothSides
from explorer.phase.states import Array
from explorer.pictures.register import Question, picture
from explorer.pictures.style import (
    LAW,
    SIDES,
    SIGN_COLOURS,
    SIZE,
    SMALL,
    arrow,
    body_looks,
    dress,
    legend_below,
    number,
    times_of,
)

_BODY_NAMES = {"matching": "$mr^2/I_1 = 3$"}
_LIMIT: dict[str, Any] = {"color": LAW, "lw": 0.9, "ls": ":"}


@picture(
    Question.EACH_SIDE,
    "How far motions are from the limit motion of their side, against their distance from F. The limit motion is "
    "what the motions on one side of F tend to as they come closer to F. Each coloured line is the median over "
    "the starts, taken on the side of F where the median is larger; the dashed line is the largest distance from "
    "the limit motion among all bodies and starts. Below 0.01 all lines are about as steep as η ln(1/η), the "
    "dotted line; its height has no meaning.",
)
def one_sided_distance(ax: Axes, summary: dict[str, Any]) -> None:
    """Draw the distance to the limit motion against |eta_hat| for each disk, on the side where it is larger.

    summary: the summary of a run of scene one-sided.
    """
    ax.set(xscale="log", yscale="log")
    looks = body_looks(summary["disks"])
    largest: dict[float, float] = {}
    for name, per_disk in summary["disks"].items():
        median: dict[float, float] = {}
        for row in per_disk["distances"]:
            at, sides = row["eta_hat"], [side for side in ("plus", "minus") if f"median_{side}" in row]
            if sides:
                median[at] = max(row[f"median_{side}"] for side in sides)
                largest[at] = max(largest.get(at, 0.0), *(row[f"largest_{side}"] for side in sides))
        colour, marker = looks[name]
        ax.plot(*_by_size(median), color=colour, marker=marker, label=f"{_BODY_NAMES.get(name, name)}, median")
    if largest:
        eta, most = _by_size(largest)
        ax.plot(eta, most, color="0.45", ls="--", label="the farthest of all")
        law = eta * np.log(1.0 / eta)
        ax.plot(
            eta, 0.1 * most.min() * law / law.min(), **_LIMIT | {"lw": 1.8}, label=r"$\propto\eta\,\ln(1/\eta)$"
        )
    legend_below(ax, ncols=2)
    title = "The nearer to $F$, the nearer to the limit of the side"
    dress(ax, r"$|\hat\eta|$ ($\sqrt{g/r}$ of each disk)", "distance (angles: rad, paths: r)", title, grid=True)


def _by_size(values: dict[float, float]) -> tuple[Array, Array]:
    """Distances from F in order, and what there is at each."""
    sizes = np.array(sorted(values))
    return sizes, np.array([values[size] for size in sizes])


@picture(
    Question.EACH_SIDE,
    "Tilt and angle of contact of two motions that start almost alike, one on each side of F. Both fall and rise "
    "alike, but where the disk is nearly flat the contact point races: κπ forwards on one side of F, κπ "
    "backwards on the other.",
    (SIZE[0], 6.4),
)
def one_sided_motion(figure: Figure, both: BothSides) -> None:
    """Draw the tilt and the angle of contact against time, as `explorer.both_sides` gives them."""
    tilt, angle = figure.subplots(2, 1, sharex=True)
    for side, colour in SIGN_COLOURS.items():
        tilt.plot(both.t, both.motions[side]["phi"], color=colour, lw=1.8, ls="-" if side > 0 else (0, (4, 4)))
        angle_of_contact(angle, both, side)
    limit = both.limits[1].phi
    tilt.plot(both.t, limit, **_LIMIT)
    places = {0.5 * np.pi: "flat, π/2", 0.0: "vertical", -0.5 * np.pi: "flat, −π/2"}
    shown = [at for at in places if limit.min() - 0.15 <= at <= limit.max() + 0.15]
    for at in shown:
        tilt.axhline(at, color=LAW, lw=0.6)
    tilt.set_yticks(shown, [places[at] for at in shown])
    for time in both.impacts:
        angle.axvline(time, color=LAW, lw=0.6, alpha=0.6)
    turns = round(both.disk.race_limit / np.pi)
    rest = 2.0 * both.disk.race_limit - 2.0 * np.pi * turns
    apart = "exactly" if abs(rest) < 1e-9 else f"{'+' if rest > 0.0 else '−'} {abs(rest):.3f} rad"
    legend_below(angle)
    dress(tilt, "", r"tilt $\varphi$ (rad)", f"{_named(both)}: both sides of $F$ fall and rise alike")
    title = f"After a fall the sides are $2\\kappa\\pi$ apart: {turns} turns {apart}"
    dress(angle, f"$t$ ({times_of(both.disk)})", r"$\chi$ (rad)", title)


def angle_of_contact(ax: Axes, both: BothSides, side: int, chi0: float = 0.0) -> None:
    """Draw chi of one side and of its limit, from chi0 on, with an arrow as long as the first race."""
    limit = both.limits[side].chi + chi0
    ax.plot(both.t, both.motions[side]["chi"] + chi0, color=SIGN_COLOURS[side], lw=1.8, label=_side(both, side))
    ax.plot(both.t, limit, **_LIMIT, label="limit of each side")
    end, race = limit[np.searchsorted(both.t, both.impacts[0])], side * both.disk.race_limit
    x, width = both.impacts[0], both.t[-1] - both.t[0]
    ends: dict[str, Any] = {"arrowstyle": "<->", "color": LAW, "lw": 1.1, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", (x + 0.03 * width, end - race), xytext=(x + 0.03 * width, end), arrowprops=ends)
    text = rf"${'+' if side > 0 else '-'}\kappa\pi$ = {number(race, '+.2f')}"
    # Near where it begins: later the curve may come back
    ax.text(x + 0.055 * width, end - 0.75 * race, text, va="center", fontsize=SMALL)


@picture(
    Question.EACH_SIDE,
    "The path of the contact point on the table, seen from above, on both sides of F; arrows show the motion. "
    "The two paths start alike, race round the same circle in opposite senses where the disk nearly falls, and "
    "leave in directions that differ by 2κπ. If 2κπ is a whole number of turns, this is the same direction.",
)
def contact_paths(ax: Axes, both: BothSides) -> None:
    """Draw the path of the contact point seen from above, as `explorer.both_sides` gives it.

    Dotted lines are the limit motions with their races.
    """
    for side in SIGN_COLOURS:
        path_on_table(ax, both, side, "contact", ls="-" if side > 0 else (0, (5, 1.5)))
    plus, limit, start, minus, *_ = ax.get_legend_handles_labels()[0]
    legend_below(ax, handles=[plus, minus, limit, start])
    apart = abs(math.remainder(both.disk.gap, 2.0 * math.pi))
    leave = f"the sides leave a fall {apart:.3f} rad apart" if apart > 1e-9 else "both sides have the same limit"
    dress(ax, "$x$ ($r$)", "$y$ ($r$)", f"{_named(both)}: {leave}")


def path_on_table(ax: Axes, both: BothSides, side: int, what: str, chi0: float = 0.0, **look: Any) -> None:
    """Draw the path of the "contact" point or of the centre, "path", of one side and of its limit, in radii.

    chi0: the angle of contact at the start (rad).
    """
    limit = both.limit_path(side) if what == "contact" else both.limits[side].path
    path, limit = (_turned(each, chi0) / both.disk.r for each in (both.motions[side][what], limit))
    ax.plot(*path.T, **{"color": SIGN_COLOURS[side], "lw": 1.8, "label": _side(both, side), **look})
    ax.plot(*limit.T, **_LIMIT, label="limit of each side")
    swings = both.impacts + 0.33 * (both.impacts[1] - both.impacts[0])  # the centre nearly stands still in a race
    shown = [*_in_race(both, side), len(path) - 1] if what == "contact" else np.searchsorted(both.t, swings)
    for row in shown:
        arrow(ax, path, min(int(row), len(path) - 1), SIGN_COLOURS[side])
    ax.plot(*path[0], marker="o", ls="", color=LAW, ms=6, label="start")
    ax.set_aspect("equal", adjustable="box")


def flattest(both: BothSides, side: int) -> Array:
    """Rows of the flattest moments of one side, of which each impact of the limit has one beside it."""
    wait = 0.25 * np.diff(both.impacts, prepend=0.0).min()
    near = abs(both.t - both.impacts[:, None]) < wait
    return np.asarray(np.argmax(np.where(near, abs(both.motions[side]["phi"]), 0.0), axis=1))


def _turned(path: Array, angle: float) -> Array:
    """The horizontal part of a path (n, 2 or 3), turned about its start at 0."""
    plane = (path[:, 0] + 1j * path[:, 1]) * np.exp(1j * angle)
    return np.stack([plane.real, plane.imag], axis=1)


def _in_race(both: BothSides, side: int) -> Iterator[int]:
    """Rows of the motion a quarter before and after the middle of each race."""
    chi, race = both.motions[side]["chi"], side * both.disk.race_limit
    for middle in flattest(both, side):
        around = np.arange(max(middle - len(chi) // 8, 0), min(middle + len(chi) // 8, len(chi)))
        for share in (-0.25, 0.25):
            yield int(around[abs(chi[around] - chi[middle] - share * race).argmin()])


def _named(both: BothSides) -> str:
    return _BODY_NAMES.get(both.disk.name, both.disk.name)


def _side(both: BothSides, side: int) -> str:
    return rf"{SIDES[side]}: $\hat\eta$ = {number(side * both.eta_hat)}"
