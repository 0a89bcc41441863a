"""What the contact has to bear: normal force and friction over a period."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from explorer.plot.captions import Question, captioned
from explorer.plot.style import DARK, SERIES, SIZE, SMALL, dress, times_of
from explorer.portrait.contact_forces import ContactForces

_STYLES = ("-", (0, (5, 1.5)), (0, (1.5, 1.2)), "-.")
_RUBBER = 1.0  # about the friction of rubber on dry ground
_PULLED = "#F3E6B8"


@captioned(
    Question.REAL,
    "The normal force and the friction that rolling without slipping needs, over one period of motions that come "
    "flatter and flatter. Where the normal force falls below 0 the table would have to pull: a real disk lifts "
    "off there. On the way the friction needed grows beyond all bounds; in the gaps none is enough.",
)
def contact_forces(several: Sequence[ContactForces]) -> Figure:
    """Draw tilt, normal force and needed friction over one period.

    Parameters
    ----------
    several : sequence of ContactForces
        From `explorer.portrait.contact_forces`; four at most.

    Returns
    -------
    Figure

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> from explorer.portrait import contact_forces
    >>> plot.contact_forces(contact_forces(Disk.uniform(), [0.1])).axes[1].get_ylabel()
    'normal force ($m g$)'
    """
    figure = Figure(figsize=(SIZE[0] + 0.8, 7.6), layout="constrained")
    tilt, normal, friction = figure.subplots(3, 1, sharex=True)
    disk = several[0].disk
    for each, colour, style in zip(several, SERIES, _STYLES, strict=False):
        share = f"{100.0 * each.airborne:.0f} %"
        name = rf"$\hat\eta$ = {each.eta_hat / disk.rate_unit:g}: pulled {share} of the time"
        look = {"color": colour, "ls": style, "lw": 1.9}
        middle = each.t / each.t[-1]
        tilt.plot(middle, each.theta, **look, label=name)
        normal.plot(middle, each.normal, **look)
        friction.plot(middle, each.friction, **look)
    tilt.set_yscale("log")
    normal.set_yscale("symlog", linthresh=1.0, linscale=1.2)
    low = 1.3 * min(-0.5, *(float(each.normal.min()) for each in several))
    high = 1.6 * max(float(each.normal.max()) for each in several)
    normal.axhspan(low, 0.0, color=_PULLED, lw=0)
    normal.text(0.99, 0.03, "a real disk lifts off", transform=normal.transAxes, ha="right", fontsize=SMALL)
    normal.axhline(1.0, color=DARK, lw=0.8, ls=":")
    normal.text(0.01, 1.1, "its weight", va="bottom", fontsize=SMALL)
    normal.set_ylim(low, high)
    friction.set_yscale("log")
    friction.axhline(_RUBBER, color=DARK, lw=0.8, ls=":")
    friction.text(0.01, 0.9 * _RUBBER, "of rubber", va="top", fontsize=SMALL)
    most = max(float(np.nanmax(each.friction)) for each in several)
    friction.set_ylim(5e-3, min(most, 1e3))
    friction.set_xlim(0.0, 1.0)
    figure.legend(*tilt.get_legend_handles_labels(), loc="outside lower center", fontsize=SMALL, frameon=False)
    dress(tilt, "", r"tilt $\theta$ from flat (rad)", f"What a period asks of the contact: {disk.name}")
    dress(normal, "", "normal force ($m g$)")
    spans = ", ".join(f"{each.t[-1]:.3g}" for each in several)
    dress(friction, f"time, in periods ({spans} in {times_of(disk)})", "friction needed")
    figure.align_ylabels()
    return figure
