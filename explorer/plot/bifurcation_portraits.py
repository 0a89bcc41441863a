"""The bifurcation diagram with a portrait of the motions at each of its places."""

from typing import Any

from matplotlib.figure import Figure

from explorer.plot.captions import CAPTIONS, Question, captioned, replace_caption
from explorer.plot.potential import phase_portrait
from explorer.plot.steady import bifurcations
from explorer.plot.style import DARK, SIZE, SMALL, TEXT
from explorer.portrait.bifurcation_portraits import BifurcationPortraits


@captioned(
    Question.WHICH_MOTIONS,
    "Above: the tilts of steady motions along a path through the constants, solid where stable and "
    "broken where unstable. Below: the motions of the tilt at the places A, B, C. Each stable one is the "
    "middle of a well of swinging motions, each unstable one a crossing of the separatrix. Motions on violet "
    "ground fall.",
)
def bifurcation_portraits(found: BifurcationPortraits) -> Figure:
    """Draw steady motions along a path, and portraits of (phi, phidot) at some of its places.

    Parameters
    ----------
    found : BifurcationPortraits
        From `explorer.portrait.bifurcation_portraits.bifurcation_portraits`.

    Returns
    -------
    Figure

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> from explorer.portrait.bifurcation_portraits import bifurcation_portraits
    >>> figure = plot.bifurcation_portraits(bifurcation_portraits(Disk.uniform(), "line"))
    >>> figure.axes[1].get_title()
    'A: 0.138'
    """
    figure = Figure(figsize=(SIZE[0] + 1.6, 8.0), layout="constrained")
    grid = figure.add_gridspec(2, len(found.places), height_ratios=(1.25, 1.0))
    diagram = bifurcations(
        found.disk, found.path, found.branches, found.thresholds, ax=figure.add_subplot(grid[0, :])
    )
    unit = found.disk.rate_unit
    for number, (place, potential) in enumerate(zip(found.places, found.potentials, strict=True)):
        letter = chr(ord("A") + number)
        diagram.axvline(place, color=DARK, lw=0.9)
        above: dict[str, Any] = {"xycoords": diagram.get_xaxis_transform(), "textcoords": "offset points"}
        diagram.annotate(letter, (place, 0.92), xytext=(3, 0), **above, fontsize=TEXT, fontweight="bold")
        ax = phase_portrait(potential, ax=figure.add_subplot(grid[1, number]))
        ax.set_title(f"{letter}: {place / unit:.3g}", fontsize=TEXT)
        ax.set_xticks(ax.get_xticks()[[0, 2, 4]], ["−π/2", "0", "π/2"], fontsize=SMALL)
        legend = ax.get_legend()
        if legend is not None:
            legend.remove()
        if number:
            ax.set_ylabel("")
        ax.set_xlabel(r"$\varphi$ (rad)")
    replace_caption(figure, CAPTIONS["bifurcation_portraits"])
    return figure
