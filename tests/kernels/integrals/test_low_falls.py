"""Falls on F from rest below the vertical, in lanes, against the adaptive rule."""

import numpy as np
import pytest
from conftest import BODIES

from explorer.motion.passages_by_quadrature import departures_of_energy
from explorer.phase.gauss import packed_rules
from kernels.integrals.low_falls import low_fall_batch
from kernels.integrals.passages import fall_by_rules_batch
from kernels.integrals.point import VERTICAL, Point, point_batch


def from_rest(disk, n, seed):
    """(sigma3_bar, energy) of falls that begin at rest at some tilt."""
    rng = np.random.default_rng(seed)
    bar, h = rng.uniform(-1.0, 1.0, n), rng.uniform(0.05, 1.3, n)
    b, energy, out = disk.body, np.empty(n), np.empty((7, 1))
    for i in range(n):
        X = bar[i] / b.r0
        point_batch(h[i : i + 1], X, 0.0, disk.natural, out)
        energy[i] = Point(*out).V[0] + 0.5 * b.J * (X / b.k) ** 2
    return bar, energy


@pytest.mark.parametrize("name", ["uniform", "hoop", "thick", "coin"])
def test_falls_from_rest_are_those_of_the_adaptive_rule(name):
    disk, n = BODIES[name], 300
    bar, energy = from_rest(disk, n, 1)
    best = np.full((4, n), np.nan)
    departures = departures_of_energy(disk, bar, energy)
    fall_by_rules_batch(departures, VERTICAL, packed_rules(), disk.natural, best)
    for first, accuracy in ((1, 1e-2), (4, 1e-6), (8, 1e-10)):
        found = np.full((4, n), np.nan)
        low_fall_batch(bar, energy, first, accuracy, disk.leg_tables, disk.natural, found)
        known = ~np.isnan(found[0])
        assert known.mean() > 0.9
        errors = abs(found - best)[:3, known]
        assert (errors <= 10.0 * (found[3] + best[3])[known]).all()
        assert np.percentile(errors, 99) <= accuracy


def test_falls_that_reach_the_vertical_and_none_at_all_stay_unknown():
    disk = BODIES["uniform"]
    bar, out = np.array([0.5, 0.5, 0.5]), np.full((4, 3), np.nan)
    out[:, 2] = 7.0
    low_fall_batch(bar, np.array([5.0, -1.0, 0.7]), 2, 1e-4, disk.leg_tables, disk.natural, out)
    assert np.isnan(out[:, :2]).all()
    assert (out[:, 2] == 7.0).all()
