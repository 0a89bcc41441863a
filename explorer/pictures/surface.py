"""F in the space of tilt and rates, in sections of one tilt."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from explorer.phase.arguments import column
from explorer.phase.disk import Disk
from explorer.phase.linear_constants import line_chart
from explorer.phase.states import Array
from explorer.pictures.register import Question, picture
from explorer.pictures.style import SIZE, TEXT, coordinate_label, dress, legend_of_all, number

_FACES = {1: ("#5AAE61", "-"), -1: ("#9970AB", "--")}  # faces, not sides of F


@picture(
    Question.FROM_WHERE,
    "F in the space of three coordinates of a state: the angle φ to the vertical, the rate σ₃, which is cos²φ "
    "times the precession, and the spin σ₄. Each section is at one value of φ. In each section, the states that "
    "fall on one face form a line through the origin, provided that the disk moves fast enough to reach flat. "
    "This line turns from one φ to the next. Lines have no thickness: almost every state lies on one side of "
    "them or the other.",
    (SIZE[0], 5.0),
    "surface",
)
def falling_surface(
    figure: Figure, disk: Disk, size: float | None = None, phi: Sequence[float] = (-1.2, -0.6, 0.0, 0.6, 1.2, 1.5)
) -> None:
    """Draw F, eq. (6.1), in the plane of sigma3 and sigma4 at several tilts, for |sigma3|, |sigma4| <= size."""
    reach = disk.rate_unit if size is None else size
    panels = figure.subplots(-(-len(phi) // 3), 3, sharex=True, sharey=True, squeeze=False).ravel()
    for ax, tilt, *lines in zip(panels, phi, *sheets(disk, reach, phi).values(), strict=False):
        for (face, (colour, dashes)), line in zip(_FACES.items(), lines, strict=True):
            name = f"falls on face {'+' if face > 0 else '−'}1"
            ax.plot(*line.T, color=colour, ls=dashes, lw=2.4, label=name)
        ax.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
        dress(ax, "", "", rf"$\varphi$ = {number(tilt)} rad")
    panels[-2].set_xlabel(coordinate_label("sigma3", disk), fontsize=TEXT)
    figure.supylabel(coordinate_label("sigma4", disk), fontsize=TEXT)
    figure.suptitle("Only states on two lines, at each tilt, can fall", fontsize=TEXT)
    legend_of_all(figure, panels)


def sheets(disk: Disk, size: float, phi: Sequence[float]) -> dict[int, Array]:
    """By the face, both ends (len(phi), 2, 2) of the line of (sigma3, sigma4) with eta = 0 at each tilt."""
    tilts = column("phi", phi)

    def ends(z: Array) -> Array:
        chart = line_chart(disk, np.cos(tilts), z)
        along = np.stack([chart.bar_to_sigma3, chart.bar_to_sigma4], axis=-1)
        along *= size / abs(along).max(axis=-1, keepdims=True)
        return np.stack([-along, along], axis=1)

    # The symmetry (3.2) takes face +1 to face -1
    return {1: ends(np.sin(tilts)), -1: ends(-np.sin(tilts)) * [1.0, -1.0]}
