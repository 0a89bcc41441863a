"""Picture of the disk that rocks near flat: from the Euler disk to the race."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from explorer.errors import InputError
from explorer.plot.captions import Question, captioned
from explorer.plot.style import DARK, DISK_COLOURS, axes_or_new, dress, legend
from explorer.portrait.rocking import Rocking


@captioned(
    Question.HOW_FAR,
    "The turn of the contact point per bounce against the energy of rocking, at small η. It goes over from "
    "that of the Euler disk, which barely rocks, to the race κπ, where the disk nearly falls.",
)
def rocking_turns(bodies: Sequence[Rocking], ax: Axes | None = None) -> Axes:
    r"""Draw the turn of the contact point per bounce against energy, for one body or several.

    Parameters
    ----------
    bodies : sequence of Rocking
        From `explorer.portrait.rocking.rocking`, one for each disk.
    ax : Axes, optional
        Where to draw; by default on a new figure.

    Returns
    -------
    Axes
        Energy above V_0 in units of 3/2 m g r theta_0, and the turn in half turns (pi rad). Dotted lines are the
        Euler disk, dashed ones the race, kappa pi.

    Raises
    ------
    InputError
        Where `bodies` is empty.

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> from explorer.portrait.rocking import rocking
    >>> ax = plot.rocking_turns([rocking(Disk.uniform(), [1.1, 10.0, 100.0])])
    >>> ax.lines[0].get_label()
    'uniform'
    """
    if not bodies:
        raise InputError("bodies: none were given; make one for each disk with rocking(disk)")
    ax = axes_or_new(ax)
    for number, body in enumerate(bodies):
        colour, disk = DISK_COLOURS[number % len(DISK_COLOURS)], body.disk
        ax.semilogx(body.excess, abs(body.chi) / np.pi, color=colour, lw=2, label=disk.name, zorder=3)
        ax.plot(body.excess[[0, -1]], [body.slowest / np.pi] * 2, color=colour, lw=1, ls=":")
        ax.plot(body.excess[[0, -1]], [disk.kappa] * 2, color=colour, lw=1, ls="--")
    ax.plot([], [], color=DARK, lw=1, ls=":", label=r"$2\pi\sqrt{M/3I_1}$: Euler disk")
    ax.plot([], [], color=DARK, lw=1, ls="--", label=r"$\kappa\pi$: the race")
    legend(ax, loc="upper center", bbox_to_anchor=(0.5, -0.17), ncols=3)
    return dress(
        ax,
        r"$(E-V_0)\,/\,\frac{3}{2} m g r \theta_0$,   $\theta_0 = (\eta^2/I_1 m g r)^{1/3}$",
        r"turn per bounce ($\pi$ rad)",
        r"Small $\eta$: the turn per bounce depends on energy",
    )
