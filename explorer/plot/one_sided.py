"""Pictures of the two one-sided limit motions."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from explorer.plot.captions import Question, captioned
from explorer.plot.style import (
    DARK,
    DISK_COLOURS,
    MARKERS,
    SIGN_COLOURS,
    SMALL,
    axes_or_new,
    dress,
    legend,
    times_of,
)
from explorer.portrait.both_sides import BothSides

_SIDES = {1: r"\eta > 0", -1: r"\eta < 0"}


@captioned(
    Question.EACH_SIDE,
    "How far a motion beside F is from the limit motion of its own side, as η tends to 0. The distance falls "
    "like η ln(1/η), on both sides: each side has its own limit.",
)
def one_sided_distance(summary: dict[str, Any], ax: Axes | None = None) -> Axes:
    """Draw the distance to the limit motion of the same side against |eta_hat|, for each disk.

    Parameters
    ----------
    summary : dict
        Of a run of scene one-sided.
    ax : Axes, optional
        Where to draw; by default on a new figure.

    Returns
    -------
    Axes
        |eta_hat| and the median of the distance over the starts, with the law eta ln(1/eta).

    Examples
    --------
    >>> import explorer as ex
    >>> run = ex.run("one-sided", out="sides", samples=4)  # doctest: +SKIP
    >>> ax = ex.plot.one_sided_distance(run.summary)  # doctest: +SKIP
    """
    ax = axes_or_new(ax)
    smallest, largest = np.inf, 0.0
    for index, (name, per_disk) in enumerate(summary["disks"].items()):
        for sign, filled in (("plus", True), ("minus", False)):
            rows = [row for row in per_disk["distances"] if f"median_{sign}" in row]
            eta = np.array([row["eta_hat"] for row in rows])
            if eta.size == 0:
                continue
            smallest, largest = min(smallest, eta.min()), max(largest, eta.max())
            colour = DISK_COLOURS[index % len(DISK_COLOURS)]
            ax.loglog(
                eta,
                [row[f"median_{sign}"] for row in rows],
                marker=MARKERS[index % len(MARKERS)],
                mfc=colour if filled else "white",
                color=colour,
                ls="-" if filled else ":",
                label=rf"{name}, $\eta$ {'>' if filled else '<'} 0",
            )
    if largest > smallest:
        eta = np.geomspace(smallest, min(largest, 0.2), 60)
        ax.loglog(eta, eta * np.log(1.0 / eta), color=DARK, lw=1.2, ls="--", label=r"$\hat\eta\,\ln(1/\hat\eta)$")
    legend(ax, loc="lower right")
    ax.grid(alpha=0.3)
    return dress(
        ax,
        r"$|\hat\eta|$ (units of each disk)",
        "distance to the limit motion (rad or radii)",
        "Each side has its limit: median over starts, away from impacts",
    )


@captioned(
    Question.EACH_SIDE,
    "The tilt φ against time just beside F, on both sides, with the limit. The three cannot be told apart: in "
    "φ nothing tells the sides of F from each other.",
)
def one_sided_phi(both: BothSides, ax: Axes | None = None) -> Axes:
    """Draw the tilt phi(t) beside F and on the limits: it is the same on both sides.

    Parameters
    ----------
    both : BothSides
        From `both_sides`.
    ax : Axes, optional
        Where to draw; by default on a new figure.

    Returns
    -------
    Axes
        Time and phi (rad).

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> from explorer import both_sides, constants_to_states
    >>> plot.one_sided_phi(both_sides(constants_to_states(Disk.hoop(), 1.0, 0.0, 1.0))).get_title()
    'Beside F: hoop'
    """
    ax = axes_or_new(ax)
    for sign, colour in SIGN_COLOURS.items():
        ax.plot(both.t, both.motions[sign]["phi"], color=colour, lw=1.6, ls="-" if sign > 0 else "--")
    ax.plot(both.t, both.limits[1].phi, color=DARK, lw=0.9, ls=":", label="limit")
    for flat in (0.5 * np.pi, -0.5 * np.pi):
        ax.axhline(flat, color=DARK, lw=0.6)
    ax.set_yticks([-0.5 * np.pi, 0.0, 0.5 * np.pi], [r"flat, $-\pi/2$", "vertical", r"flat, $\pi/2$"])
    legend(ax, loc="best")
    return dress(ax, f"t ({times_of(both.disk)})", r"$\varphi$ (rad)", f"Beside F: {both.disk.name}")


@captioned(
    Question.EACH_SIDE,
    "The angle of the contact point against time on both sides of F, with both limits. At each near-fall it "
    "jumps by the race, κπ forwards on one side and κπ backwards on the other.",
)
def one_sided_chi(both: BothSides, ax: Axes | None = None) -> Axes:
    """Draw the angle of contact chi(t) beside F and on both limits, with the size of the jump.

    Parameters
    ----------
    both : BothSides
        From `both_sides`.
    ax : Axes, optional
        Where to draw; by default on a new figure.

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
        ax.plot(
            both.t,
            both.motions[sign]["chi"],
            color=colour,
            lw=1.6,
            ls="-" if sign > 0 else "--",
            label=_side_label(both, sign),
        )
        ax.plot(both.t, both.limits[sign].chi, color=DARK, lw=0.9, ls=":", label="its limit" if sign > 0 else None)
    for number, time in enumerate(both.impacts):
        ax.axvline(time, color=DARK, lw=0.6, alpha=0.6)
        if number == 0:
            ax.annotate(
                rf"$\pm\kappa\pi$ = $\pm${both.disk.race_limit:.3f}",
                (time, both.limits[1].chi[both.t < time][-1]),
                xytext=(8, 0),
                textcoords="offset points",
                va="center",
                fontsize=SMALL,
            )
    legend(ax, loc="upper left")
    return dress(ax, f"t ({times_of(both.disk)})", r"$\chi$ (rad)")


