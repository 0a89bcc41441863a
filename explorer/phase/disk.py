"""The disk: SI units in, validated, and its natural units."""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np

from explorer import compiled
from explorer.errors import InputError, double_of, nearest, number, one_of, positive, said, shown, warn, word
from explorer.paths import read_toml
from explorer.phase.arguments import Array as Array
from explorer.phase.energy import Number, energy_at_flat, eta_hat_to_eta, eta_to_eta_hat

PRESETS = ("uniform", "hoop", "matching")
_SCALES = ("m", "r", "g")
# Units in which quantities may be written, longer names first, each with its size in SI units.
UNITS = {
    "kg m^2": (1.0, ("I1", "I3")),
    "g cm^2": (1e-7, ("I1", "I3")),
    "m/s^2": (1.0, ("g",)),
    "kg": (1.0, ("m",)),
    "g": (1e-3, ("m",)),
    "cm": (1e-2, ("r",)),
    "mm": (1e-3, ("r",)),
    "m": (1.0, ("r",)),
}
SYNTAX = (
    f"a name, a file FILE.toml, or numbers. Names are {', '.join(PRESETS)} (its limit motions on the two sides of "
    "the falling set agree) and annulus:INNER_OVER_OUTER. Numbers may follow a name, as in "
    '"uniform:m=..,r=..,g=..", or stand alone: "m=..,r=..,g=..,I1=..,I3=..", where I3=flat means 2 I1. '
    f"A number may have a unit ({', '.join(UNITS)}), as in "
    '"m=20g,r=5cm,I1=150 g cm^2,I3=flat"; g is then 9.81 m/s^2 if left out'
)
_ROUNDING = 8.0 * 2.2e-16  # by which products of the same numbers, as I3 and 2 I1 are, may differ
LARGEST_RATE = 1e75  # natural units, of all that is given: up to here fourth powers of rates are numbers


