"""Pictures of where the disk goes: rosettes, and the resonances that walk away."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from explorer.phase.disk import Disk
from explorer.phase.states import Array
from explorer.plot.captions import Question, captioned
from explorer.plot.style import DARK, DISK_COLOURS, MINUS, PLUS, SIZE, axes_or_new, dress, legend, rates_of
from explorer.portrait.wander import Wander, WanderPath

_BOUNDED = 1e6  # radii; a larger circle is straight in any picture, so none is drawn


@captioned(
    Question.WHERE_TO,
    "The paths of the contact point and of the centre of the disk over many periods, seen from above. Dots "
    "are the centre after each period; they lie on a circle, unless a resonance carries the disk away.",
)
def wander_path(path: WanderPath, ax: Axes | None = None) -> Axes:
    """Draw the paths of the contact point and of the centre seen from above.

    Parameters
    ----------
    path : WanderPath
        From `explorer.portrait.wander.wander_path`.
    ax : Axes, optional
        Where to draw; by default on a new figure.

    Returns
    -------
    Axes
        Both axes in radii of the disk. Dots are the centre after each period, as one period tells it; the
        dotted circle is the one on which they lie.

    Examples
    --------
    >>> from explorer import Disk, constants_to_states, plot
    >>> from explorer.portrait.wander import wander_path
    >>> disk = Disk.uniform()
    >>> ax = plot.wander_path(wander_path(constants_to_states(disk, 0.7, 0.05, 1.0), 2))
    >>> [line.get_label() for line in ax.lines][:2]
    ['contact point', 'centre']
    """
    ax = axes_or_new(ax)
    r, wander = path.disk.r, path.wander
    ax.plot(*(path.contact / r).T, color=PLUS, lw=0.7, alpha=0.75, label="contact point")
    ax.plot(*(path.centre / r).T, color=MINUS, lw=0.9, label="centre")
    places = wander.after(path.count)[0] / r
    ax.plot(places.real, places.imag, "o", color=DARK, ms=3.5, label="centre after each period")
    turns, radius = wander.chi[0] / (2.0 * np.pi), wander.radius[0] / r
    if radius < _BOUNDED:
        middle = wander.step[0] / r / (1.0 - np.exp(1j * wander.chi[0]))
        circle = middle - middle * np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 181))
        ax.plot(circle.real, circle.imag, color=DARK, lw=0.8, ls=":")
        title = f"bounded: radius {radius:.2f} r"
    else:
        title = f"unbounded: {abs(wander.step[0]) / r:.2f} r per period"
    ax.set_aspect("equal", adjustable="datalim")
    return dress(ax, "x (radii)", "y (radii)", f"$\\chi(\\tau)$ = {turns:.4f} turns\n{title}")


def rosette_and_resonance(generic: WanderPath, resonant: WanderPath) -> Figure:
    """Draw a generic rosette beside a motion whose chi(tau) is a whole number of turns.

    Parameters
    ----------
    generic, resonant : WanderPath
        From `explorer.portrait.wander.wander_path`.

    Returns
    -------
    Figure
        Two panels as of `wander_path`, with one legend.

    Examples
    --------
    >>> from explorer import Disk, constants_to_states, plot
    >>> from explorer.portrait.wander import wander_path
    >>> path = wander_path(constants_to_states(Disk.uniform(), 0.7, 0.05, 1.0), 2)
    >>> len(plot.rosette_and_resonance(path, path).axes)
    2
    """
    figure = Figure(figsize=(1.25 * SIZE[0], SIZE[1]), layout="constrained")
    for path, ax in zip((generic, resonant), figure.subplots(1, 2), strict=True):
        wander_path(path, ax)
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return figure


@captioned(
    Question.WHERE_TO,
    "The distance of the centre from its start, against time in periods. A generic motion stays within a "
    "bound; a resonance walks away for ever.",
)
def wander_distance(named: Mapping[str, WanderPath], ax: Axes | None = None) -> Axes:
    """Draw the distance of the centre from its start against time, with the bound that one period tells.

    Parameters
    ----------
    named : mapping of str to WanderPath
        Motions and what the legend calls them.
    ax : Axes, optional
        Where to draw; by default on a new figure.

    Returns
    -------
    Axes
        Time in periods of each motion, distance in radii of its disk.

    Examples
    --------
    >>> from explorer import Disk, constants_to_states, plot
    >>> from explorer.portrait.wander import wander_path
    >>> path = wander_path(constants_to_states(Disk.uniform(), 0.7, 0.05, 1.0), 2)
    >>> plot.wander_distance({"generic": path}).lines[0].get_label()
    'generic'
    """
    ax = axes_or_new(ax)
    largest = 1.0
    for number, (name, path) in enumerate(named.items()):
        colour, wander, r = DISK_COLOURS[number % len(DISK_COLOURS)], path.wander, path.disk.r
        distance = np.hypot(*path.centre.T) / r
        largest = max(largest, float(distance.max()))
        ax.plot(path.t / wander.period[0], distance, color=colour, lw=0.9, label=name)
        periods = np.arange(path.count + 1)
        ax.plot(periods, abs(wander.after(path.count)[0]) / r, ".", color=colour, ms=6)
        if 2.0 * wander.radius[0] / r < _BOUNDED:
            ax.axhline(2.0 * wander.radius[0] / r, color=colour, lw=1, ls=":")
    ax.plot([], [], ".", color=DARK, label="after each period, from one period alone")
    ax.plot([], [], color=DARK, lw=1, ls=":", label="bound of these dots")
    ax.set_ylim(0.0, 1.05 * largest)
    legend(ax, loc="upper center", bbox_to_anchor=(0.5, -0.17), ncols=2)
    return dress(ax, "t (periods)", "distance from the start (radii)", "Only a resonance walks away")


@captioned(
    Question.WHERE_TO,
    "The angle of one period, in turns, and the radius of the rosette against σ̄₃. Where the angle is a whole "
    "number of turns the radius has no bound.",
)
def wander_radius(
    disk: Disk,
    sigma3_bar: Array,
    wander: Wander,
    resonances: Mapping[int, float] | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw the radius of the rosette and the step of one period against sigma3_bar.

    Parameters
    ----------
    disk : Disk
    sigma3_bar : array (n)
        Of the motions, units of the disk.
    wander : Wander
        From `explorer.portrait.wander.wander`, of the same motions.
    resonances : mapping of int to float, optional
        sigma3_bar at which chi(tau) is that many whole turns, drawn as vertical lines.
    ax : Axes, optional
        Where to draw; by default on a new figure.

    Returns
    -------
    Axes
        Both lengths in radii of the disk, on a logarithmic axis.

    Examples
    --------
    >>> import numpy as np
    >>> from explorer import Disk, constants_to_states, plot
    >>> from explorer.portrait.wander import wander
    >>> disk, bars = Disk.uniform(), np.array([0.6, 0.7])
    >>> ax = plot.wander_radius(disk, bars, wander(constants_to_states(disk, bars, 0.05, 1.0)))
    >>> ax.get_ylabel()
    'radii'
    """
    ax = axes_or_new(ax)
    radius, step = wander.radius / disk.r, abs(wander.step) / disk.r
    ax.semilogy(sigma3_bar, radius, color=PLUS, lw=1.8, label=r"$|a(\tau)-a(0)|\,/\,2|\sin(\chi(\tau)/2)|$")
    ax.semilogy(sigma3_bar, step, color=MINUS, lw=1.4, ls="--", label=r"$|a(\tau)-a(0)|$, one period")
    for turns, where in (resonances or {}).items():
        ax.axvline(where, color=DARK, lw=1, ls=":", label=rf"resonance: $\chi(\tau) = {turns}\cdot 2\pi$")
    legend(ax, loc="best")
    ax.grid(alpha=0.3)
    title = "The rosette grows without bound at a resonance"
    return dress(ax, rf"$\bar\sigma_3$ ({rates_of(disk)})", "radii", title)
