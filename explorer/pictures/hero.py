"""The whole phenomenon in one picture: a disk falls, its contact point races round, it rises elsewhere."""

import math
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from explorer.errors import InputError
from explorer.phase.disk import Disk
from explorer.phase.states import Array
from explorer.pictures import solid
from explorer.pictures.film_motions import Film, film
from explorer.pictures.pose import Pose
from explorer.pictures.register import Question, picture
from explorer.pictures.style import DARK, SIGN_COLOURS, open_frame

_SIZE = (32.0 / 3.0, 6.0)  # 1600 by 900 pixels as `save` writes it
_LARGE, _TEXT, _SMALL = 16.2, 12.4, 10.4
_GREY = "#777777"
# Tilts from the vertical (degrees) of the ghosts, on the way down and on the way up.
_FALL, _RISE = (0.0, 30.0, 55.0), (5.0, 42.0, 70.0)
_HEADS = (0.2, 0.4, 0.6, 0.8)  # shares of the race at which the band shows its way
_FLAT = 88.0  # beyond, all poses look like the flat one
_ARROW = (1.18, 1.46, 0.11)  # radii of the race's band, inside at its start and at its end, and its width
_SPAN = (3.1, -1.62, 2.5)  # half the width, bottom and top of what is seen of a scene, in radii
_TINTED = {1: ("#8CC3E6", "#2C86BF"), -1: ("#F6B58A", "#E0742F")}
_VIEW = (math.radians(33.0), math.radians(220.0), 9.0)


class _Rows(NamedTuple):
    """Rows of a film: poses on the way down and up, the flattest one, and the two between which it looks flat."""

    fall: list[int]
    rise: list[int]
    flat: int
    lies: int
    leaves: int


def _rows(shown: Film, sign: int) -> _Rows:
    phi = np.degrees(shown.phi[sign])
    flat = int(np.argmax(phi))
    fall = [int(np.argmin(abs(phi[: flat + 1] - tilt))) for tilt in _FALL]
    rise = [flat + int(np.argmin(abs(phi[flat:] - tilt))) for tilt in _RISE]
    flats = np.flatnonzero(phi > _FLAT)
    if flats.size == 0:
        raise InputError(
            f"shown: the disk comes within {90.0 - phi[flat]:.2g} degrees of flat only, not {90.0 - _FLAT:g}; "
            "make the film with a smaller eta_hat"
        )
    return _Rows(fall, rise[::-1], flat, int(flats[0]), int(flats[-1]))


def _band(shown: Film, sign: int, rows: _Rows) -> Array:
    """The race as an arrow on the table round the disk that lies there: points (n, 3) of its outline."""
    chi = shown.chi[sign]
    start = chi[rows.flat] - sign * 0.5 * shown.disk.race_limit
    end = start + sign * shown.disk.race_limit
    head = sign * 0.22
    angle = np.linspace(start, end - head, 160)
    inner = np.linspace(_ARROW[0], _ARROW[1], 160)
    wide = _ARROW[2]
    tip = [_ARROW[1] + wide * share for share in (1.9, 0.5, -0.9)]
    angles = np.concatenate([angle, [angle[-1], end, angle[-1]], angle[::-1]])
    radii = np.concatenate([inner + wide, tip, inner[::-1]])
    return _on_table(shown, sign, rows, angles, radii)


def _head(shown: Film, sign: int, rows: _Rows, at: float) -> Array:
    """An arrowhead on the band that points along the race, at a share of it: points (3, 3)."""
    turned = at * shown.disk.race_limit
    angle = shown.chi[sign][rows.flat] + sign * (turned - 0.5 * shown.disk.race_limit)
    radius = _ARROW[0] + at * (_ARROW[1] - _ARROW[0])
    radii = radius + np.array([-0.9, 0.5, 1.9]) * _ARROW[2]
    return _on_table(shown, sign, rows, angle + sign * np.array([0.0, 0.2, 0.0]), radii)


