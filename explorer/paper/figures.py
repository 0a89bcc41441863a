"""The paper's nine figures, made anew: angle of contact, axis, centre of mass and contact point near F.

`figure(number)` gives one; `FIGURES` says what each shows, with a caption that a page can print. All start
upright with sigma2 = sigma3 = 1 and eta_hat_+ = +-0.01 (section 7.2 of the paper), in units m = r = g = 1. Each
panel carries, as a thin dotted line, the one-sided limit of the same start: the motion with eta_+ = 0, continued
through its impacts by the rule of section 7.3.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import MultipleLocator

from explorer.errors import InputError, positive
from explorer.motion.both_sides import BothSides, both_sides
from explorer.motion.limit_motions import limit_motion
from explorer.paper.statement import ETA_HAT
from explorer.phase.coordinates import constants_to_states
from explorer.phase.disk import Disk
from explorer.phase.states import Array, States
from explorer.pictures.one_sided import angle_of_contact, flattest, path_on_table
from explorer.pictures.register import Caption, Question, add_caption
from explorer.pictures.style import DARK, SIGN_COLOURS, SIZE, TEXT, arrow, dress, legend_of_all, number, times_of

SIGMA3 = PHIDOT = 1.0
CHI0 = 0.5  # rad; not in the paper, see `INFERRED`
ZOOM, _TICKS = (-0.15, 0.2), (-0.1, 0.0, 0.1, 0.2)  # both axes, as in Fig. 3
_BODY_WORDS = {"uniform": "the uniform disk", "hoop": "the hoop"}

CHI0_FITS = (0.41, 0.57)  # rad: what the ticks of Fig. 7 leave, to the last digit

INFERRED = (
    f"The paper does not give χ(0), the direction of the contact point at the start. Here it is {CHI0:g} rad; "
    f"the ticks of the paper's Fig. 7 allow {CHI0_FITS[0]:g} to {CHI0_FITS[1]:g}.",
    "Fig. 1: the length is described in the paper as somewhat more than three periods.",
    "Figs. 2, 4, 5: the right part shows the same window as Fig. 3, whose ticks are known.",
    "Figs. 6 to 9: the length, 3 periods, is inferred from the ticks of Fig. 7.",
)


def start(disk: Disk, eta_hat: float) -> States:
    """The paper's initial state: upright, sigma2 = sigma3 = 1, sigma4 = (I1 r'(0)/(I3 r(0))) - eta_hat."""
    return constants_to_states(disk, SIGMA3, eta_hat, PHIDOT)


def period_of(disk: Disk) -> float:
    """The period of the motion on F, to which those beside it tend."""
    return float(limit_motion(start(disk, 0.0)).period)


def curves(disk: Disk, eta_hat: float, turns: float) -> BothSides:
    """Both motions and both limits over `turns` periods."""
    return both_sides(start(disk, 0.0), eta_hat, turns * period_of(disk))


def axis(phi: Array, chi: Array) -> Array:
    """The horizontal part of v = A e3, eq. (2.30), (n, 2)."""
    turned = chi + CHI0
    return np.asarray(np.cos(phi)[:, None] * np.stack([np.cos(turned), np.sin(turned)], axis=1))


def _chi(ax: Axes, both: BothSides, side: int) -> None:
    """chi(t), the panels of Fig. 1."""
    angle_of_contact(ax, both, side, CHI0)
    period = period_of(both.disk)
    look: dict[str, Any] = {"color": DARK, "lw": 1.2, "transform": ax.get_xaxis_transform()}
    ax.vlines(np.arange(period, both.t[-1], period), 0.0, 0.05, label="whole periods", **look)
    dress(ax, f"$t$ ({times_of(both.disk)})", r"$\chi$ (rad)")


def _axis(ax: Axes, both: BothSides, side: int, zoom: bool) -> None:
    """Horizontal projection of the axis, the panels of Figs. 2 to 5; `zoom`: near the origin."""
    motion, there, colour = both.motions[side], both.limits[side], SIGN_COLOURS[side]
    path, upper = axis(motion["phi"], motion["chi"]), motion["phi"] >= 0.0
    for seen, style, label in ((upper, "-", r"$v_3 \geq 0$"), (~upper, "--", r"$v_3 < 0$")):
        ax.plot(*np.where(seen[:, None], path, np.nan).T, color=colour, lw=1.5, ls=style, label=label)
    ax.plot(*axis(there.phi, there.chi).T, color=DARK, lw=0.9, ls=":", label="limit")
    leaving = both.t > both.t[flattest(both, side)[0]]
    for tilt in (0.09,) if zoom else (0.4, 0.8):
        arrow(ax, path, int(np.flatnonzero(leaving & (np.cos(motion["phi"]) > tilt))[0]), colour)
    if zoom:
        ax.set(xlim=ZOOM, ylim=ZOOM, xticks=_TICKS, yticks=_TICKS)
    else:
        turn = np.linspace(0.0, 2.0 * np.pi, 400)
        ax.plot(np.cos(turn), np.sin(turn), color=DARK, lw=0.8, label="equator: upright")
        ax.plot(*path[0], marker="o", color=DARK, ms=6, label="start", ls="")
        after: dict[str, Any] = {"marker": "s", "mfc": "white", "color": DARK, "ms": 6, "ls": "", "zorder": 5}
        # Upright again, upwards
        again = np.flatnonzero((motion["phi"][:-1] < 0.0) & upper[1:])[:1]
        ax.plot(*path[again].T, label="after one period", **after)
        ax.add_patch(Rectangle((ZOOM[0], ZOOM[0]), np.ptp(ZOOM), np.ptp(ZOOM), fill=False, ec=DARK, lw=0.8))
        ax.set(xlim=(-1.08, 1.08), ylim=(-1.08, 1.08))
    ax.set_aspect("equal")
    dress(ax, r"$\cos\varphi\,\cos\chi$", r"$\cos\varphi\,\sin\chi$")


def _path(ax: Axes, both: BothSides, side: int, what: str) -> None:
    """Path on the floor of the centre's shadow (Figs. 6, 7) or of the contact point (8, 9)."""
    path_on_table(ax, both, side, what, CHI0)
    path = np.asarray(ax.lines[0].get_xydata())[flattest(both, side)]
    rings: dict[str, Any] = {"marker": "o", "mfc": "white", "color": DARK, "ms": 5, "ls": "", "zorder": 5}
    ax.plot(*path.T, label="flattest moments", **rings)
    for both_ways in (ax.xaxis, ax.yaxis):
        both_ways.set_major_locator(MultipleLocator(1.0))
    dress(ax, "$x$ ($r$)", "$y$ ($r$)")


