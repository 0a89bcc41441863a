"""Where the disk goes over many periods: rosettes, and the resonances that walk away."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from explorer.errors import InputError
from explorer.motion.periods import periods
from explorer.motion.wander import WanderPath, resonance, wander, wander_path
from explorer.phase.coordinates import constants_to_states
from explorer.phase.disk import Disk
from explorer.phase.states import Array, States
from explorer.pictures.register import Question, picture
from explorer.pictures.style import DARK, SERIES, SIZE, SMALL, coordinate_label, dress, legend_below, legend_of_all

_BOUNDED = 1e6  # radii; a larger circle is straight in any picture, so none is drawn


@picture(
    Question.WHERE_TO,
    "The path of the contact point and of the centre of the disk over some periods, seen from above. Dots "
    "are the centre after each period; they lie on the dotted circle, unless a resonance carries the disk away.",
)
def rosette(ax: Axes, path: WanderPath) -> None:
    """Draw a path of `explorer.wander_path`, the predicted centre after each period, and the circle of centres."""
    _path(ax, path)
    ax.set_aspect("equal", adjustable="datalim")
    legend_below(ax, ncols=3)


def _path(ax: Axes, path: WanderPath) -> None:
    r, found = path.disk.r, path.wander
    ax.plot(*(path.contact / r).T, color="#A9A9A9", lw=0.6, label="contact point")
    ax.plot(*(path.centre / r).T, color=SERIES[1], lw=1.1, label="centre of the disk")
    places = found.after(path.count) / r
    ax.plot(places.real, places.imag, "o", color=DARK, ms=3.5, label="centre, once a period")
    turns, radius = found.chi / (2.0 * np.pi), found.radius / r
    title = f"it walks: {abs(found.step) / r:.2f} r a period"
    if radius < _BOUNDED:
        middle = found.step / r / (1.0 - np.exp(1j * found.chi))
        circle = middle - middle * np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 181))
        ax.plot(circle.real, circle.imag, color=DARK, lw=0.8, ls=":")
        title = f"it stays: circle of {radius:.2f} r"
    dress(ax, "$x$ ($r$)", "$y$ ($r$)", f"{turns:.4g} turns of $\\chi$ a period:\n{title}")


class Walk(NamedTuple):
    """A resonance of a disk, and the motions at its side, units of the disk.

    sigma3_bar, eta_hat, phidot: of the motions among which it was sought. turns: of chi in one period, at `bar`.
    """

    sigma3_bar: Array
    eta_hat: float
    phidot: float
    turns: int
    bar: float
    start: States

    def generic(self, count: int) -> WanderPath:
        """The path of another motion, which stays."""
        disk = self.start.disk
        return wander_path(constants_to_states(disk, 0.7 * disk.rate_unit, self.eta_hat, self.phidot), count)


@lru_cache(maxsize=4)
def walk_of(disk: Disk) -> Walk:
    """The first resonance, chi(tau) a whole number of turns, among motions of several speeds and many sigma3_bar.

    Raises InputError where none is met. It takes seconds, so it is kept.
    """
    unit, bars = disk.rate_unit, np.linspace(0.1, 1.4, 53) * disk.rate_unit
    for eta_hat, phidot in ((sign * 0.01 * unit, v * unit) for v in (1.0, 0.5, 2.0, 0.25) for sign in (1.0, -1.0)):
        turns = periods(constants_to_states(disk, bars, eta_hat, phidot)).chi / (2.0 * np.pi)
        met = np.flatnonzero(abs(np.floor(turns[1:]) - np.floor(turns[:-1])) > 0.0)
        if met.size:
            i = int(met[0])
            whole = int(max(np.floor(turns[i]), np.floor(turns[i + 1])))
            bar, start = resonance(disk, eta_hat, phidot, whole, (bars[i], bars[i + 1]))
            return Walk(bars, eta_hat, phidot, whole, bar, start)
    raise InputError(f"disk {disk.name}: no resonance chi(tau) = 2 pi n was found; choose another disk")


@picture(
    Question.WHERE_TO,
    "The paths of the contact point and of the centre of the disk over many periods, seen from above. Dots "
    "are the centre after each period; they lie on a circle, unless a resonance carries the disk away.",
    (SIZE[0], 4.2),
    "paths",
)
def wander_paths(figure: Figure, disk: Disk) -> None:
    """Draw a generic rosette beside a motion whose chi(tau) is a whole number of turns, at one scale."""
    walk = walk_of(disk)
    # The walk goes on for ever: as much of it as a rosette takes room
    paths = walk.generic(12), wander_path(walk.start, 4)
    panels = figure.subplots(1, 2)
    half = 0.54 * max(np.ptp(path.contact / disk.r, axis=0).max() for path in paths)  # with a margin
    for path, ax in zip(paths, panels, strict=True):
        _path(ax, path)
        x, y = 0.5 * (path.contact.min(axis=0) + path.contact.max(axis=0)) / disk.r
        ax.set(xlim=(x - half, x + half), ylim=(y - half, y + half))
        ax.set_aspect("equal", adjustable="box")
    legend_of_all(figure, panels[:1])


@picture(
    Question.WHERE_TO,
    "The distance of the centre from its start, against time in periods, with a dot at each whole period. At "
    "whole periods a generic motion stays below the dotted line, and in between it goes little further. At a "
    "resonance the disk walks away for ever.",
    group="paths",
)
def wander_distance(ax: Axes, disk: Disk, count: int = 12) -> None:
    """Draw the distance of the centre from its start against time, with the bound that follows from one period.

    Two motions are drawn: a generic one of the disk, and a resonance.
    """
    walk = walk_of(disk)
    named = {"generic": walk.generic(count), "resonant": wander_path(walk.start, count)}
    largest = 1.0
    for number, (name, path) in enumerate(named.items()):
        colour, found, r = SERIES[1 + number % (len(SERIES) - 1)], path.wander, path.disk.r
        distance = np.hypot(*path.centre.T) / r
        largest = max(largest, float(distance.max()))
        ax.plot(path.t / found.period, distance, color=colour, lw=0.9)
        ax.plot(np.arange(path.count + 1), abs(found.after(path.count)) / r, ".", color=colour, ms=6)
        ax.plot([], [], ".-", color=colour, ms=6, lw=0.9, label=f"{name}, a dot each period")
        if 2.0 * found.radius / r < _BOUNDED:
            ax.axhline(float(2.0 * found.radius / r), color=colour, lw=1.4, ls=":", label=f"bound of {name} dots")
    ax.set_ylim(0.0, 1.05 * largest)
    legend_below(ax, ncols=2)
    dress(ax, "$t$ (periods)", "distance from the start (r)", "Only a resonance walks away")


@picture(
    Question.WHERE_TO,
    "Above, by how much χ turns in one period, against σ̄₃; below, the radius of the circle on which the centre "
    "lies after each period. If the turn in a period is a whole number of turns, the radius has no bound, and "
    "the curve leaves the picture: there the disk walks away.",
    (SIZE[0], 5.6),
    "paths",
)
def wander_radius(figure: Figure, disk: Disk) -> None:
    """Draw the radius of the rosette and, above it, the turn of chi in one period against sigma3_bar."""
    walk = walk_of(disk)
    found = wander(constants_to_states(disk, walk.sigma3_bar, walk.eta_hat, walk.phidot))
    good = np.isfinite(found.chi)
    bars, turns, step = walk.sigma3_bar[good], found.chi[good] / (2.0 * np.pi), abs(found.step[good])
    # Between the motions given chi(tau) and the step are smooth, and the radius is not: 2 |sin(chi/2)| r = step.
    fine = np.linspace(bars[0], bars[-1], 40 * bars.size)
    between = np.interp(fine, bars, turns)
    with np.errstate(divide="ignore"):
        radius = np.interp(fine, bars, step / disk.r) / (2.0 * abs(np.sin(np.pi * between)))
    above, below = figure.subplots(2, 1, sharex=True)
    above.plot(fine, between, color=DARK, lw=1.8)
    above.axhline(walk.turns, color=DARK, lw=0.8, ls=":")
    words = f"resonance: {walk.turns} turn{'' if abs(walk.turns) == 1 else 's'} a period"
    above.text(fine[-1], walk.turns, words, ha="right", va="bottom", fontsize=SMALL)
    below.plot(fine, radius, color=SERIES[1], lw=1.8)
    below.set_ylim(0.0, 6.0 * float(np.median(radius[np.isfinite(radius)])))
    for ax in (above, below):
        ax.axvline(walk.bar, color=DARK, lw=0.8, ls=":")
    title = "The rosette has no bound where a period is whole turns"
    dress(above, "", r"turns of $\chi$ a period", title)
    dress(below, coordinate_label("sigma3_bar", disk), "radius of the rosette ($r$)")
