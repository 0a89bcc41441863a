"""Pictures over all bodies: race number, gap of the two limit motions, turn per bounce."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from explorer.errors import InputError
from explorer.phase.states import Array
from explorer.plot.style import DARK, DISK_COLOURS, MINUS, PLUS, SMALL, THIRD, axes_or_new, dress, legend, stacked

if TYPE_CHECKING:
    from explorer.portrait.bodies import MeasuredGaps, RaceNumbers
    from explorer.portrait.bounce import Bounces

NAMED = {2.0: "hoop", 4.0: "uniform"}
_RATIO = r"$m r^2/I_1$"


def race_number(
    numbers: "RaceNumbers",
    measured: "MeasuredGaps | None" = None,
    ax: Axes | None = None,
) -> Axes:
    """kappa against m r^2/I1: the contact point races by kappa pi. measured: race angles by quadrature."""
    ax = axes_or_new(ax)
    ax.plot(numbers.ratio, numbers.kappa, color=PLUS, lw=1.8, label=r"$\kappa = \sqrt{1 + m r^2/I_1}$")
    _matching(ax, numbers, np.sqrt(1.0 + numbers.matching))
    if measured is not None:
        _measured(ax, measured.ratio, measured.kappa)
    _named(ax, numbers, np.sqrt)
    ax.set_ylim(0.8, 1.08 * numbers.kappa[-1])
    ax.grid(alpha=0.3)
    legend(ax, loc="lower right")
    return dress(ax, _RATIO, r"race number $\kappa$ (half turns)", r"The contact point races by $\pm\kappa\pi$")


def race_gap(
    numbers: "RaceNumbers",
    measured: "MeasuredGaps | None" = None,
    ax: Axes | None = None,
) -> Axes:
    """2 kappa pi mod 2 pi against m r^2/I1, zero for the matching bodies; it jumps by a whole turn there."""
    ax = axes_or_new(ax)
    falls = np.flatnonzero(np.diff(numbers.gap) < 0.0) + 1
    x, y = np.insert(numbers.ratio, falls, np.nan), np.insert(numbers.gap, falls, np.nan)
    ax.plot(x, y, color=PLUS, lw=1.8, label=r"$2\kappa\pi$ mod $2\pi$")
    _matching(ax, numbers, 0.0 * numbers.matching)
    if measured is not None:
        _measured(ax, measured.ratio, measured.gap)
    _named(ax, numbers, lambda square: 2.0 * np.pi * (np.sqrt(square) % 1.0))
    ax.set_ylim(-0.35, 2.0 * np.pi + 0.2)
    ax.set_yticks([0.0, np.pi, 2.0 * np.pi], ["0", r"$\pi$", r"$2\pi$"])
    ax.grid(alpha=0.3)
    legend(ax, loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=2)
    return dress(ax, _RATIO, "gap (rad)", "How far the two limit motions differ after a fall")


def race_bodies(numbers: "RaceNumbers", measured: "MeasuredGaps | None" = None) -> Figure:
    """Race number and gap above each other."""
    return stacked(
        lambda ax: race_number(numbers, measured, ax),
        lambda ax: race_gap(numbers, measured, ax),
        height=7.2,
    )


def _matching(ax: Axes, numbers: "RaceNumbers", at: Array) -> None:
    ax.plot(numbers.matching, at, "D", color=MINUS, ms=7, label=r"$m r^2/I_1 = l^2 - 1$: both limits agree")


def _measured(ax: Axes, ratio: Array, value: Array) -> None:
    ax.plot(ratio, value, "o", mfc="none", mec=DARK, ms=12, label="measured beside $F$")


def _named(ax: Axes, numbers: "RaceNumbers", height: Callable[[float], float]) -> None:
    for ratio, name in NAMED.items():
        if ratio <= numbers.ratio[-1]:
            at = ratio, height(1.0 + ratio)
            ax.plot(*[[value] for value in at], "s", color=THIRD, ms=6)
            ax.annotate(name, at, xytext=(-7, 9), textcoords="offset points", ha="right", fontsize=SMALL)


def bounce_turns(found: Sequence["Bounces"], ax: Axes | None = None) -> Axes:
    """Turn of the contact point per bounce against energy: from the Euler disk to the race."""
    if not found:
        raise InputError("found: no bounces were given; make them with turn_per_bounce")
    ax = axes_or_new(ax)
    for number, bounces in enumerate(found):
        colour, disk = DISK_COLOURS[number % len(DISK_COLOURS)], bounces.disk
        ax.semilogx(bounces.level, abs(bounces.chi) / np.pi, color=colour, lw=2, label=disk.name, zorder=3)
        ax.plot(bounces.level[[0, -1]], [bounces.slowest / np.pi] * 2, color=colour, lw=1, ls=":")
        ax.plot(bounces.level[[0, -1]], [disk.kappa] * 2, color=colour, lw=1, ls="--")
    ax.plot([], [], color=DARK, lw=1, ls=":", label=r"$2\pi\sqrt{M/3I_1}$: Euler disk")
    ax.plot([], [], color=DARK, lw=1, ls="--", label=r"$\kappa\pi$: the race")
    legend(ax, loc="upper center", bbox_to_anchor=(0.5, -0.17), ncols=3)
    return dress(
        ax,
        r"$(E-V_0)\,/\,\frac{3}{2} m g r \theta_0$,   $\theta_0 = (\eta^2/I_1 m g r)^{1/3}$",
        r"turn per bounce ($\pi$ rad)",
        r"Small $\eta$: the turn per bounce depends on energy",
    )