@dataclass(frozen=True)
class PaperFigure:
    """What a figure of the paper shows: the body, the length in periods, what is drawn of it, and the words.

    kind: "chi", "axis", "path" or "contact". sides: of its panels; the second one of an axis is the middle alone.
    shows: the caption of the paper's own body and eta_hat, without what is said of all figures.
    """

    disk: Disk
    turns: float
    kind: str
    sides: tuple[int, int]
    shows: str

    def caption(self, figure: int, disk: Disk, eta_hat: float) -> str:
        """What is seen and what to look at, for a body and a size of eta_hat."""
        text = self.shows.format(
            body=_BODY_WORDS.get(disk.name, f"the disk {disk.name}"),
            kappa=f"{disk.kappa:.4g}",
            turns=f"{self.turns:g}",
            eta=number(eta_hat),
            signed=number(self.sides[0] * eta_hat),
        )
        same = math.isclose(disk.body.I1, self.disk.body.I1) and math.isclose(disk.body.I3, self.disk.body.I3)
        own = same and eta_hat == ETA_HAT
        text = f"{'' if own else 'As '}Fig. {figure}. {text}"
        if own and figure >= 8:
            text += " The paper prints 0.01 for both panels; in fact the panel on the right has −0.01."
        return f"{text} Dotted: the limit motion of the same side of F, from the same start."


