"""Columns of scene race-angles: which there are, and what a bounce has beside what is found of it."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.motion.bounces import Bounces
from explorer.phase.constants import best_constants
from explorer.phase.disk import Disk
from explorer.phase.lines import line_chart
from explorer.phase.membership import impact_speed
from explorer.phase.states import Array, States
from explorer.scenes.base import Table

# What is stored of a passage, as fields of `Passages`.
FOUND = (
    "energy",
    "race_angle",
    "wrong_way",
    "delta_chi",
    "fall_angle",
    "impact_speed",
    "theta_min",
    "duration",
    "error_estimate",
    "status",
)

# What is stored of a bounce, as fields of `Bounces`.
OF_BOUNCE = (
    "bounce",
    "face",
    "side",
    "time",
    "race_angle",
    "delta_chi",
    "fall_angle",
    "theta_min",
    "duration",
    "error_estimate",
)


def filled(length: int, blocks: Iterable[Table]) -> Table:
    """Columns of so many rows, from blocks of them in order."""
    columns, first = Table(), 0
    for block in blocks:
        for name, values in block.items():
            if name not in columns:
                columns[name] = np.empty(length, values.dtype)
            columns[name][first : first + values.size] = values
        first += block["status"].size
    return columns


def motion_constants(states: States, found: Bounces) -> Table:
    """Columns that belong to a motion and a face, for each of its bounces; NaN where nothing was found."""
    disk, shape = states.disk, found.shape
    natural = best_constants(states)
    ok = (found.status == compiled.status.Status.OK) & (found.face != 0)
    plus = found.face > 0

    def each(values: Array) -> Array:
        return np.broadcast_to(values[:, None], shape)

    eta = np.where(plus, each(natural.eta_plus), each(natural.eta_minus))
    speed = impact_speed(disk, natural.sigma3_bar, natural.energy)
    columns = {
        "sigma3_bar": each(natural.sigma3_bar) * disk.rate_unit,
        "eta_hat": disk.eta_to_eta_hat(eta) * disk.rate_unit,
        "energy": each(natural.energy) * disk.energy_unit,
        "impact_speed": each(speed) * disk.rate_unit,
    }
    table: Table = {name: np.where(ok, values, np.nan).ravel() for name, values in columns.items()}
    return table | {"wrong_way": (ok & _against(disk, found, each(natural.sigma3_bar), eta)).ravel()}


def _against(disk: Disk, found: Bounces, sigma3_bar: Array, eta: Array) -> NDArray[np.bool_]:
    """Whether sigma3 at the flattest moment, which has the sign of chi's rate, has not the sign of eta."""
    tilt = np.where(np.isfinite(found.theta_min), found.theta_min, 1.0).ravel()
    chart = line_chart(disk, np.sin(tilt), np.cos(tilt))
    sigma3 = chart.rates(sigma3_bar.ravel(), disk.eta_to_eta_hat(eta).ravel())[0].reshape(found.shape)
    return np.asarray(np.sign(sigma3) != found.side)
