"""The disk that rocks near flat: from the Euler disk to the race."""

import numpy as np
from matplotlib.axes import Axes

from explorer.motion.rocking import rocking as rocking_of
from explorer.phase.disk import Disk
from explorer.pictures.register import Question, picture
from explorer.pictures.style import DARK, SERIES, dress, legend_below


@picture(
    Question.HOW_FAR,
    "The turn of the contact point per bounce, from one flattest moment to the next, against the energy of "
    "rocking, above E₀, the least one off F. It goes over from that of the Euler disk, which barely rocks, to the "
    "race κπ, where the disk nearly falls.",
    group="bounces",
)
def rocking(ax: Axes, disk: Disk) -> None:
    """Draw the turn per bounce against energy, of `explorer.rocking`: uniform disk, hoop and the disk."""
    bodies = {each.name: each for each in (Disk.uniform(), Disk.hoop(), disk)}
    for number, body in enumerate(bodies.values()):
        found, colour = rocking_of(body), SERIES[number % len(SERIES)]
        x = found.excess - 1.0
        shown = x > 0.0
        ax.semilogx(x[shown], abs(found.chi[shown]) / np.pi, lw=2, label=body.name, zorder=3, color=colour)
        ends = x[shown][[0, -1]]
        ax.plot(ends, [found.slowest / np.pi] * 2, lw=1, ls=":", color=colour)
        ax.plot(ends, [body.kappa] * 2, lw=1, ls="--", color=colour)
    ax.plot([], [], color=DARK, lw=1, ls=":", label=r"Euler disk, $2\pi\sqrt{M/(3I_1)}$")
    ax.plot([], [], color=DARK, lw=1, ls="--", label=r"race, $\kappa\pi$")
    legend_below(ax, ncols=4)
    energy = r"barely rocks  $\leftarrow$  energy $(E-E_0)\,/\,(E_0 - V_0)$  $\rightarrow$  stands up"
    dress(ax, energy, "turn per bounce (half turns)", "From the Euler disk to the race")