@captioned(
    Question.EACH_SIDE,
    "The path of the contact point on the table, seen from above, on both sides of F; arrows show the motion. "
    "Both disks start alike, race round in opposite senses where they nearly fall, and leave in different "
    "directions.",
)
def contact_paths(both: BothSides, ax: Axes | None = None) -> Axes:
    """Draw the path of the contact point on the table seen from above, on both sides of F.

    Parameters
    ----------
    both : BothSides
        From `both_sides`.
    ax : Axes, optional
        Where to draw; by default on a new figure.

    Returns
    -------
    Axes
        Both axes in radii of the disk; dotted lines are the limit motions, in pieces between their impacts.

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> from explorer import both_sides, constants_to_states
    >>> plot.contact_paths(both_sides(constants_to_states(Disk.matching(), 1.0, 0.0, 1.0))).get_title()
    'Path of the contact point, matching: limits the same'
    """
    ax = axes_or_new(ax)
    r = both.disk.r
    for sign, colour in SIGN_COLOURS.items():
        x, y, _ = (both.motions[sign]["contact"] / r).T
        ax.plot(x, y, color=colour, lw=1.6, ls="-" if sign > 0 else "--", label=_side_label(both, sign))
        ax.plot(x[-1], y[-1], marker=">", color=colour, ms=8)
        pieces = np.split(np.arange(both.t.size), np.searchsorted(both.t, both.impacts))
        for number, piece in enumerate(pieces):
            limit = both.limits[sign].contact[piece] / r
            label = "limit motion" if sign > 0 and number == 0 else None
            ax.plot(limit[:, 0], limit[:, 1], color=DARK, lw=0.9, ls=":", label=label)
    ax.plot(0.0, 0.0, marker="o", color=DARK, ms=6, label="start")
    ax.set_aspect("equal", adjustable="datalim")
    legend(ax, loc="best")
    differ = "the same" if both.disk.gap < 1e-9 else f"{both.disk.gap:.3f} rad apart per fall"
    return dress(ax, "x (radii)", "y (radii)", f"Path of the contact point, {both.disk.name}: limits {differ}")


def _side_label(both: BothSides, sign: int) -> str:
    return rf"${_SIDES[sign]}$: $\hat\eta$ = {sign * both.eta_hat:g}"