@dataclass(frozen=True, init=False)
class Disk:
    """A body of revolution rolling on a sharp rim, its centre of mass at the rim's centre.

    Any consistent units will do. It is not checked whether a real body with these moments exists.

    Parameters
    ----------
    m : float, optional
        Mass (kg); 1 if left out, as r and g are.
    r : float, optional
        Radius of the rim (m).
    g : float, optional
        Gravity (m/s^2).
    I1, I3 : float, optional
        Transverse and axial moment of inertia (kg m^2), 0 <= I3 <= 2 I1 by eq. (2.3). I1 is by default that of a
        uniform disk, m r^2/4. I3 is by default that of a flat body, 2 I1; I3="flat" means this too, and so does an
        I3 that is larger by rounding only.
    name : str
        Used in the names of folders, in pictures and in tables.

    Raises
    ------
    InputError
        For quantities that no disk has, and for units so far apart that numbers overflow.

    Warns
    -----
    UserWarning
        If m or r is given without g, which is then 1: with kilograms and metres, seconds would need g=9.81. Also
        if m or r is given and I3 exceeds 2 m r^2. Then either mass lies far beyond the rim, or the moments
        were meant in units of m r^2; `from_ratios` takes these.

    Examples
    --------
    >>> import explorer as ex
    >>> coin = ex.Disk.uniform(m=5.67e-3, r=12.1e-3, g=9.81)
    >>> print(f"{coin.kappa:.6f} {coin.time_unit:.4f}")
    2.236068 0.0351
    """

    m: float
    r: float
    g: float
    I1: float
    I3: float
    name: str

    def __init__(
        self,
        *,
        m: float | None = None,
        r: float | None = None,
        g: float | None = None,
        I1: float | None = None,
        I3: float | str | None = None,
        name: str = "custom",
    ) -> None:
        mass, radius, gravity = _units(m, r, g)
        transverse = 0.25 * mass * radius * radius if I1 is None else _quantity("I1", I1)
        axial = 2.0 * transverse if _is_flat(I3) else _quantity("I3", I3)
        read = {"m": mass, "r": radius, "g": gravity, "I1": transverse, "I3": axial}
        if axial <= 2.0 * transverse * (1.0 + _ROUNDING):
            read["I3"] = min(axial, 2.0 * transverse)
        for key, value in {**read, "name": word("disk: name", name)}.items():
            object.__setattr__(self, key, value)
        if self.I3 > 2.0 * self.I1 * (1.0 + _ROUNDING):
            raise InputError(
                f"disk: I3 = {self.I3} exceeds 2 I1 = {2.0 * self.I1}, which no body has; "
                "for a flat one give I3=flat"
            )
        if not _can_be_scaled(self):
            raise InputError("disk: m, r, g, I1 lie too far apart for floating point; rescale the units")
        ratio = self.I3 / self._inertia_unit
        if ratio > 2.0 and (self.m, self.r) != (1.0, 1.0):
            warn(
                f"disk: I3 = {self.I3:g} is {ratio:.3g} m r^2, and a hoop has 1: mass lies beyond the rim; "
                "for moments in units of m r^2 use Disk.from_ratios"
            )

    @classmethod
    def from_ratios(
        cls,
        *,
        I1: float,
        I3: float | str | None = None,
        m: float | None = None,
        r: float | None = None,
        g: float | None = None,
        name: str = "custom",
    ) -> Disk:
        """A body whose moments of inertia are in units of m r^2; I3 is by default that of a flat one, 2 I1.

        Examples
        --------
        >>> import explorer as ex
        >>> f"{ex.Disk.from_ratios(I1=0.3, I3=0.45, m=0.02, r=0.05, g=9.81).I3:g} kg m^2"
        '2.25e-05 kg m^2'
        """
        m, r, g = _units(m, r, g)
        unit = m * r * r
        axial = None if _is_flat(I3) else _quantity("I3", I3) * unit
        return cls(m=m, r=r, g=g, I1=_quantity("I1", I1) * unit, I3=axial, name=name)

    @classmethod
    def annulus(
        cls, inner: float | str, *, m: float | None = None, r: float | None = None, g: float | None = None
    ) -> Disk:
        """A flat uniform ring; inner is the ratio of its inner radius to its outer one, 0 (disk) to 1 (hoop).

        Examples
        --------
        >>> import explorer as ex
        >>> ex.Disk.annulus(0.5).I3
        0.625
        """
        ratio = number(
            "disk: annulus (inner over outer radius, between 0 and 1, as in annulus:0.5)", inner, 0.0, 1.0
        )
        return cls.from_ratios(I1=0.25 * (1.0 + ratio * ratio), m=m, r=r, g=g, name=f"annulus-{ratio:g}")

    @classmethod
    def uniform(cls, *, m: float | None = None, r: float | None = None, g: float | None = None) -> Disk:
        """The uniform disk, eq. (2.5): m r^2 / I1 = 4.

        Examples
        --------
        >>> import explorer as ex
        >>> ex.Disk.uniform(m=0.02, r=0.05, g=9.81).kappa == ex.Disk.uniform().kappa == 5**0.5
        True
        """
        return replace(cls.annulus(0.0, m=m, r=r, g=g), name="uniform")

    @classmethod
    def hoop(cls, *, m: float | None = None, r: float | None = None, g: float | None = None) -> Disk:
        """The hoop, eq. (2.6): m r^2 / I1 = 2.

        Examples
        --------
        >>> import explorer as ex
        >>> ex.Disk.hoop().I1
        0.5
        """
        return replace(cls.annulus(1.0, m=m, r=r, g=g), name="hoop")

    @classmethod
    def matching(cls, *, m: float | None = None, r: float | None = None, g: float | None = None) -> Disk:
        """The flat body with m r^2 / I1 = 3, for which both one-sided limit motions agree.

        Examples
        --------
        >>> import explorer as ex
        >>> ex.Disk.matching().kappa, ex.Disk.matching().gap
        (2.0, 0.0)
        """
        return cls.from_ratios(I1=1.0 / 3.0, m=m, r=r, g=g, name="matching")

    @classmethod
    def parse(cls, text: str) -> Disk:
        """A disk from what the command line accepts. Raises InputError.

        Examples
        --------
        >>> import explorer as ex
        >>> ex.Disk.parse("annulus:0.5,m=20g,r=5cm").m
        0.02
        """
        if not isinstance(text, str):
            raise InputError(f"disk = {shown(text)} is not text; choose {SYNTAX}")
        head, _, rest = text.strip().partition(":")
        if head == "annulus":
            inner, _, scales = rest.partition(",")
            return _preset(partial(cls.annulus, inner), scales)
        if head in PRESETS:
            return _preset(getattr(cls, head), rest)
        if text.strip().endswith(".toml"):
            path = Path(text.strip())
            return cls._of_moments({"name": path.stem, **_all_in_si(read_toml(path, "disk"))})
        if "=" in text:
            return cls._of_moments(_quantities(text))
        near = nearest(head, (*PRESETS, "annulus"))
        meant = f"did you mean {near!r}? " if near else ""
        raise InputError(f"disk {shown(text)} is not known; {meant}choose {SYNTAX}")

    @classmethod
    def _of_moments(cls, values: dict[str, Any]) -> Disk:
        for key in values:
            one_of("disk: quantity", key, (*_SCALES, "I1", "I3", "name"))
        missing = [key for key in ("I1", "I3") if key not in values]
        if missing:
            raise InputError(
                f"disk: {' and '.join(missing)} missing; give I1 and I3, or a body as in uniform:m=20g,r=5cm"
            )
        return cls(**values)

    @property
    def _inertia_unit(self) -> float:
        return self.m * self.r * self.r

    @property
    def rate_unit(self) -> float:
        """sqrt(g/r) in rad/s: one natural unit of an angular velocity."""
        return math.sqrt(self.g / self.r)

    @property
    def time_unit(self) -> float:
        """sqrt(r/g) in s."""
        return 1.0 / self.rate_unit

    @property
    def energy_unit(self) -> float:
        """m g r in J."""
        return self.m * self.g * self.r

    @property
    def eta_unit(self) -> float:
        """m r^2 sqrt(g/r), the unit of eta_+-."""
        return self._inertia_unit * self.rate_unit

    def eta_hat_to_eta(self, eta_hat: Number) -> Number:
        """eta = I3 r(0) eta_hat, eq. (6.2); both in the units of the disk.

        Examples
        --------
        >>> import explorer as ex
        >>> disk = ex.Disk.uniform()
        >>> round(disk.eta_to_eta_hat(disk.eta_hat_to_eta(0.25)), 12)
        0.25
        """
        return eta_hat_to_eta(self.body, eta_hat) * self._inertia_unit

    def eta_to_eta_hat(self, eta: Number) -> Number:
        """eta_hat = eta / (I3 r(0)), eq. (6.2); both in the units of the disk. NaN if I3 = 0.

        Examples
        --------
        >>> import explorer as ex
        >>> round(ex.Disk.uniform().eta_to_eta_hat(1.0), 4)
        1.3614
        """
        return eta_to_eta_hat(self.body, eta / self._inertia_unit)

    def energy_at_flat(self, sigma3_bar: Number) -> Number:
        """V_0, the amended potential at flat on a line l_+-, eq. (6.9); units of the disk. Needs I3 > 0.

        Examples
        --------
        >>> import explorer as ex
        >>> round(ex.Disk.uniform().energy_at_flat(1.0), 4)
        0.0869
        >>> print(f"{ex.Disk.uniform(m=5.67e-3, r=12.1e-3, g=9.81).energy_at_flat(30.0):.2e} J")
        6.49e-05 J
        """
        return energy_at_flat(self.body, sigma3_bar / self.rate_unit) * self.energy_unit

    @property
    def kappa(self) -> float:
        """The race number sqrt(1 + m r^2 / I1), eq. (7.9)."""
        return math.sqrt(1.0 + self._inertia_unit / self.I1)

    @property
    def race_limit(self) -> float:
        """kappa pi (rad): the angle by which the contact point races round the rim."""
        return self.kappa * math.pi

    @property
    def gap(self) -> float:
        """2 kappa pi mod 2 pi (rad): how far the two one-sided limit motions differ per fall."""
        gap = math.remainder(2.0 * self.race_limit, 2.0 * math.pi)
        # Rounding of m, r and I1 must not turn a gap of zero into one of 2 pi.
        return 0.0 if abs(gap) < 1e-12 else gap % (2.0 * math.pi)

    @cached_property
    def natural(self) -> compiled.body.NaturalDisk:
        """The disk as the kernels take it: dimensionless constants and Chaplygin series."""
        unit = self._inertia_unit
        return compiled.body.make_disk(self.I1 / unit, self.I3 / unit)

    @cached_property
    def arc_disk(self) -> compiled.potential.ArcDisk:
        """The form of the disk in which arcs of motions are computed."""
        return compiled.potential.make_arc_disk(self.natural)

    @property
    def body(self) -> compiled.body.Body:
        """Dimensionless constants of the disk."""
        return self.natural.body

    @cached_property
    def tables(self) -> tuple[compiled.tables.Tables, ...]:
        """Tables for passages near flat, down to 1e-6 and for finer accuracies; none of slender bodies."""
        from numpy.polynomial.legendre import leggauss

        make = compiled.tables
        if self.body.I1 < make.LEAST_I1:
            return ()
        return tuple(
            make.make_tables(self.natural, orders, [np.stack(leggauss(n)) for n in orders[:3]])
            for orders in (make.COARSE, make.FINE)
        )

    def describe(self) -> dict[str, float | str]:
        """Name, mass, radius, gravity and moments, as run.json shows them and `Disk(**...)` takes them.

        Examples
        --------
        >>> import explorer as ex
        >>> ex.Disk.uniform(m=5.67e-3, r=12.1e-3, g=9.81).describe()["r"]
        0.0121
        """
        return asdict(self)


