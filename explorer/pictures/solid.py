"""A table and a disk with thickness, drawn in perspective on plain Axes: painted from behind to the front."""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.patches import Polygon

from explorer.phase.states import Array
from explorer.pictures.pose import Pose
from explorer.pictures.style import DARK

TABLE, LINES = "#F0EDE4", "#DDD8CA"
# The faces of the disk: the one that lies on the table at face +1, and the other.
UPPER, LOWER, EDGE = "#F7E7BE", "#6B6F7A", "#B8AE96"
_HALF_THICKNESS = 0.045  # radii
_ROUND = np.linspace(0.0, 2.0 * math.pi, 97)
_WALL = 64  # pieces of the edge, each with its own light
# Directions to the lamp, a small area: where all shadows of the disk overlap it is darkest.
_LAMP = np.array([0.35, 0.25, 1.0])
_LAMP_RADIUS, _LAMP_POINTS, _SHADE = 0.16, 7, 0.055
_LIGHT = np.array([0.30, 0.10, 0.95]) / math.hypot(0.30, 0.10, 0.95)


@dataclass(frozen=True)
class Camera:
    """Where the eye is and what it looks at; `see` gives the picture.

    target: point (3) in the middle of the picture. elevation, azimuth: of the eye as seen from there (rad).
    distance: between both, in the unit of length.
    """

    target: Array
    elevation: float = math.radians(26.0)
    azimuth: float = math.radians(-60.0)
    distance: float = 9.0

    @property
    def eye(self) -> Array:
        """Where it is, (3)."""
        c, s = math.cos(self.elevation), math.sin(self.elevation)
        way = np.array([c * math.cos(self.azimuth), c * math.sin(self.azimuth), s])
        return np.asarray(self.target + self.distance * way)

    def see(self, points: Array) -> Array:
        """Points (..., 3) in perspective: (..., 2), a length at the target as it is."""
        back = (self.eye - self.target) / self.distance
        right = np.array([-math.sin(self.azimuth), math.cos(self.azimuth), 0.0])
        up = np.cross(back, right)
        from_target = np.asarray(points, np.float64) - self.target
        nearer = self.distance / (self.distance - from_target @ back)
        return np.stack([nearer * (from_target @ right), nearer * (from_target @ up)], axis=-1)


class Looks(NamedTuple):
    """How a disk is painted. alpha: of all of it. width: of its lines, relative. marked: with ring and mark."""

    alpha: float = 1.0
    upper: str = UPPER
    lower: str = LOWER
    outline: str = DARK
    width: float = 1.0
    marked: bool = True


def table(ax: Axes, camera: Camera, centre: Array, radius: float, step: float = 1.0) -> None:
    """A round table with lines on it, `step` apart, all below whatever is drawn later."""
    x, y = centre[0], centre[1]
    rim = np.stack([x + radius * np.cos(_ROUND), y + radius * np.sin(_ROUND), 0.0 * _ROUND], axis=-1)
    below = rim - np.array([0.0, 0.0, 0.05 * radius])
    ax.add_patch(Polygon(camera.see(below), fc="#CFC8B6", ec="none", zorder=0))
    ax.add_patch(Polygon(camera.see(rim), fc=TABLE, ec="#C9C2B0", lw=0.8, zorder=0.1))
    for at in np.arange(math.ceil(-radius / step), radius / step) * step:
        half = math.sqrt(max(radius**2 - at**2, 0.0)) * 0.995
        for ends in ([[x + at, y - half], [x + at, y + half]], [[x - half, y + at], [x + half, y + at]]):
            ax.plot(*camera.see(np.column_stack([ends, [0.0, 0.0]])).T, color=LINES, lw=0.7, zorder=0.2)


def shadow(ax: Axes, camera: Camera, pose: Pose, strength: float = 1.0) -> None:
    """The soft shadow of the disk on the table: it meets the disk at the contact."""
    rim = pose.rim(_ROUND)
    for k in range(_LAMP_POINTS + 1):
        angle, size = 2.0 * math.pi * k / _LAMP_POINTS, _LAMP_RADIUS * (k < _LAMP_POINTS)
        lamp = _LAMP + size * np.array([math.cos(angle), math.sin(angle), 0.0])
        on_table = rim - rim[:, 2:] * (lamp / lamp[2])
        ax.add_artist(Polygon(camera.see(on_table), fc="#2A2418", ec="none", alpha=_SHADE * strength, zorder=1))


