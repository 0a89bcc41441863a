"""The stage of a film: both sides of F on their tables, with the tilt and the turns of the contact point below."""

import math
from collections.abc import Callable

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from explorer.phase.states import Array
from explorer.pictures import solid
from explorer.pictures.film_motions import Film
from explorer.pictures.style import DARK, SIGN_COLOURS, open_frame

SIZE, DPI = (12.8, 7.2), 100
_TEXT, _SMALL, _TINY = 19, 16, 13
_PANEL = (0.497, 0.505)  # shares of the figure
_FAINT = 0.28
_ELEVATION, _AZIMUTH, _DISTANCE = math.radians(35.0), math.radians(220.0), 14.0  # the last in radii
_BEYOND = 1.5  # radii of table beyond the contact points
_ROUND = np.linspace(0.0, 2.0 * math.pi, 25)
_SIDES = {1: "one side of F", -1: "the other side"}


class _Table:
    """One side of F; what moves is painted anew for each row."""

    def __init__(self, ax: Axes, shown: Film, sign: int, limits: tuple[Array, Array]) -> None:
        self.ax, self.shown, self.sign = ax, shown, sign
        self.camera = camera_of(shown)
        middle, radius = ground_of(shown)
        solid.table(ax, self.camera, middle, radius, shown.disk.r)
        self.trail = self.camera.see(shown.contact[sign])
        ax.set(xlim=(limits[0][0], limits[1][0]), ylim=(limits[0][1], limits[1][1]), aspect="equal")
        ax.axis("off")

    def paint(self, row: int) -> None:
        """Add what row `row` shows."""
        pose, colour = self.shown.pose(self.sign, row), SIGN_COLOURS[self.sign]
        solid.shadow(self.ax, self.camera, pose)
        self.ax.plot(*self.trail[: row + 1].T, color=colour, lw=3.0, zorder=1.5, solid_capstyle="round")
        solid.disk(self.ax, self.camera, pose, solid.Looks(width=1.2))
        self.ax.plot(*self.trail[row], "o", color=colour, mec="white", mew=1.2, ms=9, zorder=4)


class _Curve:
    """A quantity of both sides against time, up to now in full colour."""

    def __init__(self, ax: Axes, t: Array, values: dict[int, Array]) -> None:
        self.ax, self.t, self.values = ax, t, values
        for sign, value in values.items():
            ax.plot(t, value, color=SIGN_COLOURS[sign], lw=1.6, alpha=_FAINT)
        ax.set_xlim(t[0], t[-1])
        ax.tick_params(labelsize=_SMALL)
        open_frame(ax)

    def paint(self, row: int) -> None:
        """Add what row `row` shows."""
        for sign, value in self.values.items():
            colour = SIGN_COLOURS[sign]
            self.ax.plot(self.t[: row + 1], value[: row + 1], color=colour, lw=3.0)
            self.ax.plot(self.t[row], value[row], "o", color=colour, mec="white", mew=1.2, ms=9)


