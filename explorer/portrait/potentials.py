"""The amended potential at the constants of motion that users give, and the levels that pictures show of it."""

import math

import numpy as np

from explorer.errors import InputError, number, sign
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.lines import line_slope, nearer_plus
from explorer.phase.membership import require_well
from explorer.phase.states import Array
from explorer.portrait.potential import Potential, Separatrix

_EPS = float(np.finfo(float).eps)
_LARGEST = 1e100  # of a constant of motion; squares of larger ones overflow
_TOLD_APART = 1e-10  # of an energy: levels as far apart differ by many roundings, also at the fastest rates


def on_line(disk: Disk, sigma3_bar: float, eta_hat: float = 0.0, face: int = 1) -> Potential:
    """The potential V at a distance eta_hat from a line l±, on which the disk falls.

    Parameters
    ----------
    disk : Disk
        The body, with I3 > 0.
    sigma3_bar : float
        Constant of motion, units of the disk.
    eta_hat : float
        Signed distance to the line, units of the disk; on it where 0.
    face : int
        +1 for the line l₊, -1 for l₋.

    Returns
    -------
    Potential

    Raises
    ------
    InputError
        For numbers beyond 1e100, and for a disk with I3 = 0.

    References
    ----------
    Eqs (3.8) and (6.2) of the paper.

    Examples
    --------
    >>> import explorer as ex
    >>> beside = ex.portrait.on_line(ex.Disk.uniform(), sigma3_bar=0.25, eta_hat=0.01)
    >>> [at.kind for at in beside.equilibria]
    ['centre', 'saddle', 'centre']
    """
    require_axial_inertia(disk)
    bar, eta = _constant("sigma3_bar", sigma3_bar), _constant("eta_hat", eta_hat)
    return Potential(disk, bar / disk.rate_unit, eta / disk.rate_unit, sign("face", face))


def at_constants(disk: Disk, sigma3_bar: float, sigma4_bar: float) -> Potential:
    """The potential V at given constants of motion, seen from the nearer line l±.

    Parameters
    ----------
    disk : Disk
        The body, with I3 > 0.
    sigma3_bar, sigma4_bar : float
        Constants of motion, units of the disk. What is on a line to rounding counts as on it.

    Returns
    -------
    Potential

    Raises
    ------
    InputError
        For numbers beyond 1e100, and for a disk with I3 = 0.

    References
    ----------
    Eqs (3.5) and (3.8) of the paper.

    Examples
    --------
    >>> import explorer as ex
    >>> upright = ex.portrait.at_constants(ex.Disk.uniform(), sigma3_bar=2.0, sigma4_bar=0.0)
    >>> [(at.kind, round(at.phi, 6)) for at in upright.equilibria]
    [('centre', 0.0)]
    """
    require_axial_inertia(disk)
    bar = _constant("sigma3_bar", sigma3_bar) / disk.rate_unit
    spin = _constant("sigma4_bar", sigma4_bar) / disk.rate_unit
    slope = line_slope(disk)
    face = 1 if nearer_plus(np.array(slope * bar - spin), np.array(slope * bar + spin)) else -1
    eta = slope * bar - face * spin
    return Potential(disk, bar, 0.0 if abs(eta) <= 4.0 * _EPS * abs(spin) else eta, face)


def well_separatrix(disk: Disk, sigma3_bar: float, face: int = 1) -> Separatrix:
    """The separatrix that parts the non-falling well on l_+- from the falling motions, section 6.2.

    Raises InputError where there is no well: |sigma3_bar| must be below sigma3_bar* (`membership.well`).
    """
    require_well(disk, sigma3_bar)
    return on_line(disk, sigma3_bar, 0.0, face).separatrices()[0]


def level_energies(potential: Potential, energies: tuple[float, float] | None = None, count: int = 9) -> Array:
    """Energies of level curves (units of the disk), from the bottom of V to above all saddles unless given.

    Raises InputError where the range is empty or no motion has an energy in it.
    """
    bottom, unit = potential.bottom, potential.disk.energy_unit
    if energies is None:
        tops = [at.energy for at in potential.equilibria] + [float(potential.V(0.0))]
        low, high = bottom, max(tops) + 0.5 * max(unit, _TOLD_APART * abs(max(tops)))
    else:
        low, high = energies
        if not (math.isfinite(low) and math.isfinite(high) and low < high):
            raise InputError(f"energies {low:g}:{high:g} are an empty range; give LOW:HIGH, the smaller first")
        if not high > bottom:
            raise InputError(
                f"energies {low:g}:{high:g}: with eta_hat = {potential.eta_hat:g} no motion has an energy below "
                f"{bottom:.6g}; give a HIGH above that"
            )
    # The bottom itself is no curve; a range that begins above it keeps its lower end
    return np.linspace(low, high, count) if low > bottom else np.linspace(bottom, high, count + 1)[1:]


def _constant(name: str, value: float) -> float:
    return number(name, value, -_LARGEST, _LARGEST)
