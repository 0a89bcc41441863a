"""Picture of the disk that rocks near flat: from the Euler disk to the race."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from explorer.plot.captions import Question, captioned
from explorer.plot.style import DARK, SERIES, SMALL, axes_or_new, dress, legend_below, styled
from explorer.portrait.rocking import Rocking


@captioned(
    Question.HOW_FAR,
    "The turn of the contact point per bounce, from one flattest moment to the next, against the energy of "
    "rocking. It goes over from that of the Euler disk, which barely rocks, to the race κπ, where the disk nearly "
    "falls.",
)
def rocking_turns(bodies: Sequence[Rocking], ax: Axes | None = None, **look: Any) -> Axes:
    r"""Draw the turn of the contact point per bounce against energy, for one body or several.

    Parameters
    ----------
    bodies : sequence of Rocking
        From `explorer.portrait.rocking`, one for each disk.
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib for the lines of the bodies.

    Returns
    -------
    Axes
        Energy above the least one, E_0 = V_0 + 3/2 m g r theta_0, in units of E_0 - V_0, and the turn in
        half turns (pi rad). Dotted lines are the Euler disk, dashed ones the race, kappa pi.

    Raises
    ------
    InputError
        Where `bodies` is empty.

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> from explorer.portrait import rocking
    >>> ax = plot.rocking_turns([rocking(Disk.uniform(), [1.1, 10.0, 100.0])])
    >>> ax.lines[0].get_label()
    'uniform'
    """
    ax = axes_or_new(ax)
    for number, body in enumerate(bodies):
        colour, disk = SERIES[number % len(SERIES)], body.disk
        x = body.excess - 1.0
        shown = x > 0.0
        style = styled(look, color=colour, lw=2, label=disk.name, zorder=3)
        ax.semilogx(x[shown], abs(body.chi[shown]) / np.pi, **style)
        ends = x[shown][[0, -1]]
        ax.plot(ends, [body.slowest / np.pi] * 2, color=colour, lw=1, ls=":")
        ax.plot(ends, [disk.kappa] * 2, color=colour, lw=1, ls="--")
    ax.text(0.04, 0.68, "barely rocks", va="center", fontsize=SMALL, transform=ax.transAxes)
    ax.text(0.96, 0.68, "stands up", va="center", ha="right", fontsize=SMALL, transform=ax.transAxes)
    ax.plot([], [], color=DARK, lw=1, ls=":", label=r"Euler disk, $2\pi\sqrt{M/(3I_1)}$")
    ax.plot([], [], color=DARK, lw=1, ls="--", label=r"race, $\kappa\pi$")
    legend_below(ax, ncols=4)
    return dress(
        ax,
        r"$(E-E_0)\,/\,(E_0 - V_0)$,   $E_0$ least energy off $F$",
        "turn per bounce (π rad)",
        "From the Euler disk to the race: one turn per bounce, by energy",
    )
