"""`nearflat passage`: one passage near flat, as text or as JSON."""

import argparse
import json
import sys
from typing import Any, NamedTuple

import numpy as np

from explorer import compiled
from explorer.commands.common import add_json
from explorer.errors import note, number, sign
from explorer.motion.forces import KERNELS as FORCES
from explorer.motion.forces import passage_forces
from explorer.motion.passages import OBSERVABLES, passage_kernels, passages
from explorer.motion.plan import plan
from explorer.phase.disk import Disk

_ROUNDING = 1e-12  # of a normal force, m g: a hoop may touch zero
_UNITS = {
    "duration": "units of the disk (time)",
    "fall_time": "units of the disk (time)",
    "energy": "units of the disk (energy)",
    "impact_speed": "units of the disk (rate)",
    "min_normal_force": "m g",
    "max_friction": "",
    "error_estimate": "",
    "face": "",
}
_NUMBERS = (
    "race_angle",
    "delta_chi",
    "delta_psi",
    "fall_angle",
    "theta_min",
    "duration",
    "fall_time",
    "energy",
    "impact_speed",
    "limit",
    "error_estimate",
)
_WORDS = ("status", "method", "model", "disk")


class Start(NamedTuple):
    """A motion at the vertical, in the units of the disk: speed towards the flat state `face`."""

    sigma3_bar: float
    eta_hat: float
    phidot: float
    face: int = 1


def passage_report(
    disk: Disk, start: Start, *, method: str = "auto", accuracy: float = 1e-6, window: float | None = None
) -> dict[str, Any]:
    """What `nearflat passage --json` prints. Quantities that do not exist are None."""
    made = passages(disk, *start, method=method, accuracy=accuracy, window=window)
    status = compiled.status.Status(int(made.status[0]))
    report: dict[str, Any] = {"disk": disk.name, "face": start.face, "status": status.name.lower()}
    for name in _NUMBERS:
        report[name] = _number(getattr(made, name)[0])
    report |= {"method": made.method, "model": made.model, "accuracy": accuracy}
    report["warnings"] = []
    if status == compiled.status.Status.FALLS:
        report["limits"] = _continuations(disk, report["fall_angle"], start.face)
    elif status == compiled.status.Status.OK:
        forces = passage_forces(disk, *start[:3])
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
    if normal < -_ROUNDING:
        return [
            f"the model keeps contact, but the normal force falls to {normal:.3g} m g: a real disk would lift off"
        ]
    if normal < _ROUNDING:
        return ["the model does not slip, but the normal force falls to 0 m g, where no friction holds a disk"]
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
        sign = ">" if name == "plus" else "<"
        lines += [f"limit, eta {sign} 0     {key} {value:+.12g} rad" for key, value in values.items()]
    return "\n".join(lines)


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Add the options of `nearflat passage`."""
    command.add_argument("--disk", default="uniform", metavar="DISK", help="as for run (default uniform)")
    for flag, text in (
        ("--sigma3-bar", "sigma3 at the vertical, in the units of the disk"),
        ("--eta-hat", "distance beside the falling set, in the units of the disk; 0 is the fall itself"),
        ("--phidot", "speed at the vertical towards the flat state, 0 or more, in the units of the disk"),
    ):
        command.add_argument(flag, required=True, metavar="X", help=text)
    command.add_argument("--face", default=1, metavar="X", help="flat state, 1 or -1 (default 1)")
    command.add_argument("--accuracy", default="1e-6", metavar="TOL", help="as for run (default 1e-6)")
    command.add_argument("--method", default="auto", metavar="NAME", help="as for run (default auto)")
    command.add_argument("--window", metavar="Q", help="cos phi at which to start and to stop, 0 to 1")
    add_json(command)


def call(options: argparse.Namespace) -> int:
    start = Start(
        number("--sigma3-bar", options.sigma3_bar),
        number("--eta-hat", options.eta_hat),
        number("--phidot", options.phidot, 0.0),
        sign("--face", options.face),
    )
    disk, accuracy = Disk.parse(options.disk), number("--accuracy", options.accuracy)
    called = (*passage_kernels(plan(OBSERVABLES, accuracy, options.method)), *FORCES)
    compiled.warmup(called, lambda text: note(text, options.quiet))
    report = passage_report(
        disk,
        start,
        method=options.method,
        accuracy=accuracy,
        window=None if options.window is None else number("--window", options.window),
    )
    print(json.dumps(report) if options.json else passage_text(report))
    for warning in () if options.quiet else report["warnings"]:
        print(f"nearflat passage: {warning}", file=sys.stderr)
    return 0 if report["status"] in ("ok", "falls") else 1
