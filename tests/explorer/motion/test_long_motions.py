"""One motion over a thousand passages near flat."""

import numpy as np
import pytest
from conftest import BODIES
from motions import trajectories

import explorer as ex

COIN = BODIES["coin"]
NAMES = ("sigma3_bar", "eta_hat_plus", "energy")


@pytest.mark.parametrize("accuracy", [1e-4, 1e-8])
def test_constants_stay_bounded_and_angles_drift_in_proportion(accuracy):
    unit = COIN.rate_unit
    start, counts = (
        ex.constants_to_states(COIN, unit, 0.01 * unit, unit),
        np.unique(np.geomspace(1, 1000, 31).round()),
    )
    whole, first = ex.periods(start, accuracy=1e-11), ex.constants(start)
    observables = ("phi", "phidot", "sigma3", "sigma4", "chi")
    times = counts * whole.period
    how = {"observables": observables, "method": "dop853", "accuracy": accuracy, "max_steps": 10**7}
    motion = trajectories(start, None, times, **how)
    *state, chi = (getattr(motion, name) for name in observables)
    now = ex.constants(ex.phi_to_states(COIN, *state))
    assert max(abs(getattr(now, name) / getattr(first, name) - 1.0).max() for name in NAMES) < accuracy
    drift = abs(chi - counts * whole.chi)
    assert drift[-1] < accuracy * 1000
    assert np.polyfit(np.log(counts[-8:]), np.log(drift[-8:]), 1)[0] == pytest.approx(1.0, abs=0.15)
