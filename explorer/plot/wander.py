"""Pictures of where the disk goes: rosettes, and the resonances that walk away."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from explorer.errors import InputError
from explorer.phase.disk import Disk
from explorer.phase.states import Array
from explorer.plot.captions import Question, captioned
from explorer.plot.style import (
    DARK,
    SERIES,
    SIZE,
    SMALL,
    axes_or_new,
    coordinate_label,
    dress,
    legend_below,
    styled,
)
from explorer.portrait.wander import Wander, WanderPath

_UNBOUNDED = "The rosette has no bound where a period is whole turns"
_BOUNDED = 1e6  # radii; a larger circle is straight in any picture, so none is drawn


@captioned(
    Question.WHERE_TO,
    "The paths of the contact point and of the centre of the disk over many periods, seen from above. Dots "
    "are the centre after each period; they lie on a circle, unless a resonance carries the disk away.",
)
def wander_path(path: WanderPath, ax: Axes | None = None, **look: Any) -> Axes:
    """Draw the paths of the contact point and of the centre seen from above.

    Parameters
    ----------
    path : WanderPath
        From `explorer.portrait.wander_path`.
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib for the lines.

    Returns
    -------
    Axes
        Both axes in radii of the disk. Dots are the centre after each period, as one period tells it; the
        dotted circle is the one on which they lie.

    Examples
    --------
    >>> from explorer import Disk, constants_to_states, plot
    >>> from explorer.portrait import wander_path
    >>> disk = Disk.uniform()
    >>> ax = plot.wander_path(wander_path(constants_to_states(disk, 0.7, 0.05, 1.0), 2))
    >>> [line.get_label() for line in ax.lines][:2]
    ['contact point', 'centre of the disk']
    """
    ax = axes_or_new(ax)
    r, wander = path.disk.r, path.wander
    ax.plot(*(path.contact / r).T, **styled(look, color="#A9A9A9", lw=0.6, label="contact point"))
    ax.plot(*(path.centre / r).T, **styled(look, color=SERIES[1], lw=1.1, label="centre of the disk"))
    places = wander.after(path.count)[0] / r
    ax.plot(places.real, places.imag, "o", color=DARK, ms=3.5, label="centre, once a period")
    turns, radius = wander.chi[0] / (2.0 * np.pi), wander.radius[0] / r
    if radius < _BOUNDED:
        middle = wander.step[0] / r / (1.0 - np.exp(1j * wander.chi[0]))
        circle = middle - middle * np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 181))
        ax.plot(circle.real, circle.imag, color=DARK, lw=0.8, ls=":")
        title = f"it stays: circle of {radius:.2f} r"
    else:
        title = f"it walks: {abs(wander.step[0]) / r:.2f} r a period"
    ax.set_aspect("equal", adjustable="datalim")
    return dress(ax, "x (r)", "y (r)", f"{turns:.4g} turns of $\\chi$ a period:\n{title}")


def rosette_and_resonance(generic: WanderPath, resonant: WanderPath) -> Figure:
    """Draw a generic rosette beside a motion whose chi(tau) is a whole number of turns.

    Parameters
    ----------
    generic, resonant : WanderPath
        From `explorer.portrait.wander_path`.

    Returns
    -------
    Figure
        Two panels as of `wander_path`, at one scale and with one legend.

    Examples
    --------
    >>> from explorer import Disk, constants_to_states, plot
    >>> from explorer.portrait import wander_path
    >>> path = wander_path(constants_to_states(Disk.uniform(), 0.7, 0.05, 1.0), 2)
    >>> len(plot.rosette_and_resonance(path, path).axes)
    2
    """
    figure = Figure(figsize=(1.25 * SIZE[0], 0.98 * SIZE[1]), layout="constrained")
    panels = figure.subplots(1, 2)
    spans, middles = [], []
    for path, ax in zip((generic, resonant), panels, strict=True):
        wander_path(path, ax)
        ends = np.stack([path.contact.min(axis=0), path.contact.max(axis=0)]) / path.disk.r
        spans.append(np.ptp(ends, axis=0).max())
        middles.append(ends.mean(axis=0))
    half = 0.54 * max(spans)  # one scale for both, with a margin
    for ax, (x, y) in zip(panels, middles, strict=True):
        ax.set(xlim=(x - half, x + half), ylim=(y - half, y + half))
        ax.set_aspect("equal", adjustable="box")
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return figure


@captioned(
    Question.WHERE_TO,
    "The distance of the centre from its start, against time in periods. A generic motion stays within a "
    "bound; a resonance walks away for ever.",
)
def wander_distance(named: Mapping[str, WanderPath], ax: Axes | None = None, **look: Any) -> Axes:
    """Draw the distance of the centre from its start against time, with the bound that one period tells.

    Parameters
    ----------
    named : mapping of str to WanderPath
        Motions from `explorer.portrait.wander_path`, by what the legend calls them.
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib for the lines.

    Returns
    -------
    Axes
        Time in periods of each motion, distance in radii of its disk.

    Examples
    --------
    >>> from explorer import Disk, constants_to_states, plot
    >>> from explorer.portrait import wander_path
    >>> path = wander_path(constants_to_states(Disk.uniform(), 0.7, 0.05, 1.0), 2)
    >>> plot.wander_distance({"generic": path}).lines[0].get_label()
    'generic'
    """
    ax = axes_or_new(ax)
    largest = 1.0
    for number, (name, path) in enumerate(named.items()):
        colour, wander, r = SERIES[1 + number % (len(SERIES) - 1)], path.wander, path.disk.r
        distance = np.hypot(*path.centre.T) / r
        largest = max(largest, float(distance.max()))
        ax.plot(path.t / wander.period[0], distance, **styled(look, color=colour, lw=0.9, label=name))
        periods = np.arange(path.count + 1)
        ax.plot(periods, abs(wander.after(path.count)[0]) / r, ".", color=colour, ms=6)
        if 2.0 * wander.radius[0] / r < _BOUNDED:
            ax.axhline(2.0 * wander.radius[0] / r, color=colour, lw=1, ls=":")
    ax.plot([], [], ".", color=DARK, label="at whole periods, foretold from one")
    ax.plot([], [], color=DARK, lw=1, ls=":", label="these dots stay below")
    ax.set_ylim(0.0, 1.05 * largest)
    legend_below(ax, ncols=2)
    return dress(ax, "t (periods)", "distance from the start (r)", "Only a resonance walks away")


@captioned(
    Question.WHERE_TO,
    "Above, by how much χ turns in one period, against σ̄₃; below, the radius of the rosette. Where a period is a "
    "whole number of turns the radius has no bound, and the curve leaves the picture: there the disk walks away.",
)
def wander_radius(
    disk: Disk,
    sigma3_bar: Array,
    wander: Wander,
    resonances: Mapping[int, float] | None = None,
    ax: Axes | None = None,
    **look: Any,
) -> Axes:
    """Draw the radius of the rosette against sigma3_bar, and above it the turn of chi in one period.

    Parameters
    ----------
    disk : Disk
    sigma3_bar : array (n)
        Of the motions, units of the disk, increasing.
    wander : Wander
        From `explorer.portrait.wander`, of the same motions.
    resonances : mapping of int to float, optional
        sigma3_bar at which chi(tau) is that many whole turns, drawn as vertical lines.
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib for the curve of the radius.

    Returns
    -------
    Axes
        The radius in radii of the disk; the turn is an inset above it.

    Raises
    ------
    InputError
        Where sigma3_bar does not increase or belongs to other motions, and where no period is known.

    Examples
    --------
    >>> import numpy as np
    >>> from explorer import Disk, constants_to_states, plot
    >>> from explorer.portrait import wander
    >>> disk, bars = Disk.uniform(), np.array([0.6, 0.7])
    >>> ax = plot.wander_radius(disk, bars, wander(constants_to_states(disk, bars, 0.05, 1.0)))
    >>> ax.get_ylabel()
    'radius of the rosette (r)'
    """
    bars, turns, step = _known(sigma3_bar, wander)
    ax = axes_or_new(ax)
    # Between the motions given chi(tau) and the step are smooth, and the radius is not: 2 |sin(chi/2)| r = step.
    fine = np.linspace(bars[0], bars[-1], max(40 * bars.size, 2)) if bars.size > 1 else bars
    between = np.interp(fine, bars, turns)
    with np.errstate(divide="ignore"):
        radius = np.interp(fine, bars, step / disk.r) / (2.0 * abs(np.sin(np.pi * between)))
    ax.plot(fine, radius, **styled(look, color=SERIES[1], lw=1.8))
    top = 6.0 * float(np.median(radius[np.isfinite(radius)])) if np.isfinite(radius).any() else 1.0
    ax.set_ylim(0.0, 1.9 * top)
    ax.set_yticks([tick for tick in ax.get_yticks() if tick <= top])
    _turns_above(ax, fine, between, resonances or {})
    dress(ax, coordinate_label("sigma3_bar", disk), "radius of the rosette (r)", _UNBOUNDED)
    ax.yaxis.set_label_coords(-0.075, 0.29)  # beside its own part of the axis; a new label would be in the middle
    return ax


def _known(sigma3_bar: Array, wander: Wander) -> tuple[Array, Array, Array]:
    """sigma3_bar, turns and steps of the motions whose period is known. Raises InputError where there is none."""
    bars = np.ravel(sigma3_bar)
    if bars.size != wander.chi.size:
        raise InputError(f"sigma3_bar has {bars.size} entries, wander {wander.chi.size}; they belong together")
    good = np.isfinite(bars) & np.isfinite(wander.chi) & np.isfinite(wander.step)
    if not good.any():
        raise InputError("wander: of no motion the period is known; look at its status")
    if not (np.diff(bars[good]) > 0.0).all():
        raise InputError("sigma3_bar does not increase; sort the motions by it")
    return bars[good], wander.chi[good] / (2.0 * np.pi), np.abs(wander.step[good])


def _turns_above(ax: Axes, bars: Array, turns: Array, resonances: Mapping[int, float]) -> None:
    """Draw the turn of chi in one period above the radius, and the resonances in both."""
    above = ax.inset_axes((0.0, 0.62, 1.0, 0.38), sharex=ax)
    above.plot(bars, turns, color=DARK, lw=1.6)
    above.set_ylabel("turns of $\\chi$\na period", fontsize=SMALL)
    above.yaxis.set_label_coords(-0.075, 0.5)
    above.tick_params(labelsize=SMALL, labelbottom=False)
    for whole, where in resonances.items():
        above.axhline(whole, color=DARK, lw=0.8, ls=":")
        for each in (ax, above):
            each.axvline(where, color=DARK, lw=0.8, ls=":")
        words = f"resonance: {whole} turn{'' if abs(whole) == 1 else 's'} a period"
        edge: dict[str, Any] = {"xycoords": above.get_yaxis_transform(), "textcoords": "offset points"}
        above.annotate(words, (0.99, whole), xytext=(0, -4), ha="right", va="top", fontsize=SMALL, **edge)
