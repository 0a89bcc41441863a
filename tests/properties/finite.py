"""Where a number of a result is missing though the status of its sample is ok."""

from dataclasses import fields, is_dataclass

import numpy as np

import explorer as ex


def _has_no_limit(found):
    """The motion has not the energy to come flat, to rounding: E <= V_0; or none to leave the crest before it."""
    known, disk = ex.constants(found.states), found.states.disk
    flat = disk.energy_at_flat(known.sigma3_bar)
    return (known.energy <= flat + 1e-6 * abs(flat))[..., None] | ~ex.falls(found.states).could_fall[..., None]


def _resonates(found):
    """A period is whole turns, to rounding."""
    return abs(np.sin(0.5 * found.chi)) <= 1e-15 * np.maximum(1.0, abs(found.chi))


# (class, field): of which samples a number may be missing, as its docstring has it.
MAY_LACK = {
    ("Passages", "fall_time"): lambda found: True,  # of what falls alone
    ("Forces", "max_friction"): lambda found: found.min_normal_force <= 0.0,
    ("Bounces", "fall_angle"): _has_no_limit,
    ("Bounces", "race_angle"): _has_no_limit,
    ("Falls", "theta_min_estimate"): lambda found: ~found.could_fall,
    ("Wander", "radius"): _resonates,
    ("RotationMap", "turns"): lambda found: True,  # where no motion has these constants
    **{
        ("Constants", name): lambda found: found.states.disk.I3 == 0.0
        for name in ("sigma4_bar", "eta_hat_plus", "eta_hat_minus")
    },
    **{
        ("FallingConstant", name): lambda found: found.value == np.inf
        for name in ("value", "error", "plus", "minus")
    },
    **{(kind, "values"): lambda found: True for kind in ("Scan", "SliceMap")},  # a user's, or of no status
}


def missing(found):
    """The fields of a result that lack a number of a sample with the status ok."""
    if isinstance(found, ex.States):
        return [] if np.isfinite(found.natural).all() else ["States.natural"]
    names, kind, status = [], type(found).__name__, np.asarray(getattr(found, "status", 0))
    for field in fields(found) if is_dataclass(found) and not isinstance(found, ex.Disk) else ():
        numbers = getattr(found, field.name)
        if is_dataclass(numbers):
            names += missing(numbers)
        elif not field.name.startswith("_") and isinstance(numbers, float | np.ndarray):
            numbers = np.asarray(numbers)
            wrong = ~np.isfinite(numbers) if numbers.dtype.kind in "fc" else np.zeros(numbers.shape, bool)
            if wrong.shape[: status.ndim] == status.shape:  # the first axes are those of samples
                wrong &= np.reshape(status == ex.Status.OK, (*status.shape, *(1,) * (wrong.ndim - status.ndim)))
            if wrong.any() and (kind, field.name) in MAY_LACK:
                wrong &= ~np.asarray(MAY_LACK[kind, field.name](found))
            names += [f"{kind}.{field.name}"] * bool(wrong.any())
    return names
