"""`nearflat passage`: one passage near flat, as text or as JSON."""

import argparse
from functools import partial
from typing import Any

from explorer import compiled
from explorer.commands import Answer
from explorer.errors import note, number, sign
from explorer.motion.forces import KERNELS as FORCES
from explorer.motion.forces import passage_forces
from explorer.motion.passages import OBSERVABLES, passage_kernels, passages
from explorer.motion.plan import METHODS, plan
from explorer.phase.disk import Disk
from explorer.phase.results import unit_of
from explorer.scenes.options import DISK, NUMBER, Options, Reader, option, plain, word_of

_ROUNDING = 1e-12  # of a normal force, m g: a hoop may touch zero
_NUMBERS = (
    *("race_angle", "delta_chi", "delta_psi", "fall_angle", "theta_min", "duration", "fall_time"),
    *("energy", "impact_speed", "limit", "error_estimate"),
)


class PassageOptions(Options):
    """A motion at the vertical."""

    disk: Disk = option(DISK, "as for run", default=Disk.uniform())
    sigma3_bar: float = option(NUMBER, "sigma3 at the vertical, in the units of the disk", required=True)
    eta_hat: float = option(
        NUMBER, "distance from the falling set, in the units of the disk; 0 is the fall itself", required=True
    )
    phidot: float = option(
        Reader(partial(number, low=0.0), "X", "float | str"),
        "speed at the vertical towards the flat state, 0 or more, in the units of the disk",
        required=True,
    )
    face: int = option(Reader(sign, "X", "int | str"), "flat state, 1 or -1", default=1)
    accuracy: float = option(NUMBER._replace(metavar="TOL"), "as for run", default=1e-6)
    method: str = option(word_of(*METHODS), "as for run", default="auto")
    window: float | None = option(
        NUMBER._replace(metavar="Q"), "start and stop the passage at this cos phi: 1 is upright, 0 is flat"
    )


def passage_report(start: PassageOptions) -> dict[str, Any]:
    """What `nearflat passage --json` prints. Quantities that do not exist are None."""
    disk, at = start.disk, (start.sigma3_bar, start.eta_hat, start.phidot)
    how: dict[str, Any] = {"method": start.method, "accuracy": start.accuracy, "window": start.window}
    made = passages(disk, *at, start.face, **how)
    status = compiled.status.Status(int(made.status))
    report: dict[str, Any] = {"disk": disk.name, "face": start.face, "status": status.name.lower()}
    report |= {name: getattr(made, name) for name in _NUMBERS}
    report |= {"method": made.method, "model": made.model, "accuracy": start.accuracy, "warnings": []}
    if status == compiled.status.Status.FALLS:  # what the passage tends to from each side
        report["limits"] = {
            name: {
                "race_angle": race,
                "delta_chi": report["fall_angle"] + race,
                "psi_jump": start.face * race,
            }
            for name, race in (("plus", disk.race_limit), ("minus", -disk.race_limit))
        }
    elif status == compiled.status.Status.OK:
        forces = passage_forces(disk, *at)
        normal, friction = float(forces.min_normal_force), float(forces.max_friction)
        report |= {
            "min_normal_force": normal,
            "max_friction": friction,
            "warnings": _physicality(normal, friction),
        }
    else:
        report["warnings"] = [f"{status.sentence} {status.remedy}"]
    return dict(plain(report))


def _physicality(normal: float, friction: float) -> list[str]:
    falls = f"the normal force falls to {normal if abs(normal) > _ROUNDING else 0.0:.3g} m g"
    if normal < -_ROUNDING:
        return [f"the model keeps contact, but {falls}: a real disk would lift off"]
    if normal < _ROUNDING:
        return [f"the model does not slip, but {falls}, where no friction holds a disk"]
    needs = f"the model does not slip, but this motion needs a friction coefficient of {friction:.3g}"
    return [needs] if friction > 1.0 else []


def passage_text(report: dict[str, Any], disk: Disk) -> str:
    """The report as lines of text."""
    lines = []
    for name, value in report.items():
        if isinstance(value, str | int):
            lines.append(f"{name:18} {value}")
        elif isinstance(value, float) and name != "accuracy":
            unit = "m g" if name == "min_normal_force" else unit_of(name, disk)
            lines.append(f"{name:18} {value:.12g} {unit}".rstrip())
    for name, values in report.get("limits", {}).items():
        sign = ">" if name == "plus" else "<"
        lines += [f"limit, eta {sign} 0     {key} {value:+.12g} rad" for key, value in values.items()]
    return "\n".join(lines)


add_arguments = PassageOptions.add_to


def call(options: argparse.Namespace) -> Answer:
    """Say what is known of the passage."""
    start = PassageOptions.of(PassageOptions.said(options))
    called = (*passage_kernels(plan(OBSERVABLES, start.accuracy, start.method)), *FORCES)
    compiled.warmup(called, lambda text: note(text, options.quiet))
    report = passage_report(start)
    for warning in report["warnings"]:
        note(f"nearflat passage: {warning}", options.quiet)
    return Answer(report, passage_text(report, start.disk), 0 if report["status"] in ("ok", "falls") else 1)
