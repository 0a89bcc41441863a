"""Measures MEASURED of explorer/motion/calibration.py and prints it: the errors of all integrators by setting.

python tests/tools/report_calibration.py      # some ten seconds once compiled
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from reference_samples import ReferencePassages, through_time

import explorer as ex
from explorer.motion.calibration import MEASURED
from explorer.motion.passage_starts import starts_at_vertical
from explorer.motion.plan import plan

BODIES = (ex.Disk.uniform(), ex.Disk.hoop(), ex.Disk(I1=0.02, I3=0.04), ex.Disk(I1=0.5, I3=0.3))
PASSAGES, MOTIONS = 1024, 128


def error_of(samples, method, setting):
    """The 99th percentile of the errors at a setting, where no sample is refused for its error."""
    how = replace(plan(samples.observables, 1e-11, method), setting=setting)  # falls to 1e-11
    tried = samples.compare(samples.call(how))
    return np.nanpercentile(np.where(samples.exact.ok, tried.errors, np.nan), 99)


def starts(count, seed):
    """sigma3_bar, eta_hat, phidot and face at the vertical, at distances from F from 1e-8 to 1."""
    rng = np.random.default_rng(seed)
    eta_hat = 10.0 ** rng.uniform(-8.0, 0.0, count) * rng.choice([-1.0, 1.0], count)
    return rng.uniform(-2.0, 2.0, count), eta_hat, rng.uniform(0.3, 2.0, count), np.ones(count)


def main():
    samples = [
        made
        for seed, disk in enumerate(BODIES)
        for made in (
            ReferencePassages(disk, starts_at_vertical(disk, *starts(PASSAGES, seed))),
            through_time(ex.constants_to_states(disk, *starts(MOTIONS, seed)), None),
        )
    ]
    print("MEASURED = {")
    for method, (settings, _) in MEASURED.items():
        errors = [max(error_of(each, method, setting) for each in samples) for setting in settings]
        print(f'    "{method}": ({settings}, ({", ".join(f"{error:.3g}" for error in errors)})),')
    print("}")


if __name__ == "__main__":
    main()