def _is_flat(I3: Any) -> bool:
    """Whether the axial moment is said to be that of a flat body, as it is by default."""
    return I3 is None or (isinstance(I3, str) and I3 == "flat")


def _units(m: Any, r: Any, g: Any) -> tuple[float, float, float]:
    """Mass, radius and gravity, read; 1 where they are left out. Raises InputError."""
    given = {"m": m, "r": r, "g": g}
    mass, radius, gravity = (1.0 if value is None else _quantity(key, value) for key, value in given.items())
    if g is None and not (m is None and r is None):
        warn("disk: m or r is given without g, which is then 1; give g=9.81 for kilograms, metres and seconds")
    return mass, radius, gravity


def _quantity(key: str, value: Any) -> float:
    """A quantity, read. Raises InputError, also for one with a unit, which only `Disk.parse` reads."""
    if _has_unit(value):
        remedy = 'give one, or a text with units to Disk.parse, such as "uniform:m=20g,r=5cm"'
        raise InputError(f"{said(f'disk: {key}', value)} is not a number; {remedy}")
    return number("disk: I3", value, 0.0) if key == "I3" else positive(f"disk: {key}", value)


def _has_unit(value: Any) -> bool:
    """Whether a text holds a number and more."""
    return isinstance(value, str) and double_of(value) is None and any(map(str.isdigit, value))