_OF_SIDES = "with η̂₊ = {eta} on the left and −{eta} on the right, on one scale"
_CHI = (
    "The angle χ(t) of {body} over {turns} periods, " + _OF_SIDES + ". Each time the disk nearly falls, χ jumps "
    "by κπ (κ = {kappa}): up on one side of F, down on the other."
)
_AXIS = (
    "The axis of {body}, a unit vector that the paper calls v, projected onto the table, over {turns} periods, "
    "with η̂₊ = {signed}. Left: the whole path. Right: its middle, enlarged. The path starts on the circle of "
    "radius 1, where the disk is upright, and comes in to the origin, where it is nearly flat. There it turns by "
    "κπ (κ = {kappa}) about the origin, and then it leaves. It is dashed where v₃, the vertical component, is "
    "negative."
)
_CENTRE = (
    "The path of the centre of mass of {body} seen from above, over {turns} periods, " + _OF_SIDES + ". At the "
    "rings the disk is flattest, and the centre nearly stands still. On the two sides of F it leaves in different "
    "directions."
)
_CONTACT = (
    "The path of the contact point of {body} seen from above, over {turns} periods, " + _OF_SIDES + ". Rings mark "
    "where the disk is flattest. There the contact point runs round a circle as large as the rim: one way on one "
    "side of F, the other way on the other side."
)
_TITLES = {
    "chi": r"In each near-fall $\chi$ jumps by $\kappa\pi$, up or down",
    "axis": r"Nearly flat, the axis turns round the vertical by $\kappa\pi$",
    "path": "The centre leaves a near-fall differently on the two sides of $F$",
    "contact": "On the two sides of $F$ the contact point races opposite ways",
}
_UNIFORM, _HOOP = Disk.uniform(), Disk.hoop()
FIGURES = {
    1: PaperFigure(_UNIFORM, 3.2, "chi", (1, -1), _CHI),
    2: PaperFigure(_UNIFORM, 1.4, "axis", (1, 1), _AXIS),
    3: PaperFigure(_UNIFORM, 1.4, "axis", (-1, -1), _AXIS),
    4: PaperFigure(_HOOP, 1.4, "axis", (1, 1), _AXIS),
    5: PaperFigure(_HOOP, 1.4, "axis", (-1, -1), _AXIS),
    6: PaperFigure(_UNIFORM, 3.0, "path", (1, -1), _CENTRE),
    7: PaperFigure(_HOOP, 3.0, "path", (1, -1), _CENTRE),
    8: PaperFigure(_UNIFORM, 3.0, "contact", (1, -1), _CONTACT),
    9: PaperFigure(_HOOP, 3.0, "contact", (1, -1), _CONTACT),
}


def figure(which: int, disk: Disk | None = None, eta_hat: float = ETA_HAT) -> Figure:
    """A figure of the paper by its number, 1 to 9, also of another body or at another distance from F.

    eta_hat: its size, in sqrt(g/r); which sides are shown is the figure's. Raises InputError.
    """
    if which not in FIGURES:
        raise InputError(f"figure = {which!r} is not one of the paper's; give a number from 1 to {len(FIGURES)}")
    plan = FIGURES[which]
    body = plan.disk
    if disk is not None:
        unit = disk.m * disk.r**2  # the figures are in units m = r = g = 1
        body = Disk(I1=disk.I1 / unit, I3=disk.I3 / unit, name=disk.name)
    both = curves(body, positive("eta_hat", eta_hat), plan.turns)
    made = Figure(figsize=SIZE, layout="compressed")
    together = plan.kind != "axis"
    panels = made.subplots(1, 2, sharex=together, sharey=together)
    for place, (ax, side) in enumerate(zip(panels, plan.sides, strict=True)):
        title = rf"{body.name}, $\hat\eta_+$ = {number(side * eta_hat, '+g')}"
        if plan.kind == "chi":
            _chi(ax, both, side)
        elif plan.kind == "axis":
            _axis(ax, both, side, zoom=place == 1)
            title = title if place == 0 else "the middle, enlarged"
        else:
            _path(ax, both, side, plan.kind)
        ax.set_title(title, fontsize=TEXT, color=SIGN_COLOURS[side])
        if together:
            ax.lines[0].set_label("_side")  # the title says it
    if plan.kind != "chi":  # of equal scales: no taller than the panels need
        made.set_figheight(1.7 + 2.2 * np.ptp(panels[0].get_ylim()) / np.ptp(panels[0].get_xlim()))
    made.suptitle(_TITLES[plan.kind], fontsize=TEXT)
    legend_of_all(made, panels, ncols=3)
    add_caption(made, Caption(Question.PAPER, plan.caption(which, body, eta_hat)))
    return made
