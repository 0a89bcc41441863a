"""The setting of an integrator for an accuracy: from errors that were measured once, and serve all bodies.

`python tests/tools/report_calibration.py` measures them.
"""

import numpy as np

# The measured error may take half of the accuracy asked: other bodies, boxes and energies err more than those
# measured, and a motion that may err by more than was asked is followed again.
SAFETY = 2.0
# By method, from coarse to fine: steps in units of 1/speed, or tolerances; and the 99th percentile of the error of
# passages and of motions with each. Between two of them errors go like a power of the setting.
MEASURED = {
    "rk4": ((0.25, 0.02, 0.002), (2.41e-3, 1.09e-7, 1.13e-11)),
    "rk8": ((1.6, 1.2, 0.8, 0.08), (1.87e-2, 1.53e-3, 1.46e-5, 3.8e-13)),
    "dopri5": ((3.16e-4, 3.16e-6, 3.16e-9, 3.16e-12), (9.0e-3, 4.04e-5, 1.47e-8, 8.48e-12)),
    "dop853": (
        (1e-2, 1e-3, 1e-5, 1e-6, 1e-7, 1e-10, 1e-13),
        (4.71e-3, 2.25e-4, 3.75e-5, 3.36e-6, 9.21e-7, 7.3e-10, 5.05e-13),
    ),
}


def setting_for(method: str, accuracy: float) -> float:
    """The setting whose error is the accuracy over SAFETY; beyond those measured the first or the last of them."""
    settings, errors = np.log(MEASURED[method])
    return float(np.exp(np.interp(np.log(accuracy / SAFETY), errors[::-1], settings[::-1])))
