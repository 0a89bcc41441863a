"""Passages and falls as integrals between turning points: eta is what was given, and no step is taken."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.motion.plan import Plan
from explorer.motion.vertical import Starts
from explorer.phase.disk import Disk
from explorer.phase.gauss import packed_rules
from explorer.phase.states import Array


class Followed(NamedTuple):
    """Passages as a method followed them, columns in natural units, angles as on face +1.

    way: sigma3/q at the flattest moment, whose sign is the direction of the race. error: as
    `Passages.error_estimate`.
    """

    theta_min: Array
    chi: Array
    psi: Array
    time: Array
    way: Array
    energy: Array
    error: Array
    status: NDArray[np.int8]


def by_quadrature(disk: Disk, starts: Starts, how: Plan, edge: float) -> Followed:
    """Passages as integrals. edge: the tilt phi (rad) at which they start and stop, 0 for the vertical."""
    sigma3_bar, eta, speed = starts.natural(disk)
    out, status = np.empty((8, eta.size)), starts.status.copy()
    compiled.passages.passage_batch(
        sigma3_bar,
        eta,
        speed,
        chord(edge),
        how.accuracy,
        *packed_rules(),
        disk.tables,
        disk.body,
        disk.series,
        out,
        status,
    )
    theta_min, chi, psi, time, energy, angle_error, time_error, way = out
    # The kernel skips what lies on F.
    energy = np.where(eta == 0.0, energy_on_f(disk, sigma3_bar, speed), energy)
    return Followed(theta_min, chi, psi, time, way, energy, np.fmax(angle_error, time_error), status)


def energy_on_f(disk: Disk, sigma3_bar: Array, speed: Array) -> Array:
    """Energy of a start at the vertical on a line l_+-, eqs (2.19), (6.1); natural units."""
    b = disk.body
    sigma4 = b.I1 * b.dr0 * sigma3_bar / (b.I3 * b.r0)
    return 0.5 * b.M * speed**2 + 0.5 * b.I1 * sigma3_bar**2 + 0.5 * b.J * sigma4**2 + 1.0


def chord(phi: float) -> float:
    """2 sin(theta/2) at the tilt phi (rad), as the kernels measure tilt; at the vertical exactly theirs."""
    return 2.0 * float(np.sin(0.5 * (0.5 * np.pi - phi))) if phi > 0.0 else float(compiled.quadrature.VERTICAL)


class Fall(NamedTuple):
    """Time and angles of the fall on F from the vertical to flat (face +1), natural units, and their error."""

    time: Array
    chi: Array
    psi: Array
    error: Array


def fall_from_vertical(disk: Disk, sigma3_bar: Array, energy: Array, edge: float = 0.0) -> Fall:
    """The fall on F with these constants (natural units). edge: phi (rad) at which it begins instead."""
    out = np.empty((4, sigma3_bar.size))
    compiled.passages.fall_batch(
        np.ascontiguousarray(sigma3_bar),
        np.ascontiguousarray(energy),
        chord(edge),
        *packed_rules(),
        disk.tables,
        disk.body,
        disk.series,
        out,
    )
    return Fall(*out)