def disk(ax: Axes, camera: Camera, pose: Pose, looks: Looks | None = None, zorder: float = 3.0) -> None:
    """The disk with its edge, the face that is seen, and a mark on it that turns with the body."""
    from scipy.spatial import ConvexHull

    looks = looks or Looks()
    half = _HALF_THICKNESS * pose.r
    lift = np.array([0.0, 0.0, half * abs(math.sin(pose.phi))])  # its lower edge stays on the table
    normal = pose.normal
    toward = float((camera.eye - pose.centre) @ normal)
    top, bottom = (pose.rim(_ROUND) + lift + s * half * normal for s in (1.0, -1.0))
    both = np.concatenate([camera.see(top), camera.see(bottom)])
    outline = both[ConvexHull(both).vertices]
    style: dict[str, Any] = {"alpha": looks.alpha, "zorder": zorder}
    ax.add_artist(Polygon(outline, fc=EDGE, ec=looks.outline, lw=2.0 * looks.width, joinstyle="round", **style))
    ax.add_artist(_wall(camera, pose, lift, looks.alpha, zorder))
    face = 1 if toward > 0.0 else -1
    seen = top if face > 0 else bottom
    light = 0.80 + 0.20 * max(0.0, face * float(normal @ _LIGHT))
    colour = tuple(light * np.array(to_rgb(looks.upper if face > 0 else looks.lower)))
    ax.add_artist(Polygon(camera.see(seen), fc=colour, ec=looks.outline, lw=0.6 * looks.width, **style))
    if looks.marked:
        _pattern(ax, camera, pose, lift + face * half * normal, face, looks, zorder)


def _wall(camera: Camera, pose: Pose, lift: Array, alpha: float, zorder: float) -> PolyCollection:
    """The part of the edge that is seen, in pieces with their light."""
    half, normal = _HALF_THICKNESS * pose.r, pose.normal
    angles = np.linspace(0.0, 2.0 * math.pi, _WALL + 1)
    rim = pose.rim(angles) + lift
    out = (rim[:-1] + rim[1:]) / 2.0 - (pose.centre + lift)
    out /= np.linalg.norm(out, axis=1)[:, None]
    seen = np.einsum("ij,ij->i", camera.eye - rim[:-1], out) > 0.0
    high, low = camera.see(rim + half * normal), camera.see(rim - half * normal)
    pieces = np.stack([high[:-1], high[1:], low[1:], low[:-1]], axis=1)[seen]
    light = 0.62 + 0.38 * np.clip(out[seen] @ _LIGHT, 0.0, 1.0)
    colours = light[:, None] * np.array(to_rgb(EDGE))
    return PolyCollection(list(pieces), fc=colours, ec=colours, lw=0.5, alpha=alpha, zorder=zorder)


def _pattern(ax: Axes, camera: Camera, pose: Pose, shift: Array, face: int, looks: Looks, zorder: float) -> None:
    """A ring and a mark near the rim, on the face that is seen."""
    ink = "#8A7B55" if face > 0 else "#C9CCD4"
    ring = pose.rim(_ROUND, 0.86) + shift
    ax.plot(*camera.see(ring).T, color=ink, lw=0.9 * looks.width, alpha=looks.alpha, zorder=zorder)
    at = pose.mark_angle
    mark = pose.place(at, 0.58) + pose.r * 0.17 * pose.directions(_ROUND) + shift
    ax.add_artist(
        Polygon(camera.see(mark), fc=DARK if face > 0 else "white", ec="none", alpha=looks.alpha, zorder=zorder)
    )
    spoke = np.stack([pose.place(at, 0.0), pose.place(at, 0.42)]) + shift
    ax.plot(*camera.see(spoke).T, color=ink, lw=1.4 * looks.width, alpha=looks.alpha, zorder=zorder)


def frame(ax: Axes, points: Array, margin: float = 0.1) -> None:
    """Show all of the seen `points` (n, 2), lengths equal both ways, without axes."""
    low, high = points.min(axis=0) - margin, points.max(axis=0) + margin
    ax.set_xlim(low[0], high[0])
    ax.set_ylim(low[1], high[1])
    ax.set_aspect("equal", adjustable="datalim")
    ax.axis("off")
