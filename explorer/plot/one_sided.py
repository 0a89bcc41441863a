"""Pictures of the two one-sided limit motions."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Patch

from explorer.plot.captions import Question, captioned
from explorer.plot.style import (
    LAW,
    MARKERS,
    SERIES,
    SIGN_COLOURS,
    SMALL,
    arrow,
    axes_or_new,
    dress,
    legend_below,
    number,
    styled,
    times_of,
)
from explorer.portrait.both_sides import BothSides

_SIDES = {1: r"\eta > 0", -1: r"\eta < 0"}
_FAINT = 0.13  # of bands
_LAW_ENDS = 0.02  # natural units; the law is of small eta
_BODY_NAMES = {"matching": r"flat body with $mr^2/I_1 = 3$"}


@captioned(
    Question.EACH_SIDE,
    "How far a motion beside F is from the limit motion of its own side, as η tends to 0. Lines are medians over "
    "the starts, bands reach up to the largest distance. Both fall like η ln(1/η): each side has its own limit.",
)
def one_sided_distance(summary: dict[str, Any], ax: Axes | None = None, **look: Any) -> Axes:
    """Draw the distance to the limit motion of the same side against |eta_hat|, for each disk.

    Parameters
    ----------
    summary : dict
        Of a run of scene one-sided.
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib for the lines of the medians.

    Returns
    -------
    Axes
        |eta_hat| and the distance over the starts, of the worse side: median as a line, up to the largest as a
        band; with the law eta ln(1/eta) through the smallest eta.

    Examples
    --------
    >>> import explorer as ex
    >>> run = ex.run("one-sided", out="sides", samples=4)  # doctest: +SKIP
    >>> ax = ex.plot.one_sided_distance(run.summary)  # doctest: +SKIP
    """
    ax = axes_or_new(ax)
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
        style = styled(look, color=colour, marker=MARKERS[index % len(MARKERS)], lw=1.6)
        ax.plot(eta, median, label=name, **style)
        ax.fill_between(eta, median, np.maximum(largest, median), color=colour, alpha=_FAINT, lw=0)
        anchors.append((eta.min(), median[eta.argmin()]))
    if anchors:
        smallest, height = anchors[0]
        eta = np.geomspace(smallest, max(_LAW_ENDS, 2.0 * smallest), 60)
        law = eta * np.log(1.0 / eta)
        label = r"$\propto \hat\eta\,\ln(1/\hat\eta)$"
        ax.plot(eta, 0.5 * height * law / law[0], color=LAW, lw=1.4, ls="--", label=label)
    band = Patch(color=LAW, alpha=_FAINT, lw=0, label="median to largest\nover the starts")
    legend_below(ax, ncols=3, handles=[*ax.get_legend_handles_labels()[0], band])
    return dress(
        ax,
        r"$|\hat\eta|$ ($\sqrt{g/r}$ of each disk)",
        "distance (rad; of paths, r)",
        "Each side of $F$ tends to its own limit motion",
        grid=True,
    )


@captioned(
    Question.EACH_SIDE,
    "The tilt φ against time just beside F, on both sides, with the limit. The three lie on each other: nothing "
    "in φ tells the sides of F apart.",
)
def one_sided_phi(both: BothSides, ax: Axes | None = None, **look: Any) -> Axes:
    """Draw the tilt phi(t) beside F and on the limits: it is the same on both sides.

    Parameters
    ----------
    both : BothSides
        From `explorer.both_sides`.
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib for the lines of the motions.

    Returns
    -------
    Axes
        Time and phi (rad).

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> from explorer import both_sides, constants_to_states
    >>> plot.one_sided_phi(both_sides(constants_to_states(Disk.hoop(), 1.0, 0.0, 1.0))).get_title()
    'hoop: both sides of $F$ fall and rise alike'
    """
    ax = axes_or_new(ax)
    for sign, colour in SIGN_COLOURS.items():
        style = styled(look, color=colour, lw=1.8, ls="-" if sign > 0 else (0, (4, 4)))
        ax.plot(both.t, both.motions[sign]["phi"], **style)
    limit = both.limits[1].phi
    ax.plot(both.t, limit, color=LAW, lw=0.9, ls=":")
    places = {0.5 * np.pi: "flat, π/2", 0.0: "vertical", -0.5 * np.pi: "flat, −π/2"}
    low, high = float(limit.min()) - 0.15, float(limit.max()) + 0.15
    shown = {at: name for at, name in places.items() if low <= at <= high}
    for at in shown:
        ax.axhline(at, color=LAW, lw=0.6)
    ax.set_yticks([*shown], [*shown.values()])
    title = f"{_named(both)}: both sides of $F$ fall and rise alike"
    return dress(ax, f"t ({times_of(both.disk)})", r"tilt $\varphi$ (rad)", title)


@captioned(
    Question.EACH_SIDE,
    "The angle of the contact point against time on both sides of F, with both limits. At each near-fall, on the "
    "thin vertical lines, χ jumps by the race: κπ forwards on one side of F, κπ backwards on the other.",
)
def one_sided_chi(both: BothSides, ax: Axes | None = None, **look: Any) -> Axes:
    """Draw the angle of contact chi(t) beside F and on both limits, with the size of the jumps.

    Parameters
    ----------
    both : BothSides
        From `explorer.both_sides`.
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib for the lines of the motions.

    Returns
    -------
    Axes
        Time and chi (rad); vertical lines are the impacts of the limits.

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> from explorer import both_sides, constants_to_states
    >>> plot.one_sided_chi(both_sides(constants_to_states(Disk.hoop(), 1.0, 0.0, 1.0))).get_ylabel()
    '$\\\\chi$ (rad)'
    """
    ax = axes_or_new(ax)
    for sign, colour in SIGN_COLOURS.items():
        style = styled(look, color=colour, lw=1.8, label=_side_label(both, sign))
        ax.plot(both.t, both.motions[sign]["chi"], **style)
        label = "limit of each side" if sign > 0 else None
        ax.plot(both.t, both.limits[sign].chi, color=LAW, lw=0.9, ls=":", label=label)
    for time in both.impacts:
        ax.axvline(time, color=LAW, lw=0.6, alpha=0.6)
    for sign in SIGN_COLOURS:
        _measure_jump(ax, both, sign)
    turns = round(both.disk.race_limit / np.pi)
    rest = 2.0 * both.disk.race_limit - 2.0 * np.pi * turns
    apart = "exactly" if abs(rest) < 1e-9 else f"{'+' if rest > 0.0 else '−'} {abs(rest):.3f} rad"
    ax.set_title(f"After a fall the sides are $2\\kappa\\pi$ apart: {turns} turns {apart}", fontsize=SMALL)
    legend_below(ax, ncols=3)
    return dress(ax, f"t ({times_of(both.disk)})", r"$\chi$ (rad)")


def _measure_jump(ax: Axes, both: BothSides, sign: int) -> None:
    """A double arrow beside the first jump of a limit, from where it begins to where it ends."""
    row = int(np.searchsorted(both.t, both.impacts[0]))
    chi, jump = both.limits[sign].chi, sign * both.disk.race_limit
    x = both.impacts[0] + 0.02 * (both.t[-1] - both.t[0])
    ends: dict[str, Any] = {"arrowstyle": "<->", "color": LAW, "lw": 1.1, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", (x, chi[row] - jump), xytext=(x, chi[row]), arrowprops=ends)
    text = f"{'+' if sign > 0 else '−'}κπ = {number(jump, '+.2f')}"
    ax.text(x + 0.01 * (both.t[-1] - both.t[0]), chi[row] - 0.5 * jump, text, va="center", fontsize=SMALL)


@captioned(
    Question.EACH_SIDE,
    "The path of the contact point on the table, seen from above, on both sides of F; arrows show the motion. "
    "Both start alike, race round the same circle in opposite senses where the disk nearly falls, and leave in "
    "directions that differ by 2κπ: in the same one where that is a number of whole turns.",
)
def contact_paths(both: BothSides, ax: Axes | None = None, **look: Any) -> Axes:
    """Draw the path of the contact point on the table seen from above, on both sides of F.

    Parameters
    ----------
    both : BothSides
        From `explorer.both_sides`.
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib for the paths of the motions.

    Returns
    -------
    Axes
        Both axes in radii of the disk; dotted lines are the limit motions with their races.

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> from explorer import both_sides, constants_to_states
    >>> both = both_sides(constants_to_states(Disk.matching(), 1.0, 0.0, 1.0))
    >>> plot.contact_paths(both).get_title().splitlines()[1]
    'The limits of both sides are the same'
    """
    ax = axes_or_new(ax)
    r = both.disk.r
    for sign, colour in SIGN_COLOURS.items():
        path = both.motions[sign]["contact"][:, :2] / r
        style = styled(look, color=colour, lw=1.8, label=_side_label(both, sign))
        ax.plot(*path.T, **style)
        for row in (*_in_race(both, sign), len(path) - 1):
            arrow(ax, path, row, colour)
        if circle_distance(both.disk.gap) > 1e-9:  # else they cover each other
            # Blue and vermilion are one grey in print.
            other = both.motions[-sign]["contact"][:, :2] / r
            away = path[np.argmax([np.hypot(*(other - point).T).min() for point in path])]
            name = r"$\eta > 0$" if sign > 0 else r"$\eta < 0$"
            ax.annotate(name, away, (6, 6), textcoords="offset points", color=colour, fontsize=SMALL)
        limit = both.limit_path(sign) / r
        ax.plot(*limit.T, color=LAW, lw=0.9, ls=":", label="limit of each side" if sign > 0 else None)
    ax.plot(0.0, 0.0, marker="o", ls="", color=LAW, ms=6, label="start")
    ax.set_aspect("equal", adjustable="box")
    legend_below(ax, ncols=4 if both.disk.gap else 2)
    apart = circle_distance(both.disk.gap)
    limits = "The limits of both sides are the same"
    if apart > 1e-9:
        limits = f"The sides leave each fall {apart:.3f} rad apart"
    sigma3, speed = (float(values.ravel()[0]) for values in (both.start.sigma3, both.start.phidot))
    start = rf"$\sigma_3$ = {number(sigma3, '.3g')}, $\dot\varphi$ = {number(speed, '.3g')} at the start"
    return dress(ax, "x (r)", "y (r)", f"{_named(both)}; {start}\n{limits}")


def circle_distance(angle: float) -> float:
    """How far an angle (rad) is from zero on the circle: 0 to pi."""
    return abs(math.remainder(angle, 2.0 * math.pi))


def _in_race(both: BothSides, sign: int) -> Iterator[int]:
    """Rows of the motion a quarter before and after the middle of each race."""
    chi, race = both.motions[sign]["chi"], sign * both.disk.race_limit
    for middle in np.searchsorted(both.t, both.impacts):
        for share in (-0.25, 0.25):
            near = abs(chi - chi[middle] - share * race)
            around = np.arange(max(middle - len(chi) // 8, 0), min(middle + len(chi) // 8, len(chi)))
            yield int(around[near[around].argmin()])


def _named(both: BothSides) -> str:
    return _BODY_NAMES.get(both.disk.name, both.disk.name)


def _side_label(both: BothSides, sign: int) -> str:
    return rf"${_SIDES[sign]}$: $\hat\eta$ = {number(sign * both.eta_hat)}"