def _can_be_scaled(disk: Disk) -> bool:
    """Whether natural units and their inverses are normal numbers, and I1/(m r^2) is one whose square is."""
    try:
        units = disk.m * disk.r * disk.r, disk.rate_unit, disk.energy_unit, disk.eta_unit
        sizes = [*units, *(1.0 / unit for unit in units), (disk.I1 / units[0]) ** 2, (units[0] / disk.I1) ** 2]
    except (ZeroDivisionError, OverflowError):
        return False
    return all(sys.float_info.min <= size < math.inf for size in sizes)


_EARTH = "9.81"  # m/s^2


def _quantities(text: str) -> dict[str, Any]:
    """{"m": "1", ...} from "m=1,...". Raises InputError."""
    pairs = [item.partition("=") for item in text.split(",") if item.strip()]
    for key, equals, _ in pairs:
        if not equals:
            raise InputError(f"disk: {shown(key.strip())} is not NAME=VALUE; write for instance m=1,r=0.5")
    return _all_in_si({key.strip(): value.strip() for key, _, value in pairs})


def _all_in_si(given: dict[str, Any]) -> dict[str, Any]:
    """Quantities, of which texts may have units, without these."""
    read = {key: _in_si(key, value) if isinstance(value, str) else value for key, value in given.items()}
    # Where one has a unit all are SI, and the disk rolls on the Earth.
    return read if read == given else {"g": _EARTH, **read}


def _in_si(key: str, value: str) -> str:
    """A quantity without its unit, which may be one of UNITS, also written as gcm2 or g*cm²."""
    for unit, (size, keys) in UNITS.items():
        spelt = unit.replace(" ", "[ *·]?").replace("^2", "(?:\\^?2|²)")
        found = re.fullmatch(rf"(.*?)\s*{spelt}", value) if key in keys else None
        if found and (bare := double_of(found[1])) is not None:
            return repr(bare * size)
    units = [unit for unit, (_, keys) in UNITS.items() if key in keys]
    if units and _has_unit(value):
        raise InputError(f"{said(f'disk: {key}', value)} is not a number; give one, also in {', '.join(units)}")
    return value


def _preset(make: Callable[..., Disk], text: str) -> Disk:
    """A preset with m, r, g and a name as text, where these are given. Raises InputError."""
    values = _quantities(text)
    for key in values:
        one_of("disk: quantity", key, (*_SCALES, "name"))
    name = values.pop("name", None)
    made: Disk = make(**values)
    return made if name is None else replace(made, name=name)


def require_disk(disk: Disk) -> None:
    """Raise InputError where something else was given, a name for instance."""
    if not isinstance(disk, Disk):
        raise InputError(f"disk = {shown(disk)} is not a Disk; make one, for instance Disk.parse('uniform')")


def require_axial_inertia(disk: Disk) -> None:
    """Raise InputError where I3 = 0: eta_hat = eta/(I3 r(0)) and the lines' slope need I3 > 0."""
    require_disk(disk)
    if not disk.body.I3 > 0.0:
        raise InputError("disk: I3 = 0 has no eta_hat (it divides by I3); give a disk with I3 > 0")
