"""Measures MEASURED of explorer/motion/calibration.py and prints it: the errors of all integrators by setting.

python tests/reference/report_calibration.py      # some two minutes
"""

import sys
from pathlib import Path

import numpy as np

import explorer as ex
from explorer.motion.calibration import MEASURED
from explorer.motion.reference_samples import ANY_ERROR, ReferencePassages, through_time
from explorer.motion.vertical import starts_at_vertical

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shares import across, upright

BODIES = (ex.Disk.uniform(), ex.Disk.hoop(), ex.Disk(I1=0.02, I3=0.04), ex.Disk(I1=0.5, I3=0.3))
PASSAGES, MOTIONS = 1024, 128


def error_of(samples, method, setting):
    """The 99th percentile of the errors at a setting, where no sample is refused for its error."""
    tried = samples.compare(samples.call(samples.plan(method, ANY_ERROR, setting)), ANY_ERROR)
    return np.nanpercentile(np.where(samples.known, tried.errors, np.nan), 99)


def main():
    samples = [
        made
        for seed, disk in enumerate(BODIES)
        for made in (
            ReferencePassages(disk, starts_at_vertical(disk, *across(disk, PASSAGES, seed))),
            through_time(upright(disk, MOTIONS, seed), None),
        )
    ]
    print("MEASURED = {")
    for method, (settings, _) in MEASURED.items():
        errors = [max(error_of(each, method, setting) for each in samples) for setting in settings]
        print(f'    "{method}": ({settings}, ({", ".join(f"{error:.3g}" for error in errors)})),')
    print("}")


if __name__ == "__main__":
    main()
