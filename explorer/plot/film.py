"""A film of the disk nearly falling flat, both sides of F next to each other."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from explorer.errors import InputError
from explorer.phase.disk import Disk
from explorer.phase.states import Array
from explorer.plot.captions import Question, captioned
from explorer.plot.style import DARK, SIGN_COLOURS, SMALL, TEXT
from explorer.portrait.film import FRAMES, Film, film

# From above, for the paths on the table, and from aside, for the tilt.
_ELEVATION, _AZIMUTH = math.radians(32.0), math.radians(-50.0)
_FRAME_MS, _REST_MS = 60, 1500  # some 17 frames a second; the last frame stays long enough to be compared
# Small enough for a page: 100 frames stay below 3 MB.
_DPI, _SIZE = 100, (6.4, 3.8)
_COLOURS = 96  # of the palette, for a smaller file; a GIF may have 256
_ROUND = np.linspace(0.0, 2.0 * np.pi, 73)
_TABLE, _LINES = "#EFEDE6", "#D5D2C8"
_GRID = 6  # radii from the start to the edge of the lines on the table


def seen(points: Array) -> Array:
    """Points (..., 3) from above and aside, without perspective: (..., 2), lengths as given."""
    c, s = math.cos(_AZIMUTH), math.sin(_AZIMUTH)
    right = c * points[..., 0] + s * points[..., 1]
    away = -s * points[..., 0] + c * points[..., 1]
    up = math.sin(_ELEVATION) * away + math.cos(_ELEVATION) * points[..., 2]
    return np.stack([right, up], axis=-1)


class _Panel:
    """One side of F; its artists are moved from frame to frame."""

    def __init__(self, ax: Axes, shown: Film, sign: int, limits: tuple[Array, Array]) -> None:
        self.shown, self.sign = shown, sign
        colour = SIGN_COLOURS[sign]
        self.trail = seen(shown.contact[sign] / shown.disk.r)
        ax.set_facecolor(_TABLE)
        ax.set_xticks([])
        ax.set_yticks([])
        for at in range(-_GRID, _GRID + 1):
            for line in ([[at, -_GRID, 0], [at, _GRID, 0]], [[-_GRID, at, 0], [_GRID, at, 0]]):
                ax.plot(*seen(np.array(line)).T, color=_LINES, lw=0.7)
        (self.past,) = ax.plot([], [], color=colour, lw=2.2)
        (self.face,) = ax.fill(np.zeros(3), np.zeros(3), color=colour, alpha=0.25, lw=0)
        (self.rim,) = ax.plot([], [], color=DARK, lw=1.6)
        (self.spoke,) = ax.plot([], [], color=DARK, lw=0.9)
        (self.mark,) = ax.plot([], [], "s", color="white", mec=DARK, ms=7)
        (self.contact,) = ax.plot([], [], "o", color=colour, mec=DARK, ms=8)
        turned, eta_hat = shown.chi[sign][-1] - shown.chi[sign][0], sign * shown.eta_hat
        ax.set_title(rf"$\hat\eta$ = {eta_hat:+.4g}: contact turns by {turned:+.2f} rad", fontsize=SMALL)
        ax.set_xlim(limits[0][0], limits[1][0])
        ax.set_ylim(limits[0][1], limits[1][1])
        ax.set_aspect("equal", adjustable="box")

    def show(self, row: int) -> None:
        r, shown = self.shown.disk.r, self.shown
        rim = seen(shown.pose(self.sign, row).rim(_ROUND) / r)
        mark, centre = (seen(p / r) for p in (shown.pose(self.sign, row).mark, shown.centre[self.sign][row]))
        self.past.set_data(*self.trail[: row + 1].T)
        self.face.set_xy(rim)
        self.rim.set_data(*rim.T)
        self.spoke.set_data([centre[0], mark[0]], [centre[1], mark[1]])
        self.mark.set_data([mark[0]], [mark[1]])
        self.contact.set_data([self.trail[row, 0]], [self.trail[row, 1]])


class Stage:
    """The figure of a film; `show` moves it to one row."""

    def __init__(self, shown: Film) -> None:
        self.shown = shown
        self.figure = Figure(figsize=_SIZE, dpi=_DPI)
        self.canvas = FigureCanvasAgg(self.figure)
        axes: Sequence[Axes] = self.figure.subplots(1, 2)
        self.figure.subplots_adjust(left=0.015, right=0.985, top=0.83, bottom=0.125, wspace=0.03)
        limits = self._limits()
        self.panels = [_Panel(ax, shown, sign, limits) for ax, sign in zip(axes, (1, -1), strict=True)]
        name = "" if shown.disk.name == "custom" else f", {shown.disk.name} disk"
        race = rf"race $\pm\kappa\pi$ = {shown.disk.race_limit:.2f} rad, plus fall angle"
        self.figure.suptitle(f"Both sides of $F${name}: {race}", fontsize=TEXT, y=0.985)
        # Letters of one width: the line must not jump from frame to frame.
        self.clock = self.figure.text(0.5, 0.035, "", ha="center", fontsize=SMALL, family="monospace")

    def _limits(self) -> tuple[Array, Array]:
        shown = self.shown
        points = [
            seen(shown.pose(sign, row).rim(_ROUND) / shown.disk.r) for sign in (1, -1) for row in shown.frames[::3]
        ]
        every = np.concatenate([*points, *(seen(shown.contact[sign] / shown.disk.r) for sign in (1, -1))])
        return every.min(axis=0) - 0.15, every.max(axis=0) + 0.15

    def show(self, row: int) -> None:
        """Draw row `row` of the film; the clock says by how much time is slowed."""
        for panel in self.panels:
            panel.show(row)
        t, slowed = self.shown.t[row], self.shown.slowed[row]
        natural = t / self.shown.disk.time_unit
        self.clock.set_text(
            rf"t = {natural:+.3f} $\sqrt{{r/g}}$; near flat the clock is slowed: {slowed:4.1f} times"
        )

    def image(self, row: int) -> Image.Image:
        """Row `row` as a picture."""
        self.show(row)
        self.canvas.draw()
        return Image.fromarray(np.asarray(self.canvas.buffer_rgba())).convert("RGB")


@captioned(
    Question.HAPPENS,
    "A disk rises from the vertical to nearly flat and back, on both sides of F. Near flat time is slowed: "
    "the contact point races round the rim, one way on the left, the other way on the right.",
)
def animate(path: Path | str, disk: Disk, *, frames: int = FRAMES, **options: Any) -> Film:
    """Write a GIF of the disk from the vertical to nearly flat and back, eta_hat > 0 and < 0 side by side.

    Parameters
    ----------
    path : Path or str
        File to write; its name ends in .gif.
    disk : Disk
    frames : int
        Between frames time goes on in proportion to cos(phi), so that the race fills many of them.
    **options
        eta_hat, sigma3_bar and phidot as for `explorer.portrait.film.film`.

    Returns
    -------
    Film
        The data that were drawn.

    Raises
    ------
    InputError
        Where the path or an option cannot be used.

    References
    ----------
    Section 7 of the paper.

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> shown = plot.animate("fall.gif", Disk.uniform())  # doctest: +SKIP
    """
    where = Path(path)
    if where.suffix.lower() != ".gif":
        raise InputError(f"path = {str(path)!r}: the film is a GIF; give a name that ends in .gif")
    if not where.parent.is_dir():
        raise InputError(f"path = {str(path)!r}: there is no folder {str(where.parent)!r}; make it first")
    shown = film(disk, frames=frames, **options)
    stage = Stage(shown)
    pictures = [stage.image(int(row)) for row in shown.frames]
    # One palette for all frames, from one in the middle of the race: colours must not flicker.
    palette = pictures[len(pictures) // 2].quantize(_COLOURS)
    reduced = [p.quantize(palette=palette, dither=Image.Dither.NONE) for p in pictures]
    durations = [_FRAME_MS] * (len(reduced) - 1) + [_REST_MS]
    reduced[0].save(where, save_all=True, append_images=reduced[1:], duration=durations, loop=0, optimize=False)
    return shown