def _on_table(shown: Film, sign: int, rows: _Rows, angles: Array, radii: Array) -> Array:
    """Points (n, 3) round the disk that lies there, at radii in radii of the disk."""
    flat = np.stack([radii * np.cos(angles), radii * np.sin(angles), 0.0 * angles], axis=-1)
    return np.asarray(shown.centre[sign][rows.flat] * [1.0, 1.0, 0.0] + shown.disk.r * flat)


def _scene(ax: Axes, shown: Film, sign: int) -> None:
    """One side of F: ghosts that fall, the disk that lies, the race, ghosts that rise."""
    rows, r = _rows(shown, sign), shown.disk.r
    ground = shown.centre[sign][rows.flat] * [1.0, 1.0, 0.0]
    camera = solid.Camera(ground, _VIEW[0], _VIEW[1], _VIEW[2] * r)
    colour = SIGN_COLOURS[sign]
    solid.table(ax, camera, ground, 3.4 * r, r)

    def pose(row: int) -> Pose:
        return shown.pose(sign, row)

    for row in (*rows.fall[:1], rows.flat, rows.rise[-1]):
        solid.shadow(ax, camera, pose(row), 0.8)
    path = camera.see(shown.contact[sign])
    ax.plot(*path[: rows.lies + 1].T, color=_GREY, lw=2.4, zorder=2)
    ax.plot(*path[rows.leaves :].T, color=colour, lw=2.4, zorder=2)
    band = Polygon(camera.see(_band(shown, sign, rows)), fc=colour, ec="white", lw=0.9, zorder=2.2)
    ax.add_patch(band)
    solid.disk(ax, camera, pose(rows.flat), solid.Looks(width=0.9), zorder=3)
    for k, row in enumerate(rows.fall):
        ghost = solid.Looks(0.25 + 0.1 * k, "#E4E4E4", "#C4C4C4", outline=_GREY, width=0.7, marked=False)
        solid.disk(ax, camera, pose(row), ghost, zorder=8 - k)
    upper, lower = _TINTED[sign]
    for k, row in enumerate(rows.rise):
        last = k == len(rows.rise) - 1
        ghost = solid.Looks(0.97 if last else 0.4 + 0.15 * k, upper, lower, colour, 0.9, marked=last)
        solid.disk(ax, camera, pose(row), ghost, zorder=10 + k)
    for at in _HEADS:
        head = camera.see(_head(shown, sign, rows, at))
        ax.add_patch(Polygon(head, fc=colour, ec="white", lw=0.9, zorder=2.3))
    _words(ax, camera, shown, sign, rows)
    wide, low, high = (r * size for size in _SPAN)
    ax.set(xlim=(-wide, wide), ylim=(low, high), aspect="equal")
    ax.axis("off")


def _words(ax: Axes, camera: solid.Camera, shown: Film, sign: int, rows: _Rows) -> None:
    """What happens, in its order, beside where it happens."""
    gap, colour = 0.2 * shown.disk.r, SIGN_COLOURS[sign]
    # The ghosts that fall stand on the side of the picture that the risen disk has left.
    for row, word, ink, way in (
        (rows.fall[0], "1  falls", _GREY, sign),
        (rows.rise[-1], "3  rises", colour, -sign),
    ):
        rim = camera.see(shown.pose(sign, row).rim(np.linspace(0.0, 2.0 * math.pi, 37)))
        edge = rim[np.argmax(way * rim[:, 0])]
        align = "left" if way > 0 else "right"
        ax.text(edge[0] + way * gap, edge[1], word, color=ink, ha=align, va="center", fontsize=_TEXT, zorder=30)
    front = camera.see(_on_table(shown, sign, rows, np.array([camera.azimuth]), np.array([1.75])))[0]
    words = f"2  lies almost flat: the contact point races {'one way' if sign > 0 else 'the other way'}"
    ax.text(front[0], front[1] - gap, words, ha="center", va="top", color=DARK, fontsize=_TEXT, zorder=30)


