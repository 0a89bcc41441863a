"""Where numbers of results may be missing: for each class, which field for which samples, as its docstring has it.

All else must be finite wherever the status is ok, and in results without a status everywhere.
"""

from dataclasses import fields, is_dataclass

import numpy as np

import explorer as ex

OK, FALLS = ex.Status.OK, ex.Status.FALLS
_ROUNDING = 1e-6  # relative, of energies at a barrier
_LOOKED_AT = 20  # samples of a result, where a rule computes


def _sampled(allowed, value, wrong):
    """A rule that is asked for some samples: where `wrong` and not allowed."""
    still = wrong.copy()
    for at in list(zip(*np.nonzero(wrong), strict=True))[:_LOOKED_AT]:
        still[at] = not allowed(value, at)
    return still


def _has_no_limit(found, wrong):
    """The motion has not the energy to come flat: E <= V_0."""
    known = ex.constants(found.states)
    disk = found.states.disk
    flat = disk.energy_at_flat(known.sigma3_bar / disk.rate_unit) * disk.energy_unit
    below = known.energy <= flat + _ROUNDING * abs(flat)
    return wrong & ~below.reshape(*below.shape, *(1,) * (wrong.ndim - below.ndim))


def _lifts_off(found, wrong):
    """Friction is infinite, never unknown, where the contact pulls."""
    return wrong & ~((found.min_normal_force <= 0.0) & (found.max_friction == np.inf))


def _resonates(found, wrong):
    """A period is whole turns to rounding."""
    turn = abs(np.sin(0.5 * found.chi))
    return wrong & ~((turn <= 1e-15 * np.maximum(1.0, abs(found.chi))) & (found.radius == np.inf))


def _has_no_axis(found, wrong):
    return wrong & (found.states.disk.I3 > 0.0)


# (class, field) -> of the samples `wrong`, which are answered and not finite, those that should not be.
RULES = {
    ("Passages", "fall_time"): lambda found, wrong: wrong & (found.status != OK),  # of what falls alone
    ("Forces", "max_friction"): _lifts_off,
    ("Bounces", "fall_angle"): _has_no_limit,
    ("Bounces", "race_angle"): _has_no_limit,
    ("Falls", "theta_min_estimate"): lambda found, wrong: wrong & found.could_fall,
    ("Wander", "radius"): _resonates,
    ("Constants", "sigma4_bar"): _has_no_axis,
    ("Constants", "eta_hat_plus"): _has_no_axis,
    ("Constants", "eta_hat_minus"): _has_no_axis,
    ("ContactForces", "friction"): lambda found, wrong: wrong & (found.normal > 0.0),
    ("RotationMap", "turns"): lambda found, wrong: _sampled(_has_no_turns, found, wrong),
    ("ConstantsPlane", "smallest"): lambda found, wrong: wrong & np.isinf(found.smallest),  # a cell without states
    ("Zoom", "race_angle"): lambda found, wrong: wrong & np.isinf(found.race_angle),  # a start without a passage
    ("FallingConstant", "value"): lambda found, wrong: wrong & (found.value != np.inf),
    ("FallingConstant", "error"): lambda found, wrong: wrong & (found.value != np.inf),
    ("FallingConstant", "plus"): lambda found, wrong: wrong & (found.value != np.inf),
    ("FallingConstant", "minus"): lambda found, wrong: wrong & (found.value != np.inf),
}
# Statuses beside OK with which a number is an answer.
ANSWERS = {
    "Falls": {"": (FALLS,)},
    "Passages": dict.fromkeys(("energy", "impact_speed", "fall_angle", "fall_time"), (FALLS,)),
}
# Arrays whose samples do not come first.
_LAST = {("Trajectories", "constants_error")}
# What holds numbers of a user, or says of its samples elsewhere what became of them.
_OWN = {"Scan", "SliceMap"}


def _has_no_turns(found, at):
    """No motion of this energy passes the vertical with these constants of motion, or it falls."""
    row, column = at
    bar, spin = float(found.sigma3_bar[column]), float(found.sigma4_bar[row])
    potential = ex.portrait.at_constants(found.disk, bar, spin)
    at_vertical = float(potential.V(0.0))
    return 0.0 in potential.etas().values() or found.energy <= at_vertical + _ROUNDING * abs(at_vertical)


def not_finite(value):
    """Names of numbers in a result, or in several, that are missing where they should not be."""
    if isinstance(value, tuple):  # numbers for what may be no number, unless they are of results
        value = [each for each in value if is_dataclass(each)]
    return _of(value, "") if is_dataclass(value) or isinstance(value, dict | list) else []


def _of(value, place):
    if isinstance(value, ex.States):
        return [f"{place}natural"] if not np.isfinite(value.natural).all() else []
    if isinstance(value, ex.Disk | type):
        return []
    if is_dataclass(value):
        return _of_result(value, place)
    if isinstance(value, dict):
        named = value.items()
    elif isinstance(value, list | tuple):
        named = enumerate(value)
    else:
        return [place] if _wrong(value).any() else []
    return [found for name, each in named for found in _of(each, f"{place}[{name!r}]")]


def _of_result(value, place):
    kind, status = type(value).__name__, getattr(value, "status", None)
    found = []
    for field in fields(value):
        numbers = getattr(value, field.name)
        if field.name.startswith("_") or (kind in _OWN and field.name == "values"):
            continue
        if not isinstance(numbers, np.ndarray | float | complex):
            found += _of(numbers, f"{place}{kind}.{field.name}")
            continue
        wrong = _wrong(numbers)
        if isinstance(status, np.ndarray) and status.ndim:
            wrong = _answered(wrong, status, kind, field.name)
        if wrong.any() and (kind, field.name) in RULES:
            wrong = RULES[kind, field.name](value, wrong)
        if wrong.any():
            found.append(f"{place}{kind}.{field.name}")
    return found + (_of_own(value, place) if kind in _OWN else [])


def _wrong(numbers):
    """Where numbers are not finite."""
    numbers = np.asarray(numbers)
    return ~np.isfinite(numbers) if numbers.dtype.kind in "fc" else np.zeros(numbers.shape, bool)


def _answered(wrong, status, kind, name):
    """Those of samples whose status says that they are answered; all, where there is none of this status."""
    codes = ANSWERS.get(kind, {})
    good = np.isin(status, (OK, *codes.get("", ()), *codes.get(name, ())))
    if (kind, name) in _LAST:
        return wrong & good
    if wrong.shape[: status.ndim] != status.shape:
        return wrong
    return wrong & good.reshape(*status.shape, *(1,) * (wrong.ndim - status.ndim))


# What says whether a named observable of states is known.
_KNOWN = {
    "energy": lambda states: ex.constants(states).ok,
    "theta_min": lambda states: ex.periods(states).ok,
    "race_angle": lambda states: np.isfinite(ex.bounces(states).race_angle[..., 0]),
}


def _of_own(value, place):
    """Named observables that are missing though their own call answers."""
    states = value.states if hasattr(value, "states") else value.falls.states
    found = []
    for name, numbers in value.values.items():
        rows = np.flatnonzero(_wrong(numbers))[:_LOOKED_AT] if name in _KNOWN else np.zeros(0, int)
        if rows.size and _KNOWN[name](states[rows]).any():
            found.append(f"{place}{type(value).__name__}[{name!r}]")
    return found
