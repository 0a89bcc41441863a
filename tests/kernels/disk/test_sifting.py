"""States in lanes: kept, counted and judged as single states are."""

import math

import numpy as np
from conftest import BODIES

import explorer as ex
from explorer.measure.log_counts import LOWEST_BIN, PER_DECADE
from explorer.phase.membership import obstacle
from kernels.disk import philox, sifting


def sifted(disk, box, count, near=0.01, **barriers):
    """barriers: what is other in the disk's obstacle."""
    low, high = np.array(box, dtype=float).T.copy()
    keys = philox.round_keys(np.random.Philox(3).state["state"]["key"])
    draw = sifting.Draw(keys, low, high - low, 1000, disk.rate_unit)
    o = obstacle(disk)._replace(**barriers)
    sieve = sifting.Sieve(o, disk.eta_hat_to_eta(1.0), near, float(PER_DECADE), -LOWEST_BIN)
    bins = np.zeros(-2 * LOWEST_BIN, np.int32)
    found = sifting.Found(
        np.zeros(6, np.int64), bins, np.empty(2), np.zeros(3, np.int64), np.full((4, count), np.nan)
    )
    sifting.sift_batch(draw, count, sieve, disk.natural, disk.whole, found)
    return found


def test_every_state_that_is_kept_is_drawn_near_and_could_fall():
    disk, box = BODIES["hoop"], [(-1.4, 1.4), (-2.0, 2.0), (-2.0, 2.0), (-2.0, 2.0)]
    found = sifted(disk, box, 3000)
    kept = found.columns[:, : found.totals[2]]
    random = np.random.Generator(np.random.Philox(3))
    drawn = np.concatenate([-2.0 + 4.0 * random.random((4, 1000)) for _ in range(3)], axis=1)
    drawn[0] *= 0.7
    states = ex.phi_to_states(disk, *drawn)
    place = ex.falls(states)
    constants = ex.constants(states)
    distance = np.where(place.face > 0, constants.eta_hat_plus, constants.eta_hat_minus)
    near = place.could_fall & (abs(distance) <= 0.01)
    assert kept.shape[1] == near.sum() > 5
    np.testing.assert_allclose(kept, drawn[:, near], rtol=1e-15, atol=4e-16)
    assert np.isnan(found.columns[:, found.totals[2] :]).all()
    assert found.totals[0] == place.could_fall.sum() == found.bins.sum()
    assert found.faces.sum() == 3000


def test_starts_from_rest_before_and_behind_the_barrier_are_judged_as_single_states_are():
    """All lanes hold the same state."""
    disk, verdicts = BODIES["uniform"], []
    for phi in np.linspace(-1.2, -0.2, 21):
        found = sifted(disk, [(phi, phi), (0.0, 0.0), (0.05, 0.05), (0.01, 0.01)], 10, near=10.0)
        verdicts.append(bool(ex.falls(ex.phi_to_states(disk, phi, 0.0, 0.05, 0.01)).could_fall[0]))
        assert found.totals[0] == 10 * int(verdicts[-1])
    assert len(set(verdicts)) == 2


def test_what_lanes_leave_open_single_states_decide():
    """With an infinite slack each start beyond the vertical is bisected; the counts are the same."""
    disk, box = BODIES["uniform"], [(-1.4, 0.0), (-2.0, 2.0), (-0.4, 0.4), (-0.4, 0.4)]
    for found, expected in zip(sifted(disk, box, 2000), sifted(disk, box, 2000, slack=math.inf), strict=True):
        np.testing.assert_array_equal(found, expected)
