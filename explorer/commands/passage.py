"""One passage, for people and for scripts."""

from typing import Any

import numpy as np

from explorer import compiled
from explorer.errors import InputError
from explorer.motion.forces import passage_forces
from explorer.motion.passages import passages
from explorer.phase.disk import Disk

_UNITS = {
    "duration": "units of time",
    "fall_time": "units of time",
    "energy": "units of energy",
    "impact_speed": "rad per unit of time",
    "min_normal_force": "m g",
    "max_friction": "",
    "error_estimate": "",
    "face": "",
}
_WORDS = ("status", "method", "model", "disk")


def passage_report(
    disk: str | Disk,
    sigma3_bar: float,
    eta_hat: float,
    phidot: float,
    face: int = 1,
    *,
    method: str = "auto",
    accuracy: float = 1e-6,
    window: float | None = None,
) -> dict[str, Any]:
    """What `nearflat passage --json` prints. Quantities that do not exist are None."""
    body = disk if isinstance(disk, Disk) else Disk.parse(disk)
    for name, value in (("--sigma3-bar", sigma3_bar), ("--eta-hat", eta_hat), ("--phidot", phidot)):
        if not np.isfinite(value) or (name == "--phidot" and value < 0.0):
            raise InputError(f"{name} {value} must be a finite number{', 0 or more' * (name == '--phidot')}")
    found = passages(body, sigma3_bar, eta_hat, phidot, face, method=method, accuracy=accuracy, window=window)
    status = compiled.status.Status(int(found.status[0]))
    report: dict[str, Any] = {"disk": body.name, "face": face, "status": status.name.lower()}
    for name in ("race_angle", "delta_chi", "delta_psi", "fall_angle", "theta_min", "duration", "fall_time"):
        report[name] = _number(getattr(found, name)[0])
    for name in ("energy", "impact_speed", "limit", "error_estimate"):
        report[name] = _number(getattr(found, name)[0])
    report |= {"method": found.method, "model": found.model, "accuracy": accuracy}
    report["warnings"] = []
    if status == compiled.status.Status.FALLS:
        report["limits"] = _continuations(body, report["fall_angle"], face)
    elif status == compiled.status.Status.OK:
        forces = passage_forces(body, sigma3_bar, eta_hat, phidot)
        report["min_normal_force"] = _number(forces.min_normal_force[0])
        report["max_friction"] = _number(forces.max_friction[0])
        report["warnings"] = _physicality(forces.min_normal_force[0], forces.max_friction[0])
    else:
        report["warnings"] = [f"{status.sentence} {status.remedy}"]
    return report


def _continuations(disk: Disk, fall_angle: float, face: int) -> dict[str, dict[str, float]]:
    """What the passage tends to from each side: angles from vertical to vertical."""
    return {
        name: {
            "race_angle": sign * disk.race_limit,
            "delta_chi": fall_angle + sign * disk.race_limit,
            "psi_jump": face * sign * disk.race_limit,
        }
        for name, sign in (("plus", 1), ("minus", -1))
    }


def _physicality(normal: float, friction: float) -> list[str]:
    if normal <= 0.0:
        return [
            f"the model keeps contact, but the normal force falls to {normal:.3g} m g: a real disk would lift off"
        ]
    if friction > 1.0:
        return [f"the model does not slip, but this motion needs a friction coefficient of {friction:.3g}"]
    return []


def _number(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def passage_text(report: dict[str, Any]) -> str:
    """The report as lines of text."""
    lines = []
    for name, value in report.items():
        if name in ("warnings", "limits", "accuracy") or value is None:
            continue
        shown = value if name in _WORDS or name == "face" else f"{value:.12g} {_UNITS.get(name, 'rad')}".rstrip()
        lines.append(f"{name:18} {shown}")
    for name, values in report.get("limits", {}).items():
        face = ">" if name == "plus" else "<"
        lines += [f"limit, eta {face} 0     {key} {value:+.12g} rad" for key, value in values.items()]
    return "\n".join(lines)
