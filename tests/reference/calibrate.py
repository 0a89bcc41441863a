"""Writes explorer/motion/calibration.json: times here of every method, and its largest errors on several bodies.

`python tests/reference/calibrate.py`, after a change of a step, of `field.pace` or of a method; some minutes.
"""

import json
from pathlib import Path

from explorer.commands.trade import Trading
from explorer.motion import calibration
from explorer.motion.work_precision import curves, largest_errors, measure, only_errors
from explorer.phase.disk import Disk

BODIES = (Disk.uniform(), Disk.hoop(), Disk(I1=0.02, I3=0.04), Disk(I1=0.5, I3=0.3))


def main():
    parts = [measure(samples, print) for samples in Trading().reference_samples()]
    bodies = [Trading(disk=disk, samples=1024, motions=64, seed=number) for number, disk in enumerate(BODIES)]
    others = [only_errors(samples) for body in bodies for samples in body.reference_samples()]
    table = {
        "measured_on": "passages as nearflat trade draws them by default",
        "quadrature": [row.nanoseconds for row in parts[0].rows if row.method == "quadrature"][-1],
        "methods": curves(parts[0], largest_errors([part.rows for part in parts], others)),
    }
    calibration.parse(table, "")
    Path(calibration.__file__).with_suffix(".json").write_text(json.dumps(table, indent=1) + "\n")


if __name__ == "__main__":
    main()
