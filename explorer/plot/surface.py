"""F as a surface, and under a magnifying glass."""

import math

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import ConnectionPatch, Rectangle
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d import Axes3D
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from explorer.plot.captions import Question, captioned
from explorer.plot.style import DARK, HALF_PI, SIGN_COLOURS, SMALL, TEXT, coordinate_label
from explorer.portrait.falling_surface import FallingSurface, Zoom

# Faces, not sides of F.
_SHEETS = {1: "#5AAE61", -1: "#9970AB"}
_SIDE = 2.3  # inches of a square


@captioned(
    Question.FROM_WHERE,
    "F as a surface in the space of the tilt φ and the rates σ₃ and σ₄: green are the states that fall on face "
    "+1, violet those on face −1, if the disk has speed enough to get there. Each sheet is made of straight lines "
    "and has no thickness: almost every state lies on one side of it or the other.",
)
def falling_surface(surface: FallingSurface) -> Figure:
    r"""Draw both sheets of F over (phi, sigma3, sigma4).

    Parameters
    ----------
    surface : FallingSurface
        From `explorer.portrait.falling_surface`.

    Returns
    -------
    Figure

    References
    ----------
    Eq. (6.1) of the paper.

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> from explorer.portrait import falling_surface
    >>> plot.falling_surface(falling_surface(Disk.uniform())).axes[0].get_xlabel()
    '$\\varphi$ (rad)'
    """
    figure = Figure(figsize=(7.2, 5.8), layout="constrained")
    ax = figure.add_subplot(projection="3d")
    assert isinstance(ax, Axes3D)
    # One collection: what is in front is found for each piece, so that the sheets pass through each other.
    pieces, colours = [], []
    for face, colour in _SHEETS.items():
        grid = np.stack([surface.phi[face], surface.sigma3[face], surface.sigma4[face]], axis=-1)
        corners = np.stack([grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]], axis=2).reshape(-1, 4, 3)
        pieces.append(corners)
        colours += [colour] * len(corners)
        ax.plot([], [], color=colour, lw=8, label=f"falls on face {'+' if face > 0 else '−'}1")
    every = np.concatenate(pieces)
    ax.add_collection3d(Poly3DCollection(every, facecolors=colours, edgecolors="white", lw=0.2, shade=True))
    ax.set(**{f"{name}lim": (every[..., k].min(), every[..., k].max()) for k, name in enumerate("xyz")})
    for label, name in ((ax.set_xlabel, "phi"), (ax.set_ylabel, "sigma3"), (ax.set_zlabel, "sigma4")):
        label(coordinate_label(name, surface.disk), fontsize=TEXT)
    ax.set_xticks([-HALF_PI, 0.0, HALF_PI], ["−π/2", "0", "π/2"])
    ax.yaxis.set_major_locator(MaxNLocator(4, prune="lower"))  # in the corner it would touch that of phi
    ax.zaxis.set_major_locator(MaxNLocator(4))
    ax.tick_params(labelsize=SMALL)
    ax.set_title("F: two sheets without thickness", fontsize=TEXT)
    ax.legend(fontsize=SMALL, loc="upper left")
    ax.view_init(elev=22.0, azim=-58.0)
    ax.set_box_aspect((1.0, 1.0, 0.8), zoom=0.95)
    return figure


@captioned(
    Question.HOW_RARELY,
    "A point of F under a magnifying glass: each square is the small one inside the square before it. Every dot "
    "is a motion, blue where its contact point races one way, vermilion and hollow where it races the other way. "
    "However strong the glass, both colours meet in one line, and no motion falls.",
)
def zoom_on_f(zoomed: Zoom) -> Figure:
    """Draw the way of the race on squares round a point of F.

    Parameters
    ----------
    zoomed : Zoom
        From `explorer.portrait.zoom`.

    Returns
    -------
    Figure

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> from explorer.portrait import zoom
    >>> len(plot.zoom_on_f(zoom(Disk.uniform(), [0.3, 3e-5], points=4)).axes)
    2
    """
    count, unit = zoomed.half.size, zoomed.disk.rate_unit
    figure = Figure(figsize=(_SIDE * count + 0.4, _SIDE + 1.2))
    figure.subplots_adjust(left=0.05, right=0.98, top=0.80, bottom=0.14, wspace=0.22)
    panels = figure.subplots(1, count, squeeze=False)[0]
    x, y = np.meshgrid(zoomed.offset, zoomed.offset)
    for k, ax in enumerate(panels):
        way = np.sign(zoomed.race_angle[k])
        # Filled and hollow: blue and vermilion are one grey in print.
        for side, fill in ((1, SIGN_COLOURS[1]), (-1, "white")):
            these = way == side
            ax.scatter(x[these], y[these], s=14, c=fill, edgecolors=SIGN_COLOURS[side], lw=0.9)
        ax.set(xlim=(-1, 1), ylim=(-1, 1), aspect="equal", xticks=[], yticks=[])
        power = zoomed.half[0] / zoomed.half[k]
        words = "as it is" if k == 0 else rf"magnified ${_power(power)}$"
        ax.set_title(words, fontsize=TEXT)
        ax.set_xlabel(rf"$\bar\sigma_3$, $\pm {_power(zoomed.half[k] / unit)}$", fontsize=SMALL)
        if k + 1 < count:
            ax.add_patch(Rectangle((-0.06, -0.06), 0.12, 0.12, fill=False, ec=DARK, lw=1.6))
            for edge in (-1.0, 1.0):
                there = panels[k + 1].transData
                line = ConnectionPatch((0.06, 0.06 * edge), (-1.0, edge), ax.transData, there, color=DARK, lw=0.9)
                figure.add_artist(line)
    panels[0].set_ylabel(r"$\hat\eta$", fontsize=TEXT)
    total = zoomed.race_angle.size
    figure.suptitle(
        f"However near one looks, F is a line: of {total:,} motions {zoomed.falls or 'none'} fall".replace(
            "none fall", "none falls"
        ),
        fontsize=TEXT + 1,
    )
    return figure


def _power(value: float) -> str:
    """A number as a power of ten, with its factor where that is not 1."""
    exponent = math.floor(math.log10(value) + 1e-9)
    factor = value / 10.0**exponent
    front = "" if abs(factor - 1.0) < 1e-6 else rf"{factor:.2g} \times "
    return rf"{front}10^{{{exponent}}}"
