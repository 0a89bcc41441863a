"""The portrait of both sides of F: alike in the tilt, opposite in the race."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from explorer.plot.captions import Question, captioned
from explorer.plot.potential import BESIDE, line_name
from explorer.plot.style import (
    DARK,
    FLAT_TICKS,
    HALF_PI,
    SIGN_COLOURS,
    SIZE,
    SMALL,
    TEXT,
    arrow,
    coordinate_label,
    dress,
    number,
    rates_of,
)
from explorer.portrait.potential import Component, Potential
from explorer.portrait.potentials import level_energies

_OF_SIDES = 4  # levels of a portrait of both sides


@captioned(
    Question.WHICH_MOTIONS,
    "The same motions on both sides of F, blue and vermilion, in two planes. Left, the tilt φ and its rate: the "
    "sides are alike, and both turn back just before flat. Right, the speed of the contact point along the rim, "
    "ρ = σ₃/cos φ, against the rate of the tilt: near flat each motion runs along half of an ellipse, and the two "
    "halves are the races, in opposite directions. The loops inside, alike on both sides, are the far turn.",
)
def portrait_of_sides(
    plus: Potential, minus: Potential, energies: tuple[float, float] | None = None, **look: Any
) -> Figure:
    """Draw levels of the energy on both sides of F, in the plane of the tilt and in that of the race.

    Parameters
    ----------
    plus, minus : Potential
        From `explorer.portrait.on_line`, with one sigma3_bar and eta_hat of either sign.
    energies : (float, float), optional
        Range of the levels, units of the disk; by default from the bottom of V to above all saddles.
    **look
        Passed on to matplotlib for the lines of the levels.

    Returns
    -------
    Figure
        Left phi (rad) and phidot, right rho and phidot.

    References
    ----------
    Eq. (7.6) and Lemma 6 of the paper.

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> from explorer.portrait import on_line
    >>> figure = plot.portrait_of_sides(*(on_line(Disk.uniform(), 0.25, eta) for eta in (0.01, -0.01)))
    >>> [ax.get_title() for ax in figure.axes]
    ['The tilt: both sides alike', 'The race: opposite ways']
    """
    figure = Figure(figsize=(1.45 * SIZE[0], SIZE[1]), layout="constrained")
    tilt, race = figure.subplots(1, 2, sharey=True)
    handles = [_levels(tilt, race, potential, energies, look) for potential in (plus, minus)]
    rate, unit = coordinate_label("phidot", plus.disk), rates_of(plus.disk)
    for face in (-1, 1):
        tilt.axvline(face * HALF_PI, color=DARK, lw=3.0)
    race.axvline(0.0, color=DARK, lw=0.6)
    tilt.set_xlim(-1.68, 1.68)
    tilt.set_xticks(*FLAT_TICKS)
    dress(tilt, r"$\varphi$ (rad); flat at ±π/2", rate, "The tilt: both sides alike")
    dress(race, rf"contact point along the rim, $\rho$ ({unit})", "", "The race: opposite ways")
    figure.legend(handles=handles, loc="outside lower center", ncols=2, fontsize=SMALL, frameon=False)
    figure.suptitle(
        rf"{plus.disk.name}: $\bar\sigma_3$ = {plus.sigma3_bar:.4g}, beside ${line_name(plus)}$", fontsize=TEXT
    )
    return figure


def _levels(
    tilt: Axes, race: Axes, potential: Potential, energies: tuple[float, float] | None, look: dict[str, Any]
) -> Line2D:
    """The levels of one side that come near its flat state, in both planes; returns a line for the legend."""
    side = 1 if potential.eta > 0.0 else -1
    name = rf"$\hat\eta$ = {number(potential.eta_hat, '.4g')}"
    style: dict[str, Any] = {"lw": 1.5, **BESIDE[side]} | look
    end, way = (1 if potential.face > 0 else 0), 1.0
    for energy in level_energies(potential, energies, _OF_SIDES):
        for piece in potential.components(float(energy)):
            if potential.face * piece.y[end] > 1.0:
                way = _on_both_planes(tilt, race, potential, piece, style)
    race.text(
        0.5 + 0.46 * way,
        0.97,
        rf"$\eta {'>' if side > 0 else '<'} 0$",
        ha="right" if way > 0.0 else "left",
        va="top",
        color=SIGN_COLOURS[side],
        fontsize=TEXT,
        transform=race.transAxes,
    )
    return Line2D([], [], **(style | {"label": name}))


def _on_both_planes(
    tilt: Axes, race: Axes, potential: Potential, piece: Component, style: dict[str, Any]
) -> float:
    """One level: phidot against phi and against rho, with the way of the motion; returns the sign of the race."""
    phi, speed = potential.curve(piece)
    rho = potential.rho(phi)
    # There and back: phi grows while phidot > 0
    phi, rho, rate = (
        np.concatenate([there, back[::-1]]) for there, back in ((phi, phi), (rho, rho), (speed, -speed))
    )
    tilt.plot(phi, rate, **style)
    race.plot(rho, rate, **style)
    flattest = len(phi) // 2 - 1 if potential.face > 0 else len(phi) - 1
    arrow(race, np.stack([rho, rate], axis=1), flattest, SIGN_COLOURS[1 if potential.eta > 0.0 else -1])
    return float(np.sign(rho[flattest]))
