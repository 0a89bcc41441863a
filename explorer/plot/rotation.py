"""The rotation number over the constants of motion."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Ellipse

from explorer.phase.states import Array
from explorer.plot.captions import Question, captioned
from explorer.plot.style import DARK, SMALL, TEXT, axes_or_new, coordinate_label, dress, styled
from explorer.portrait.rotation import RotationMap


@captioned(
    Question.WHERE_TO,
    "By how many turns the contact point advances in one period, without whole turns, over the constants of "
    "motion at one energy. The colours go round like the turns do. They jump at the lines l₊ and l₋, where the "
    "disk comes flat, by twice the race. The palest are resonances, a whole number of turns, at which the disk "
    "may wander off without bound.",
)
def rotation_map(rotation: RotationMap, ax: Axes | None = None, **look: Any) -> Axes:
    """Draw chi(tau)/2pi modulo 1 over (sigma3_bar, sigma4_bar) at one energy.

    Parameters
    ----------
    rotation : RotationMap
        From `explorer.portrait.rotation_map`.
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib's pcolormesh.

    Returns
    -------
    Axes

    References
    ----------
    Eq. (3.13) of the paper; Borisov, Mamaev & Kilin 2003.

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> from explorer.portrait import rotation_map
    >>> figure = plot.figure_of(plot.rotation_map, rotation_map(Disk.uniform(), 2.0, points=20))
    >>> figure.axes[1].get_ylabel()
    'turns per period, without whole ones'
    """
    ax = axes_or_new(ax)
    x, y = rotation.sigma3_bar, rotation.sigma4_bar
    style = styled(look, cmap="twilight", vmin=0.0, vmax=1.0, rasterized=True)
    colours = ax.pcolormesh(x, y, np.mod(rotation.turns, 1.0), **style)
    # Cells at the edge are whole or missing: cut through those that are whole.
    inner = 2.0 * (1.0 - 1.5 / x.size)
    rim = Ellipse((0.0, 0.0), inner * _outer(x), inner * _outer(y), transform=ax.transData)
    colours.set_clip_path(rim)
    bar = ax.figure.colorbar(colours, ax=ax, ticks=[0.0, 0.25, 0.5, 0.75, 1.0])
    bar.set_label("turns per period, without whole ones", fontsize=SMALL)
    # In the corners, not over the jumps that they name: where the lines leave the ellipse of this energy.
    for sign, name in ((1, "l_+"), (-1, "l_-")):
        for edge in (-1.0, 1.0):
            out = 1.0 / np.hypot(1.0 / x[-1], rotation.slope / y[-1])
            x_end, y_end = edge * out, sign * edge * rotation.slope * out
            how = {"arrowstyle": "-", "lw": 1.0, "color": DARK}
            ax.annotate(
                f"${name}$",
                (1.02 * x_end, 1.02 * y_end),
                (1.5 * x_end, 1.02 * y_end),
                fontsize=TEXT,
                ha="center",
                va="center",
                arrowprops=how,
            )
    energy = rotation.energy / rotation.disk.energy_unit
    across, up = (coordinate_label(name, rotation.disk) for name in ("sigma3_bar", "sigma4_bar"))
    return dress(ax, across, up, rf"Turns jump where the disk comes flat ($E$ = {energy:g} $mgr$)")


def _outer(middles: Array) -> float:
    """The end of an axis of which these are the middles of equal cells."""
    return float(middles[-1] * middles.size / (middles.size - 1))
