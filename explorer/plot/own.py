"""Pictures of a user's own numbers: an observable over states or over a plane, race angles in bins of choice."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from explorer.errors import InputError, one_of, whole
from explorer.motion.scan import Scan
from explorer.phase.arguments import column, read_range
from explorer.phase.columns import COLUMNS
from explorer.phase.disk import Disk
from explorer.phase.states import COORDINATES, Array
from explorer.plot.captions import Question, captioned
from explorer.plot.style import (
    DARK,
    MINUS,
    PLUS,
    SMALL,
    TEXT,
    axes_or_new,
    coordinate_label,
    dress,
    legend,
    say_if_nothing,
    styled,
    values_label,
)
from explorer.portrait.slices import SliceMap

_DEFAULT_BINS, _MOST_BINS = 200, 1_000_000
_FEW = 50  # states that are marked one by one
_COLOURS = "viridis"


@captioned(
    Question.FROM_WHERE,
    "An observable of the user's own over a plane of the phase space, or over the states that were scanned. "
    "On a plane the broken lines are the falling set F as the algebra gives it.",
)
def observable_map(found: SliceMap | Scan, name: str | None = None, ax: Axes | None = None, **look: Any) -> Axes:
    """Draw an observable: in colour over a plane or a cloud of states, as a line over states in a row.

    Parameters
    ----------
    found : SliceMap or Scan
        From `explorer.slice_map` or `explorer.scan`.
    name : str, optional
        Which of its observables; the first by default.
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib: to pcolormesh for a plane, to scatter for a cloud, to plot for a line.

    Returns
    -------
    Axes
        The axes are the coordinates that vary, in the units of the disk.

    Raises
    ------
    InputError
        Where there is no observable of that name with one number for each state.

    Examples
    --------
    >>> import explorer as ex
    >>> found = ex.slice_map(ex.Disk.uniform(), "phi=0,phidot=1,sigma3_bar=-2:2,eta_hat=-1:1", "race_angle", 9)
    >>> ex.plot.observable_map(found, cmap="coolwarm").get_ylabel()
    '$\\\\hat\\\\eta$ ($\\\\sqrt{g/r}$)'
    """
    name = next(iter(found)) if name is None else one_of("name", name, list(found))
    values = found[name]
    if values.shape != found.shape or values.dtype.kind not in "fiub":
        raise InputError(f"name = {name!r}: has not one number for each state; choose another observable")
    if not values.size:
        raise InputError("found: has no states; give some that were scanned")
    ax = axes_or_new(ax)
    numbers = values.astype(np.float64)
    say_if_nothing(ax, numbers, f"{_title(name)} is not known of any state")
    if isinstance(found, SliceMap):
        return _plane(ax, found, name, numbers, look)
    return _states(ax, found, name, numbers, look)


def _plane(ax: Axes, cut: SliceMap, name: str, values: Array, look: dict[str, Any]) -> Axes:
    drawn = ax.pcolormesh(cut.x, cut.y, values, **styled(look, cmap=_COLOURS, rasterized=True))
    _bar(ax, drawn, name)
    for distance, could in (
        (cut.falls.distance_plus, cut.falls.could_fall_plus),
        (cut.falls.distance_minus, cut.falls.could_fall_minus),
    ):
        kept = np.where(could, distance, np.nan)
        if np.isfinite(kept).any() and np.nanmin(kept) < 0.0 < np.nanmax(kept):
            ax.contour(cut.x, cut.y, kept, [0.0], colors=DARK, linewidths=1.0, linestyles="--")
    first, second = (coordinate_label(each, cut.disk) for each in cut.slice.axes)
    return dress(ax, first, second, f"{_title(name)}: {values_label(cut.slice.fixed)}")


def _states(ax: Axes, found: Scan, name: str, values: Array, look: dict[str, Any]) -> Axes:
    disk = found.states.disk
    columns = {each: np.ravel(getattr(found.states, each)) for each in COORDINATES}
    free = [each for each, column in columns.items() if np.unique(column[np.isfinite(column)]).size > 1]
    if len(free) < 2:
        x = free[0] if free else COORDINATES[0]
        usual = {"color": DARK, "marker": "." if values.size < _FEW else ""}
        ax.plot(columns[x], values.ravel(), **styled(look, **usual))
        return dress(ax, coordinate_label(x, disk), _unit_of(name))
    first, second = free[:2]
    drawn = ax.scatter(columns[first], columns[second], **styled(look, c=values.ravel(), cmap=_COLOURS, s=6))
    _bar(ax, drawn, name)
    return dress(ax, coordinate_label(first, disk), coordinate_label(second, disk), _title(name))


def _bar(ax: Axes, drawn: Any, name: str) -> None:
    bar = ax.figure.colorbar(drawn, ax=ax)
    bar.set_label(_unit_of(name), fontsize=TEXT)
    bar.ax.tick_params(labelsize=SMALL)


def _title(name: str) -> str:
    return name.replace("_", " ")


def _unit_of(name: str) -> str:
    unit = COLUMNS[name].unit if name in COLUMNS else ""
    return f"{_title(name)} ({unit})" if unit else _title(name)


@captioned(
    Question.HOW_FAR,
    "Race angles by the side of the falling set, in bins of the user's choice. The dashed lines are ±κπ, to "
    "which they tend as the motion comes nearer to F.",
)
def race_angle_histogram(
    found: Any,
    bins: Any = _DEFAULT_BINS,
    range: tuple[float, float] | None = None,
    disk: Disk | None = None,
    ax: Axes | None = None,
    **look: Any,
) -> Axes:
    """Draw race angles, of both sides of F, in bins of choice.

    Parameters
    ----------
    found : Bounces, Passages, DataFrame or mapping
        Something with `race_angle` (rad) and with `side` or `eta_hat`.
    bins : int, str or array
        As numpy.histogram takes them; 200 by default.
    range : pair of floats, optional
        Lowest and highest race angle (rad); by default that of the data.
    disk : Disk, optional
        Whose limits +-kappa pi are drawn.
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib's stairs, `fill=False` for instance.

    Returns
    -------
    Axes
        Race angle (rad) and bounces per bin, logarithmic; eta > 0 in blue, eta < 0 in vermilion.

    Raises
    ------
    InputError
        Where there are no race angles, or no side of them.

    Examples
    --------
    >>> import explorer as ex
    >>> coin = ex.Disk.uniform()
    >>> found = ex.bounces(ex.constants_to_states(coin, 1.0, [1e-3, -1e-3], 1.0))
    >>> ax = ex.plot.race_angle_histogram(found, bins=50, range=(-8, 8), disk=coin)
    >>> ax.get_ylabel()
    'bounces per bin'
    """
    race, side = _races(found)
    edges = _edges(race, bins, None if range is None else read_range("range", range))
    ax = axes_or_new(ax)
    for sign, colour, label in ((1, PLUS, r"$\eta > 0$"), (-1, MINUS, r"$\eta < 0$")):
        values = race[side == sign]
        if values.size:
            style = styled(look, fill=True, color=colour, label=f"{label}: {values.size:,}")
            ax.stairs(np.histogram(values, edges)[0], edges, **style)
    if disk is not None:
        for sign in (1, -1):
            ax.axvline(
                sign * disk.race_limit, color=DARK, lw=1, ls="--", label=r"$\pm\kappa\pi$" if sign > 0 else None
            )
    ax.set_yscale("log")
    legend(ax)
    return dress(ax, r"race angle $\Delta\chi$ - fall angle (rad)", "bounces per bin")


def _edges(race: Array, bins: Any, reach: tuple[float, float] | None) -> Array:
    """The edges of bins that are given as a number, as edges, or by the name of a rule of numpy."""
    if not isinstance(bins, str):
        several = column("bins", bins)
        bins = several if several.ndim else whole("bins", bins, 1, _MOST_BINS)
    edges: Array = np.histogram_bin_edges(race, bins, reach)
    if not np.histogram(race, edges)[0].any():
        ends = f"{race.min():g} to {race.max():g} rad"
        raise InputError(f"range: holds none of the race angles, which go from {ends}; give a wider one")
    return edges


def _races(found: Any) -> tuple[Array, Array]:
    """The race angles that are known, and their sides. Raises InputError."""
    race, side = _column(found, "race_angle"), _column(found, "side")
    if side is None:
        side = _column(found, "eta_hat")
    if race is None or side is None or race.size != side.size:
        raise InputError("found: needs race_angle, and side or eta_hat; give Bounces or a table that has them")
    good = np.isfinite(race)
    if not good.any():
        raise InputError("found: has no race angle that is known; look at its status")
    return race[good], np.sign(side[good])


def _column(found: Any, name: str) -> Array | None:
    """A column of a result, a table or a mapping, flat; None where there is none."""
    try:
        values = found[name] if hasattr(found, "__getitem__") else getattr(found, name)
    except (KeyError, AttributeError):
        return None
    return np.ravel(column(f"found: {name}", values))
