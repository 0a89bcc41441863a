"""The bifurcation diagram: energies of steady motions, with a portrait of the motions in each region."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from explorer.phase.states import Array
from explorer.plot.captions import Question, captioned
from explorer.plot.potential import SEPARATRIX, small_portrait
from explorer.plot.steady import PATH_NAMES
from explorer.plot.style import (
    BOUNCES,
    DARK,
    FALLS,
    SIZE,
    SMALL,
    TEXT,
    UNSTABLE,
    coordinate_label,
    dress,
    rates_of,
)
from explorer.portrait.bifurcation_portraits import BifurcationPortraits
from explorer.portrait.potential import CENTRE, SADDLE, Component

_POINT: dict[str, Any] = {"ha": "center", "va": "center", "fontweight": "bold", "fontsize": TEXT}


@captioned(
    Question.WHICH_MOTIONS,
    "Which motions there are, by energy. Above, the plane of σ̄ and the energy is cut into regions by the energies "
    "of stable and of unstable steady motions and, on l₊, by V₀, above which the disk can reach flat. Below, the "
    "motions of the tilt at one place of each region, those of the letter's energy drawn thick; on violet ground "
    "the disk falls.",
)
def bifurcation_portraits(found: BifurcationPortraits) -> Figure:
    """Draw the energies of steady motions along a path, and a portrait of (phi, phidot) for each region.

    Parameters
    ----------
    found : BifurcationPortraits
        From `explorer.portrait.bifurcation_portraits`.

    Returns
    -------
    Figure
        First the plane of the path's parameter and the energy, then a small portrait for each place.

    References
    ----------
    Section 6.2 of the paper; Borisov, Mamaev & Kilin 2003.

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> from explorer.portrait import bifurcation_portraits
    >>> figure = plot.bifurcation_portraits(bifurcation_portraits(Disk.uniform(), "line"))
    >>> figure.axes[2].get_title()
    'B: some fall'
    """
    figure = Figure(figsize=(SIZE[0] + 1.6, 7.4), layout="constrained")
    grid = figure.add_gridspec(2, len(found.places), height_ratios=(1.7, 1.0))
    _plane(figure.add_subplot(grid[0, :]), found)
    first: Axes | None = None
    fastest = 0.0
    for number, ((_, energy), potential) in enumerate(zip(found.places, found.potentials, strict=True)):
        ax = figure.add_subplot(grid[1, number], sharey=first)
        fastest = max(fastest, small_portrait(ax, potential, energy))
        ax.set_ylim(-1.1 * fastest, 1.1 * fastest)
        ax.set_title(f"{_letter(number)}: {_fate(potential.components(energy))}", fontsize=SMALL)
        ax.set_xlabel(r"$\varphi$ (rad)", fontsize=SMALL)
        if first is None:
            first = ax
            ax.set_ylabel(coordinate_label("phidot", found.disk), fontsize=SMALL)
        else:
            ax.tick_params(labelleft=False)
    return figure


def _letter(number: int) -> str:
    return chr(ord("A") + number)


def _fate(pieces: tuple[Component, ...]) -> str:
    """What motions of one energy do."""
    falls = [piece.falls for piece in pieces]
    if any(falls):
        return "all fall" if all(falls) else "some fall"
    return "all bounce" if len(pieces) == 1 else f"{len(pieces)} wells"


def _plane(ax: Axes, found: BifurcationPortraits) -> None:
    """Regions and curves over the path's parameter and the energy, with a letter for each place."""
    disk, top = found.disk, 1.12 * max(energy for _, energy in found.places)
    falling = found.path == "line"
    ax.fill_between(found.parameter, found.floor, top, color=FALLS if falling else BOUNCES, lw=0, zorder=0)
    ax.fill_between(found.parameter, 0.0, found.floor, fc="white", ec="0.8", hatch="//", lw=0, zorder=0)
    low, high = _between(found)
    inner = np.isfinite(low)
    ax.fill_between(found.parameter[inner], low[inner], high[inner], color=UNSTABLE, lw=0, zorder=1)
    styles: dict[str, dict[str, Any]] = {
        CENTRE: {"color": DARK, "ls": "-", "lw": 2.2, "label": "stable steady motion"},
        SADDLE: {"color": SEPARATRIX, "ls": (0, (4, 1.5)), "lw": 2.4, "label": "unstable one, and its separatrix"},
    }
    for branch in found.branches:
        style = styles[branch.kind]
        ax.plot(branch.parameter, branch.energy, **style, zorder=3)
        styles[branch.kind] = style | {"label": None}
    if falling:
        ax.plot(found.parameter, found.floor, color=DARK, lw=2.6, ls=":", label="$V_0$: flat can be reached")
    ax.axvline(found.threshold, color=DARK, lw=0.7)
    words = f"steady motions merge: {found.threshold / disk.rate_unit:.5f}"
    ground: dict[str, Any] = {"fc": "white", "ec": "none", "alpha": 0.8, "pad": 1.5}
    where = 1.012 * found.threshold, 0.04 * top
    ax.text(*where, words, rotation=90, va="bottom", fontsize=SMALL, bbox=ground)
    for number, place in enumerate(found.places):
        ax.plot(*place, "o", ms=17, color="white", mec=DARK, zorder=5)
        ax.text(*place, _letter(number), zorder=6, **_POINT)
    ax.set_xlim(0.0, 1.45 * found.threshold)
    ax.set_ylim(0.0, top)
    several = Patch(fc=UNSTABLE, ec=DARK, label="a well, or a fall" if falling else "two wells")
    whole = Patch(fc=FALLS if falling else BOUNCES, ec=DARK, label="falls" if falling else "one well")
    none = Patch(fc="white", ec="0.6", hatch="//", label="no motion")
    handles = [*ax.get_legend_handles_labels()[0], several, whole, none]
    ax.legend(
        handles=handles, fontsize=SMALL, frameon=False, ncols=3, loc="lower center", bbox_to_anchor=(0.5, 1.06)
    )
    symbol, name = PATH_NAMES[found.path]
    dress(
        ax,
        f"{symbol} ({rates_of(disk)})",
        coordinate_label("energy", disk),
        f"{disk.name}, {name.removeprefix('steady ')}",
    )


def _between(found: BifurcationPortraits) -> tuple[Array, Array]:
    """Energies of the stable and the unstable steady motion, where there is an unstable one; NaN elsewhere."""
    ends = []
    for kind, choose in ((CENTRE, np.fmin), (SADDLE, np.fmax)):
        energy = np.full(found.parameter.size, np.nan)
        for branch in found.branches:
            if branch.kind == kind:
                rows = np.searchsorted(found.parameter, branch.parameter)
                energy[rows] = choose(energy[rows], branch.energy)
        ends.append(energy)
    low, high = ends
    both = np.isfinite(low) & np.isfinite(high)
    return np.where(both, low, np.nan), np.where(both, high, np.nan)
