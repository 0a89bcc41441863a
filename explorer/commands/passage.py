"""`nearflat passage`: one passage near flat, as text or as JSON."""

import argparse
import json
import sys
from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from explorer import compiled
from explorer.commands.common import add_json, given_to
from explorer.errors import note, number, sign
from explorer.motion.forces import KERNELS as FORCES
from explorer.motion.forces import passage_forces
from explorer.motion.passages import OBSERVABLES, passage_kernels, passages
from explorer.motion.plan import METHODS, plan
from explorer.phase.columns import column
from explorer.phase.disk import Disk
from explorer.scenes.options import DISK, NUMBER, Options, Reader, option, word_of

_ROUNDING = 1e-12  # of a normal force, m g: a hoop may touch zero
_NUMBERS = (
    *("race_angle", "delta_chi", "delta_psi", "fall_angle", "theta_min", "duration", "fall_time"),
    *("energy", "impact_speed", "limit", "error_estimate"),
)


class Start(Options):
    """A motion at the vertical."""

    disk: Disk = option(DISK, "as for run", default=Disk.uniform())
    sigma3_bar: float = option(NUMBER, "sigma3 at the vertical, in the units of the disk", required=True)
    eta_hat: float = option(
        NUMBER, "distance beside the falling set, in the units of the disk; 0 is the fall itself", required=True
    )
    phidot: float = option(
        Reader(partial(number, low=0.0), "X", "float | str"),
        "speed at the vertical towards the flat state, 0 or more, in the units of the disk",
        required=True,
    )
    face: int = option(Reader(sign, "X", "int | str"), "flat state, 1 or -1", default=1)
    accuracy: float = option(NUMBER._replace(metavar="TOL"), "as for run", default=1e-6)
    method: str = option(word_of(*METHODS), "as for run", default="auto")
    window: float | None = option(NUMBER._replace(metavar="Q"), "cos phi at which to start and to stop, 0 to 1")


def passage_report(start: Start) -> dict[str, Any]:
    """What `nearflat passage --json` prints. Quantities that do not exist are None."""
    disk, at = start.disk, (start.sigma3_bar, start.eta_hat, start.phidot)
    how: dict[str, Any] = {"method": start.method, "accuracy": start.accuracy, "window": start.window}
    made = passages(disk, *at, start.face, **how)
    status = compiled.status.Status(int(made.status[0]))
    report: dict[str, Any] = {"disk": disk.name, "face": start.face, "status": status.name.lower()}
    for name in _NUMBERS:
        report[name] = _number(getattr(made, name)[0])
    report |= {"method": made.method, "model": made.model, "accuracy": start.accuracy}
    report["warnings"] = []
    if status == compiled.status.Status.FALLS:
        report["limits"] = _continuations(disk, report["fall_angle"], start.face)
    elif status == compiled.status.Status.OK:
        forces = passage_forces(disk, *at)
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
        if isinstance(value, str | int):
            lines.append(f"{name:18} {value}")
        elif isinstance(value, float) and name != "accuracy":
            lines.append(f"{name:18} {value:.12g} {_unit(name)}".rstrip())
    for name, values in report.get("limits", {}).items():
        sign = ">" if name == "plus" else "<"
        lines += [f"limit, eta {sign} 0     {key} {value:+.12g} rad" for key, value in values.items()]
    return "\n".join(lines)


def _unit(name: str) -> str:
    if name == "min_normal_force":
        return "m g"
    unit = column(name).unit
    return unit if unit in ("", "rad") else f"units of the disk ({unit})"


def add_arguments(command: argparse.ArgumentParser, words: Sequence[str]) -> None:
    """Add the options of `nearflat passage`."""
    Start.add_to(command)
    add_json(command)


def call(options: argparse.Namespace) -> int:
    """Print what is known of the passage."""
    start = Start.of(given_to(Start, options))
    called = (*passage_kernels(plan(OBSERVABLES, start.accuracy, start.method)), *FORCES)
    compiled.warmup(called, lambda text: note(text, options.quiet))
    report = passage_report(start)
    print(json.dumps(report) if options.json else passage_text(report))
    for warning in () if options.quiet else report["warnings"]:
        print(f"nearflat passage: {warning}", file=sys.stderr)
    return 0 if report["status"] in ("ok", "falls") else 1
