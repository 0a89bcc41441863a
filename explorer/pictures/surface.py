"""F as a surface in the space of tilt and rates."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d import Axes3D
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from explorer.phase.disk import Disk
from explorer.phase.lines import line_chart
from explorer.phase.states import Array
from explorer.pictures.register import Question, picture
from explorer.pictures.style import HALF_PI, SMALL, TEXT, coordinate_label

_SHEETS = {1: "#5AAE61", -1: "#9970AB"}  # faces, not sides of F
_EDGE = 1.5  # rad of phi: the sheets are drawn to there, flat is pi/2


@picture(
    Question.FROM_WHERE,
    "F as a surface in the space of the tilt φ and the rates σ₃ and σ₄: green are the states that fall on face "
    "+1, violet those on face −1, if the disk has speed enough to get there. Each sheet is made of straight lines "
    "and has no thickness: almost every state lies on one side of it or the other.",
    (7.2, 5.8),
    "surface",
)
def falling_surface(figure: Figure, disk: Disk, size: float | None = None, points: int = 41) -> None:
    """Draw both sheets of F, eq. (6.1), over (phi, sigma3, sigma4), in the box |sigma3|, |sigma4| <= size."""
    ax = figure.add_subplot(projection="3d")
    assert isinstance(ax, Axes3D)
    # One collection: what is in front is found for each piece, so that the sheets pass through each other.
    pieces, colours = [], []
    for face, grid in sheets(disk, disk.rate_unit if size is None else size, points).items():
        corners = np.stack([grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]], axis=2).reshape(-1, 4, 3)
        pieces.append(corners)
        colours += [_SHEETS[face]] * len(corners)
        ax.plot([], [], color=_SHEETS[face], lw=8, label=f"falls on face {'+' if face > 0 else '−'}1")
    every = np.concatenate(pieces)
    ax.add_collection3d(Poly3DCollection(every, facecolors=colours, edgecolors="white", lw=0.2, shade=True))
    ax.set(**{f"{name}lim": (every[..., k].min(), every[..., k].max()) for k, name in enumerate("xyz")})
    for name_axis, name in ((ax.set_xlabel, "phi"), (ax.set_ylabel, "sigma3"), (ax.set_zlabel, "sigma4")):
        name_axis(coordinate_label(name, disk), fontsize=TEXT)
    ax.set_xticks([-HALF_PI, 0.0, HALF_PI], ["−π/2", "0", "π/2"])
    ax.yaxis.set_major_locator(MaxNLocator(4, prune="lower"))  # in the corner it would touch that of phi
    ax.zaxis.set_major_locator(MaxNLocator(4))
    ax.tick_params(labelsize=SMALL)
    ax.set_title("F: two sheets without thickness", fontsize=TEXT)
    ax.legend(fontsize=SMALL, loc="upper left")
    ax.view_init(elev=22.0, azim=-58.0)
    ax.set_box_aspect((1.0, 1.0, 0.8), zoom=0.95)


def sheets(disk: Disk, size: float, points: int) -> dict[int, Array]:
    """By the face, the states (points, points, 3) with eta = 0: over each tilt a line through the origin."""
    phi = np.linspace(-_EDGE, _EDGE, points)
    chart = line_chart(disk, np.cos(phi), np.sin(phi))
    longer = np.maximum(abs(chart.bar_to_sigma3), abs(chart.bar_to_sigma4))
    along = np.linspace(-size, size, points)
    sigma3, sigma4 = ((rate / longer)[:, None] * along for rate in (chart.bar_to_sigma3, chart.bar_to_sigma4))
    plus = np.stack([np.repeat(phi[:, None], points, axis=1), sigma3, sigma4], axis=-1)
    return {1: plus, -1: plus * [-1.0, 1.0, -1.0]}  # the symmetry (3.2) takes face +1 to face -1