def _turns(ax: Axes, shown: Film) -> None:
    """How far the contact point has run round, in turns, on both sides."""
    unit = shown.disk.time_unit
    t, full = shown.t / unit, shown.disk.race_limit / (2.0 * math.pi)
    middle = 0.5 * (shown.chi[1][np.argmax(shown.phi[1])] + shown.chi[-1][np.argmax(shown.phi[-1])])
    ax.axvline(0.0, color="#BBBBBB", lw=1.0, ls=(0, (4, 4)))
    for sign in (1, -1):
        turns = shown.chi[sign] / (2.0 * math.pi)
        before = t < t[_rows(shown, sign).lies]
        ax.plot(t[~before], turns[~before], color=SIGN_COLOURS[sign], lw=2.7, solid_capstyle="round")
        ax.plot(t[before], turns[before], color=_GREY, lw=2.7, solid_capstyle="round")
    fallen = float(middle) / (2.0 * math.pi)
    for sign, way in ((1, "one way"), (-1, "the other way")):
        top = fallen + sign * full
        ax.plot([0.02, 0.22], [top, top], color=SIGN_COLOURS[sign], lw=0.9, ls=(0, (4, 3)))
        ax.annotate(
            "",
            (0.11, top),
            (0.11, fallen),
            arrowprops={"arrowstyle": "<|-|>", "color": SIGN_COLOURS[sign], "lw": 1.1},
        )
        word = rf"{full:.2f} turns {way}: ${'+' if sign > 0 else '-'}\kappa\pi$"
        ax.text(0.15, fallen + 0.5 * sign * full, word, color=SIGN_COLOURS[sign], fontsize=_TEXT, va="center")
    ax.text(-0.62, fallen + 0.16, "falls", color=_GREY, fontsize=_TEXT, ha="center")
    ax.text(-0.02, fallen - full, "almost flat", color=DARK, fontsize=_SMALL, ha="right", va="center")
    ax.set_ylabel("turns of the\ncontact point", fontsize=_SMALL)
    ax.set_xlabel(r"time ($\sqrt{r/g}$)", fontsize=_SMALL, labelpad=0)
    ax.tick_params(labelsize=_SMALL - 1)
    ax.set_xlim(t[0], t[-1])
    open_frame(ax)


@picture(
    Question.HAPPENS,
    "A disk falls on a table (grey), lies almost flat, and rises again. While it lies, its contact point races "
    "round the rim: from two starts that differ by a hair, blue and vermilion, by the same angle in opposite "
    "directions, so that the disk rises in two different places. Below, the turns of the contact point against "
    "time: both motions are one until the race takes them apart.",
    _SIZE,
    "hero",
)
def hero(figure: Figure, disk: Disk, eta_hat: float | None = None) -> None:
    """A strobe of the disk nearly falling flat on both sides of F, with the turns of its contact point below.

    eta_hat: so near to F that the disk looks flat, so far that its race is seen to take time.
    """
    unit = disk.rate_unit
    shown = film(disk, 0.01 * unit if eta_hat is None else eta_hat, unit, unit, 300)
    if isinstance(figure, Figure):  # its axes have places of their own
        figure.set_layout_engine(None)
    title = "A rolling disk almost falls flat, its contact point races round the rim, and it rises elsewhere"
    figure.text(0.5, 0.945, title, ha="center", fontsize=_LARGE, color=DARK)
    for sign, left in ((1, 0.0), (-1, 0.5)):
        _scene(figure.add_axes((left, 0.31, 0.5, 0.635)), shown, sign)
    figure.text(0.5, 0.885, "two starts, the same but for a hair", ha="center", fontsize=_TEXT, color=DARK)
    _turns(figure.add_axes((0.085, 0.075, 0.895, 0.215)), shown)
