"""The race number of all bodies, and by how much the two limit motions differ per fall."""

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from explorer.motion.passages import passages
from explorer.phase.disk import Disk
from explorer.phase.states import Array
from explorer.pictures.register import Question, picture
from explorer.pictures.style import ACCENT, DARK, SERIES, SIZE, SMALL, dress, legend_below

_NAMED = {2.0: "hoop", 4.0: "uniform"}
_BESIDE = {2.0: (9, 6), 4.0: (9, -14)}  # of them, where no line runs, in points
_MEASURED = (0.5, 2.0, 3.0, 4.0, 8.0, 12.0)  # flat bodies by m r^2/I1, measured whatever else is
# Where races are measured, natural units of eta_hat: the law eta ln(1/eta) leaves 1e-10 rad there.
_NEAR = 1e-12


@picture(
    Question.HOW_FAR,
    "Above, the race number κ against mr²/I₁: near F the contact point races round the rim by κ half turns. "
    "Circles are measured on passages near F and lie on the curve. At the diamonds κ is a whole number. Below, "
    "the angle between the directions in which the two limit motions rise, whole turns left out: at the diamonds "
    "it is zero, and both sides of F have the same limit.",
    (SIZE[0], 7.2),
    "race",
)
def race_numbers(figure: Figure, disk: Disk, most: float = 16.0) -> None:
    """Draw kappa, eq. (7.9), and the gap between the limits, section 7.2, against m r^2/I1 up to `most`.

    Races of the disk and of some other flat bodies are measured; m r^2/I1 is 4 for the uniform disk, 2 for the
    hoop.
    """
    number, gap = figure.subplots(2, 1, sharex=True)
    ratio = np.linspace(0.0, most, 1601)
    matching = np.arange(1.0, math.floor(math.sqrt(1.0 + most)) + 1.0) ** 2 - 1.0
    ratio = np.union1d(ratio, matching)
    measured = race_number_of([*(Disk(I1=1.0 / each, I3=2.0 / each) for each in _MEASURED), disk])
    x = np.array([*_MEASURED, disk.m * disk.r**2 / disk.I1])
    number.plot(ratio, np.sqrt(1.0 + ratio), color=DARK, lw=1.8, label=r"$\kappa = \sqrt{1 + m r^2/I_1}$")
    number.legend(fontsize=SMALL, loc="lower right", frameon=False)
    gap.plot(ratio, gap_of(np.sqrt(1.0 + ratio)), color=DARK, lw=1.8)
    _marks(number, x, measured, matching, lambda kappa: kappa, dict.fromkeys(_NAMED, (11, -5)))
    _marks(gap, x, measured, matching, gap_of, _BESIDE)
    number.set_ylim(0.8, 1.08 * math.sqrt(1.0 + most))
    gap.set_ylim(-0.2, np.pi + 0.45)
    gap.set_yticks([0.0, 0.5 * np.pi, np.pi], ["0", "π/2", "π"])
    legend_below(gap, ncols=2, bbox_to_anchor=(0.5, -0.2))
    dress(
        number, "", r"race number $\kappa$ (half turns)", r"The contact point races by $\pm\kappa\pi$", grid=True
    )
    title = "How far the two limit motions part in a fall, on the circle"
    dress(gap, r"$m r^2/I_1$", "apart after a fall (rad)", title, grid=True)


def gap_of(kappa: Array) -> Array:
    """How far 2 kappa pi is from whole turns: 0 to pi (rad)."""
    return np.asarray(2.0 * np.pi * abs(kappa - np.round(kappa)))


def race_number_of(disks: Sequence[Disk]) -> Array:
    """Race numbers as passages on both sides, near F, have them."""
    found = []
    for disk in disks:
        unit = disk.rate_unit
        angle = passages(disk, unit, [_NEAR * unit, -_NEAR * unit], unit, accuracy=1e-9).race_angle
        found.append((angle[0] - angle[1]) / (2.0 * math.pi))
    return np.array(found)


def _marks(
    ax: Axes,
    x: Array,
    measured: Array,
    matching: Array,
    height: Callable[[Array], Array],
    beside: Mapping[float, tuple[int, int]],
) -> None:
    """Bodies whose limits agree, those measured, and those with a name, which stands `beside` its mark."""
    label = r"$\kappa$ whole: both limits agree"
    ax.plot(matching, height(np.sqrt(1.0 + matching)), "D", color=SERIES[1], ms=7, label=label)
    ax.plot(x, height(measured), "o", mfc="none", mec=DARK, ms=12, label="measured near $F$")
    for ratio, name in _NAMED.items():
        at = ratio, float(height(np.array(math.sqrt(1.0 + ratio))))
        ax.plot(*at, "s", color=ACCENT, ms=6)
        ax.annotate(name, at, xytext=beside[ratio], textcoords="offset points", ha="left", fontsize=SMALL)