class Stage:
    """The figure of a film; `image` draws one row of it."""

    def __init__(self, shown: Film, dpi: int = DPI) -> None:
        self.shown = shown
        self.figure = Figure(figsize=SIZE, dpi=dpi)
        self.canvas = FigureCanvasAgg(self.figure)
        limits = limits_of(shown)
        self.tables = [
            _Table(self.figure.add_axes((left, 0.425, *_PANEL)), shown, sign, limits)
            for left, sign in ((0.0, 1), (1.0 - _PANEL[0], -1))
        ]
        self.curves = self._curves()
        self.clock = self.figure.add_axes((0.0, 0.93, 1.0, 0.07))
        self.clock.axis("off")
        self.canvas.draw()
        self._still = self.canvas.copy_from_bbox(self.figure.bbox)

    def _curves(self) -> list[_Curve]:
        shown, t = self.shown, self.shown.t / self.shown.disk.time_unit
        theta = {sign: 0.5 * math.pi - phi for sign, phi in shown.phi.items()}
        # pi/2 - phi in degrees: a lay reader knows them, and 90 is upright.
        tilt = _Curve(
            self.figure.add_axes((0.085, 0.305, 0.9, 0.115)), t, {s: np.degrees(a) for s, a in theta.items()}
        )
        tilt.ax.set_yscale("log")
        tilt.ax.set_yticks([1.0, 10.0, 90.0], ["1°", "10°", "90°"])
        tilt.ax.minorticks_off()
        tilt.ax.set_xticklabels([])
        tilt.ax.set_ylabel("tilt θ", fontsize=_SMALL)
        turns = _Curve(
            self.figure.add_axes((0.085, 0.09, 0.9, 0.2)),
            t,
            {sign: chi / (2.0 * math.pi) for sign, chi in shown.chi.items()},
        )
        turns.ax.set_ylabel("turns χ/2π", fontsize=_SMALL)
        turns.ax.set_xlabel(r"time ($\sqrt{r/g}$)", fontsize=_SMALL, labelpad=-2)
        self._races(turns)
        return [tilt, turns]

    def _races(self, turns: _Curve) -> None:
        """+-kappa pi beside each jump."""
        half = self.shown.disk.race_limit / (4.0 * math.pi)
        for at in self.shown.flat / self.shown.disk.time_unit:
            for sign, value in turns.values.items():
                middle, colour = float(np.interp(at, turns.t, value)), SIGN_COLOURS[sign]
                x = at + 0.012 * (turns.t[-1] - turns.t[0])
                turns.ax.plot([x, x], [middle - half, middle + half], "_-", color=colour, lw=1.4, ms=9)
                word = rf"${'+' if sign > 0 else '-'}\kappa\pi$"
                turns.ax.text(x, middle, f" {word}", fontsize=_TINY, color=colour, va="center")

    def image(self, row: int) -> Image.Image:
        """Row `row` as a picture."""
        self.canvas.restore_region(self._still)
        parts: list[tuple[Axes, Callable[[int], None]]] = [(self.clock, self._tell)]
        parts += [(one.ax, one.paint) for one in self.tables]
        parts += [(one.ax, one.paint) for one in self.curves]
        for ax, paint in parts:
            there = set(ax.get_children())
            paint(row)
            added: list[Artist] = [artist for artist in ax.get_children() if artist not in there]
            for artist in sorted(added, key=Artist.get_zorder):
                ax.draw_artist(artist)
                artist.remove()
        return Image.fromarray(np.asarray(self.canvas.buffer_rgba())).convert("RGB")

    def _tell(self, row: int) -> None:
        """How slow the clock is, and how far both contact points have run."""
        slowed = float(self.shown.slowed[row])
        pace = "at full speed" if slowed < 1.5 else f"slowed {slowed:.0f} times"
        self.clock.text(0.5, 0.45, pace, ha="center", va="center", fontsize=_TEXT, color=DARK)
        for sign, x, align in ((1, 0.02, "left"), (-1, 0.98, "right")):
            turns = (self.shown.chi[sign][row] - self.shown.chi[sign][0]) / (2.0 * math.pi)
            words = f"{_SIDES[sign]}: {turns:+.2f} turns".replace("-", "−")
            self.clock.text(x, 0.45, words, ha=align, va="center", fontsize=_TEXT, color=SIGN_COLOURS[sign])


def ground_of(shown: Film) -> tuple[Array, float]:
    """The middle (3) and the radius of a table that both motions stay on."""
    every = np.concatenate([*shown.contact.values()])
    middle = 0.5 * (every.min(axis=0) + every.max(axis=0))
    return middle, float(np.linalg.norm(every - middle, axis=1).max()) + _BEYOND * shown.disk.r


def camera_of(shown: Film) -> solid.Camera:
    """The camera that sees both tables from the same place."""
    return solid.Camera(ground_of(shown)[0], _ELEVATION, _AZIMUTH, _DISTANCE * shown.disk.r)


def limits_of(shown: Film) -> tuple[Array, Array]:
    """Lower left and upper right corner of what is seen of both disks, and a little more."""
    camera = camera_of(shown)
    seen = np.concatenate(
        [camera.see(shown.pose(sign, row).rim(_ROUND)) for sign in (1, -1) for row in shown.frames[::3]]
    )
    low, high = seen.min(axis=0), seen.max(axis=0)
    middle, half = 0.5 * (low + high), 0.5 * (high - low) + 0.12 * shown.disk.r
    aspect = _PANEL[1] * SIZE[1] / (_PANEL[0] * SIZE[0])
    half = np.maximum(half, [half[1] / aspect, half[0] * aspect])
    return middle - half, middle + half
