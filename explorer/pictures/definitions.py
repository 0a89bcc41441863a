"""The definition sketch: what the angles, the faces, the lines and the sides of F are called."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from explorer.phase.disk import Disk
from explorer.phase.linear_constants import line_slope
from explorer.phase.states import Array
from explorer.pictures.register import Question, picture
from explorer.pictures.style import DARK, SIGN_COLOURS, SIZE, SMALL, TEXT, dress

_PHI, _CHI, _PSI = math.radians(38.0), math.radians(35.0), math.radians(70.0)
_ELEVATION, _AZIMUTH, _DISTANCE = math.radians(24.0), math.radians(-22.0), 11.0  # of the eye
_ROUND = np.linspace(0.0, 2.0 * math.pi, 97)
_LAMP = np.array([0.35, 0.25])  # how far a shadow falls for each unit of height
_INK, _ANGLES = "#555555", {"phi": "#7B3294", "theta": "#1B7837", "chi": "#8C510A", "psi": "#01665E"}


def _arc(start: Array, end: Array, middle: Array, radius: float) -> Array:
    """Points (n, 3) of the arc about `middle` from one direction to another, the short way."""
    a, b = (way / np.linalg.norm(way) for way in (start, end))
    whole = math.acos(float(np.clip(a @ b, -1.0, 1.0)))
    share = np.linspace(0.0, whole, 40)[:, None]
    turned = (np.sin(whole - share) * a + np.sin(share) * b) / math.sin(whole)
    return np.asarray(middle + radius * turned)


@dataclass(frozen=True)
class Pose:
    """A disk of radius 1 at one moment, eqs (2.33) to (2.35).

    phi, chi: tilt and contact angle (rad). centre: of mass (3).
    """

    phi: float
    chi: float
    centre: Array

    @cached_property
    def normal(self) -> Array:
        """The axis of the body, (3): it points up where phi > 0."""
        q, z = math.cos(self.phi), math.sin(self.phi)
        return np.array([q * math.cos(self.chi), q * math.sin(self.chi), z])

    def rim(self, angles: Array, share: float = 1.0) -> Array:
        """Points of the disk (n, 3) at `share` of its radius, at angles (rad) from the contact point."""
        q, z = math.cos(self.phi), math.sin(self.phi)
        c, s = math.cos(self.chi), math.sin(self.chi)
        down, along = np.array([z * c, z * s, -q]), np.array([-s, c, 0.0])
        return np.asarray(self.centre + share * (np.cos(angles)[:, None] * down + np.sin(angles)[:, None] * along))

    def place(self, angle: float) -> Array:
        """One point of the rim, (3)."""
        return np.asarray(self.rim(np.array([angle]))[0])


class _Sketch:
    """Lines, arrows and words in space, on one Axes, in perspective."""

    def __init__(self, ax: Axes) -> None:
        self.ax = ax
        c, s = math.cos(_ELEVATION), math.sin(_ELEVATION)
        self.back = np.array([c * math.cos(_AZIMUTH), c * math.sin(_AZIMUTH), s])
        self.right = np.array([-math.sin(_AZIMUTH), math.cos(_AZIMUTH), 0.0])
        self.up = np.cross(self.back, self.right)

    def see(self, points: Array) -> Array:
        """Points (..., 3) as they are seen, (..., 2): a length in the middle as it is."""
        from_middle = np.asarray(points, np.float64) - [0.0, 0.0, 0.5]
        nearer = _DISTANCE / (_DISTANCE - from_middle @ self.back)
        return np.stack([nearer * (from_middle @ self.right), nearer * (from_middle @ self.up)], axis=-1)

    def fill(self, points: Array, colour: str, alpha: float, zorder: float, edge: str = "none") -> None:
        self.ax.add_artist(Polygon(self.see(points), fc=colour, ec=edge, alpha=alpha, zorder=zorder))

    def line(self, *points: Array, **style: Any) -> None:
        self.ax.plot(*self.see(np.array(points)).T, **{"color": _INK, "lw": 1.2, "zorder": 6, **style})

    def arrow(self, start: Array, end: Array, colour: str = _INK) -> None:
        a, b = self.see(np.array([start, end]))
        how = {"arrowstyle": "-|>", "color": colour, "lw": 1.6, "shrinkA": 0, "shrinkB": 0}
        self.ax.annotate("", b, a, arrowprops=how, zorder=7)

    def angle(self, name: str, points: Array, vertex: Array, away: float = 1.15, along: float = 0.5) -> None:
        """An arc about a vertex with an arrowhead at its end, and its name beside it, outside or inside."""
        colour = _ANGLES[name]
        self.line(*points, color=colour, lw=2.0, zorder=7)
        self.arrow(points[-3], points[-1], colour)
        at = self.see(vertex + (points[int(along * len(points))] - vertex) * away)
        look: dict[str, Any] = {"color": colour, "fontsize": TEXT + 3, "ha": "center", "va": "center", "zorder": 8}
        self.ax.text(at[0], at[1], rf"$\{name}$".replace("phi", "varphi"), **look)

    def word(self, at: Array, text: str, shift: tuple[float, float] = (0.0, 0.0), **style: Any) -> None:
        x, y = self.see(at) + np.array(shift)
        self.ax.text(x, y, text, **{"fontsize": SMALL, "color": DARK, "zorder": 8, **style})


def _disk(ax: Axes) -> None:
    """The disk on its table with its angles."""
    pose = Pose(_PHI, _CHI, np.array([0.0, 0.0, math.cos(_PHI)]))
    draw = _Sketch(ax)
    up, below = np.array([0.0, 0.0, 1.0]), np.zeros(3)
    rim = pose.rim(_ROUND)
    draw.fill(
        1.95 * np.stack([np.cos(_ROUND), np.sin(_ROUND), 0.0 * _ROUND], axis=-1), "#F0EDE4", 1.0, 0, "#C9C2B0"
    )
    draw.fill(rim - rim[:, 2:] * [*_LAMP, 1.0], "#2A2418", 0.15, 1)
    draw.fill(rim, "#F7E7BE", 0.93, 3, DARK)
    centre, contact, top = pose.centre, pose.place(0.0), pose.place(math.pi)
    draw.line(below, centre + 1.35 * up, ls=(0, (4, 3)))
    draw.arrow(centre, centre + 1.25 * pose.normal)
    draw.line(contact, top)
    draw.line(below, np.array([1.7, 0.0, 0.0]))
    draw.line(below, 1.7 * (contact / np.linalg.norm(contact)))
    draw.angle("phi", _arc(up, top - centre, centre, 0.78), centre, 0.85)
    draw.angle("theta", _arc(up, pose.normal, centre, 0.95), centre)
    turned = np.linspace(0.0, _CHI, 30)
    on_table = 1.3 * np.stack([np.cos(turned), np.sin(turned), 0.0 * turned], axis=-1)
    draw.angle("chi", on_table, below, 1.2)
    draw.angle("psi", pose.rim(np.linspace(-_PSI, 0.0, 40), 0.8), centre, 0.75, 0.68)
    draw.line(centre, pose.place(-_PSI), color=_ANGLES["psi"], lw=1.0)
    for place, size in ((contact, 9), (centre, 5), (pose.place(-_PSI), 5)):
        ax.plot(*draw.see(place), "o", color=DARK, mec="white", ms=size, zorder=9)
    draw.word(contact, "contact point", (0.14, 0.06))
    draw.word(centre + 1.25 * pose.normal, r"axis $e_3$; spin about it: $\sigma_4$", (0.06, 0.02))
    draw.word(pose.place(-_PSI), "where it touched\nat the start", (-0.12, -0.08), ha="right", va="center")
    draw.word(centre + 1.4 * up, "vertical", (0.0, 0.04), ha="center")
    words = r"$\sigma_3 = \dot\chi\,\cos^2\varphi$"
    ax.text(1.3, -1.5, words, color=_ANGLES["chi"], fontsize=TEXT)
    ax.set(xlim=(-2.05, 2.35), ylim=(-1.6, 1.95), aspect="equal")
    ax.set_title(r"Flat is $\varphi = \pm\pi/2$, on face $\pm 1$; $\theta = \pi/2 - \varphi$", fontsize=TEXT)
    ax.axis("off")


def _plane(ax: Axes, disk: Disk) -> None:
    """The constants of motion: the line on which face +1 comes flat, and both sides of it."""
    steep, edge = line_slope(disk), 1.0
    bars = np.array([-edge, edge])
    for sign, far in ((1, -1.0), (-1, 1.0)):
        ax.fill_between(bars, steep * bars, [far, far], color=SIGN_COLOURS[sign], alpha=0.14, lw=0)
    ax.plot(bars, steep * bars, color=DARK, lw=2.4)
    ax.plot(bars, -steep * bars, color=DARK, lw=1.0, ls=(0, (5, 3)))
    ax.text(
        0.62,
        0.62 * steep + 0.06,
        r"$l_+$: falls on face $+1$",
        fontsize=SMALL,
        rotation=34,
        ha="center",
        rotation_mode="anchor",
    )
    ax.text(
        -0.62,
        0.62 * steep + 0.06,
        r"$l_-$: on face $-1$",
        fontsize=SMALL,
        rotation=-34,
        ha="center",
        rotation_mode="anchor",
    )
    bar = 0.55
    low = steep * bar - 0.42
    how = {"arrowstyle": "<|-|>", "color": DARK, "lw": 1.2, "shrinkA": 0, "shrinkB": 4}
    ax.annotate("", (bar, low), (bar, steep * bar), arrowprops=how)
    ax.plot(bar, low, "o", color=SIGN_COLOURS[1], mec=DARK, ms=9)
    ax.text(bar + 0.04, steep * bar - 0.21, r"$\hat\eta$", fontsize=TEXT + 3)
    ax.text(bar + 0.06, low + 0.02, "a motion", fontsize=SMALL, va="center")
    ax.text(
        -0.35, -0.82, r"side $\eta > 0$: races by $+\kappa\pi$", color=SIGN_COLOURS[1], fontsize=TEXT, ha="center"
    )
    ax.text(
        0.0, 0.82, r"side $\eta < 0$: races by $-\kappa\pi$", color=SIGN_COLOURS[-1], fontsize=TEXT, ha="center"
    )
    ax.set(xlim=(-edge, edge), ylim=(-edge, edge), aspect="equal")
    ax.set_xticks([0.0])
    ax.set_yticks([0.0])
    words = (
        r"$\bar\sigma_3$: $\sigma_3$ at the vertical ($\sqrt{g/r}$)",
        r"$\bar\sigma_4$: $\sigma_4$ at the vertical ($\sqrt{g/r}$)",
    )
    dress(ax, *words, "The line of the falls parts the sides of $F$")


@picture(
    Question.HAPPENS,
    "What the angles and constants are called. Above, the disk on its table: φ is the angle of its plane to the "
    "vertical, θ that of its axis, χ the direction in which the contact point lies, ψ how far it has moved along "
    "the rim. Below, the plane of the constants of motion: the disk can fall flat on one of its faces, called "
    "+1, only if its constants lie on the line l₊. The states that fall make up the falling set F, and the sign "
    "of the distance η̂ from this line says on which side of F a motion is.",
    (SIZE[0], 8.6),
    "definitions",
)
def definitions(figure: Figure, disk: Disk) -> None:
    """Draw the disk with its angles, eqs (2.14), (2.21), (2.30), and the plane of its constants, eq. (6.2)."""
    above, below = figure.subplots(2, 1)
    _disk(above)
    _plane(below, disk)
