"""Passages as users get them, from what a method followed."""

import math

import numpy as np
import pytest
from conftest import BODIES

from kernels.near_flat import races
from kernels.status import Status

N = 6


def measured(error, status, eta, allowed=1.0):
    """Rows of six passages with energies of their own, and their status."""
    column = np.linspace(1.0, 2.0, N)
    samples = races.Samples(
        sigma3_bar=0.3 * column,
        eta=np.array(eta),
        speed=column,
        face=np.array([1.0, -1.0] * 3),
        theta_min=0.1 * column,
        chi=7.0 * column,
        psi=3.0 * column,
        time=column,
        turn_rate=np.full(N, 0.5),
        energy=2.0 * column,
        error=np.array(error),
        status=np.array(status, np.int8),
    )
    disk, out = BODIES["thick"], np.empty((12, N))
    level = samples.energy - disk.energy_at_flat(samples.sigma3_bar)
    terms, units = races.Terms(allowed, 1e-9, 0.0), races.Units(2.0, 3.0, 5.0, 7.0)
    falls = races.Falls(time=column, chi=0.1 * column, level=level, error=np.full(N, 1e-9))
    races.race_batch(samples, falls, terms, units, disk.natural, 0, out)
    return samples, races.RaceRow(*out)


def test_a_race_is_chi_less_the_fall_and_units_are_the_users():
    samples, race = measured([1e-7] * N, [0] * N, [0.1, -0.1] * 3)
    disk, fall_chi = BODIES["thick"], 0.1 * np.linspace(1.0, 2.0, N)
    assert (race.fall_angle == 2.0 * fall_chi).all()
    assert (race.race_angle == samples.chi - 2.0 * fall_chi).all()
    assert (race.delta_psi == samples.psi * samples.face).all()
    assert (race.duration, race.energy) == (pytest.approx(2.0 * samples.time), pytest.approx(3.0 * samples.energy))
    assert (race.limit == [7.0, -7.0] * 3).all()
    assert (race.wrong_way == [0.0, 1.0] * 3).all()
    above = samples.energy - disk.energy_at_flat(samples.sigma3_bar)
    assert race.impact_speed == pytest.approx(5.0 * np.sqrt(2.0 * above / disk.body.M), rel=1e-14)


def test_what_misses_is_refused_and_what_is_not_known_is_no_number():
    ok, falls, bad = int(Status.OK), int(Status.FALLS), int(Status.BAD_INPUT)
    samples, race = measured(
        [0.5, 2.0, math.nan, 0.1, math.nan, 0.1], [ok, ok, falls, ok, bad, ok], [0.1] * 4 + [0.0] * 2
    )
    assert samples.status.tolist() == [ok, int(Status.STEP_LIMIT), falls, ok, bad, ok]
    known = np.array([1, 0, 0, 1, 0, 1], bool)
    for name in ("race_angle", "delta_chi", "delta_psi", "duration"):
        assert (np.isfinite(getattr(race, name)) == known).all()
    assert np.isfinite(race.fall_time).tolist() == (samples.status == falls).tolist()
    assert np.isnan(race.theta_min).tolist() == [False, True, False, False, True, False]
    assert race.theta_min[2] == 0.0
    assert np.isnan(race.limit).tolist() == (samples.status == bad).tolist()
