"""What is left of the constants of motion, and of the angle, after thousands of passages."""

import math

from matplotlib.figure import Figure

from explorer.plot.captions import Question, captioned
from explorer.plot.style import MARKERS, SERIES, SIZE, SMALL, dress
from explorer.portrait.conservation import TOLERANCES, Conservation


@captioned(
    Question.HOW_GOOD,
    "Errors of one motion over thousands of passages near flat. Above: the worst of energy, σ̄₃ and η̂. It stays "
    "below a bound whatever their number, while that of a general solver grows with every passage. Below: the "
    "contact angle against whole periods by quadrature; its error grows in proportion to the number of passages, "
    "that of a general solver faster.",
)
def conservation(found: Conservation) -> Figure:
    """Draw errors of the constants and of the contact angle against the number of passages.

    Parameters
    ----------
    found : Conservation
        From `explorer.portrait.conservation`.

    Returns
    -------
    Figure

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> from explorer.portrait import conservation
    >>> figure = plot.conservation(conservation(Disk.uniform(), most=20, most_by_solver=2))
    >>> [ax.get_yscale() for ax in figure.axes]
    ['log', 'log']
    """
    figure = Figure(figsize=(SIZE[0], 7.0), layout="constrained")
    constants, angle = figure.subplots(2, 1, sharex=True)
    named = {f"accuracy {_power(accuracy)}": each for accuracy, each in found.ours.items()}
    every = {**named, f"SciPy DOP853, rtol {_power(TOLERANCES['rtol'])}": found.solver}
    for (name, each), colour, mark in zip(every.items(), SERIES, MARKERS, strict=False):
        broken = each is found.solver
        look = {"color": colour, "marker": mark, "ls": "--" if broken else "-", "lw": 1.5, "ms": 5}
        # Ours have no trend that a line could show; lines would hide the points of others
        constants.plot(each.passages, each.constants, **(look if broken else look | {"ls": ""}))
        angle.plot(each.passages, each.chi, **look, label=name)
    for ax in (constants, angle):
        ax.set_xscale("log")
        ax.set_yscale("log")
    handles, names = angle.get_legend_handles_labels()
    figure.legend(handles, names, loc="outside lower center", ncols=2, fontsize=SMALL, frameon=False)
    eta_hat = found.eta_hat / found.disk.rate_unit
    dress(constants, "", "worst of the constants\n(relative)", rf"{found.disk.name}, $\hat\eta$ = {eta_hat:g}")
    dress(angle, "passages near flat", r"contact angle $\chi$ (rad)")
    figure.align_ylabels()
    return figure


def _power(value: float) -> str:
    return f"$10^{{{round(math.log10(value))}}}$"
