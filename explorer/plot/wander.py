"""Pictures of where the disk goes: rosettes, and the resonances that walk away."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from explorer.phase.states import Array
from explorer.plot.style import DARK, DISK_COLOURS, MINUS, PLUS, SIZE, axes_or_new, dress, legend

if TYPE_CHECKING:
    from explorer.portrait.wander import Wander, WanderPath

_BOUNDED = 1e6  # radii; larger circles are drawn as none


def wander_path(found: "WanderPath", ax: Axes | None = None) -> Axes:
    """Paths of the contact point and the centre seen from above, with the centre after each period."""
    ax = axes_or_new(ax)
    r, wander = found.disk.r, found.wander
    ax.plot(*(found.contact / r).T, color=PLUS, lw=0.7, alpha=0.75, label="contact point")
    ax.plot(*(found.centre / r).T, color=MINUS, lw=0.9, label="centre")
    places = wander.after(found.count)[0] / r
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


def rosette_and_resonance(generic: "WanderPath", resonant: "WanderPath") -> Figure:
    """A generic rosette beside a motion whose chi(tau) is a whole number of turns."""
    figure = Figure(figsize=(1.25 * SIZE[0], SIZE[1]), layout="constrained")
    for found, ax in zip((generic, resonant), figure.subplots(1, 2), strict=True):
        wander_path(found, ax)
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return figure


def wander_distance(named: Mapping[str, "WanderPath"], ax: Axes | None = None) -> Axes:
    """Distance of the centre from its start against periods, with the bound that one period tells."""
    ax = axes_or_new(ax)
    largest = 1.0
    for number, (name, found) in enumerate(named.items()):
        colour, wander, r = DISK_COLOURS[number % len(DISK_COLOURS)], found.wander, found.disk.r
        distance = np.hypot(*found.centre.T) / r
        largest = max(largest, float(distance.max()))
        ax.plot(found.t / wander.period[0], distance, color=colour, lw=0.9, label=name)
        periods = np.arange(found.count + 1)
        ax.plot(periods, abs(wander.after(found.count)[0]) / r, ".", color=colour, ms=6)
        if 2.0 * wander.radius[0] / r < _BOUNDED:
            ax.axhline(2.0 * wander.radius[0] / r, color=colour, lw=1, ls=":")
    ax.plot([], [], ".", color=DARK, label="after each period, from one period alone")
    ax.plot([], [], color=DARK, lw=1, ls=":", label="bound of these dots")
    ax.set_ylim(0.0, 1.05 * largest)
    legend(ax, loc="upper center", bbox_to_anchor=(0.5, -0.17), ncols=2)
    return dress(ax, "t (periods)", "distance from the start (radii)", "Only a resonance walks away")


def wander_radius(
    sigma3_bar: Array,
    found: "Wander",
    r: float = 1.0,
    resonances: Mapping[int, float] | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Radius of the rosette against sigma3_bar, r the disk's radius; resonances: turns to sigma3_bar."""
    ax = axes_or_new(ax)
    ax.semilogy(
        sigma3_bar, found.radius / r, color=PLUS, lw=1.8, label=r"$|a(\tau)-a(0)|\,/\,2|\sin(\chi(\tau)/2)|$"
    )
    ax.semilogy(
        sigma3_bar, abs(found.step) / r, color=MINUS, lw=1.4, ls="--", label=r"$|a(\tau)-a(0)|$, one period"
    )
    for turns, where in (resonances or {}).items():
        ax.axvline(where, color=DARK, lw=1, ls=":", label=rf"resonance: $\chi(\tau) = {turns}\cdot 2\pi$")
    legend(ax, loc="best")
    ax.grid(alpha=0.3)
    return dress(
        ax, r"$\bar\sigma_3$ (rad per unit of time)", "radii", "The rosette grows without bound at a resonance"
    )
