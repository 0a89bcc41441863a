"""The disk that rocks near flat: from the Euler disk to the race."""

import numpy as np
from matplotlib.axes import Axes

from explorer.motion.rocking import rocking as rocking_of
from explorer.phase.disk import Disk
from explorer.pictures.register import Question, picture
from explorer.pictures.style import body_looks, dress, legend_below

_OF_ANY = "0.4"  # lines in a legend that are drawn of each body, in its colour


@picture(
    Question.HOW_FAR,
    "The turn of the contact point per bounce, from one flattest moment to the next, against the energy above "
    "E₀, the least energy that a motion at this distance from F can have. A disk that barely rocks turns as "
    "Euler's disk does (dotted line); one with the energy to stand up races by κ half turns (dashed line).",
    group="bounces",
)
def rocking(ax: Axes, disk: Disk) -> None:
    """Draw the turn per bounce against energy, by `explorer.rocking`: uniform disk, hoop and your disk."""
    bodies = {each.name: each for each in (Disk.uniform(), Disk.hoop(), disk)}
    for name, (colour, _) in body_looks(bodies).items():
        body, found = bodies[name], rocking_of(bodies[name])
        x = found.excess - 1.0
        shown = x > 0.0
        ax.semilogx(x[shown], abs(found.chi[shown]) / np.pi, lw=2.4, label=name, zorder=3, color=colour)
        ends = x[shown][[0, -1]]
        ax.plot(ends, [found.slowest / np.pi] * 2, lw=1.2, ls=":", color=colour)
        ax.plot(ends, [body.kappa] * 2, lw=1.2, ls="--", color=colour)
    ax.plot([], [], color=_OF_ANY, lw=1.2, ls=":", label=r"Euler disk, $2\sqrt{M/(3I_1)}$")
    ax.plot([], [], color=_OF_ANY, lw=1.2, ls="--", label=r"race, $\kappa$")
    legend_below(ax)
    title = "With energy the turn per bounce becomes the race"
    dress(ax, "energy of rocking $(E-E_0)\\,/\\,(E_0 - V_0)$", "turn per bounce (half turns)", title)
