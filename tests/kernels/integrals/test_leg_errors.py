"""What rules of legs miss is told, of ordinary motions and of those that are slow where a leg ends."""

import numpy as np
import pytest
from conftest import BODIES
from passing import orbits_anywhere, periods_by_legs

import explorer as ex
from explorer.motion.starts import orbit_starts
from explorer.phase.constants import natural_constants
from explorer.phase.gauss import packed_rules
from kernels.integrals.orbits import OrbitRow, orbit_batch


@pytest.mark.parametrize("name", ["uniform", "hoop", "heavy-core", "thick"])
def test_errors_of_legs_are_told(name):
    disk, n = BODIES[name], 400
    orbits, best, status = orbits_anywhere(disk, n, 1), np.full((8, n), np.nan), np.zeros(n, np.int8)
    orbit_batch(orbits, 1e-11, packed_rules(), disk.natural, best, status)
    best = OrbitRow(*best)
    for accuracy in (1e-2, 1e-4, 1e-6, 1e-9):
        found = periods_by_legs(disk, orbits, accuracy)
        both = np.isfinite(found.time) & (status == 0)
        assert np.isfinite(found.time).mean() > (0.9 if accuracy > 1e-9 else 0.5)
        angle = np.fmax(abs(found.chi - best.chi), abs(found.psi - best.psi))[both]
        time = abs(found.time[both] / best.time[both] - 1.0)
        assert (angle <= 10.0 * (found.angle_error + best.angle_error)[both]).all()
        assert (time <= 10.0 * (found.time_error + best.time_error)[both]).all()
        assert np.percentile(np.fmax(angle, time), 99) <= accuracy


@pytest.mark.parametrize("moments", [(1e-5, 2e-5), (1e-6, 2e-6)])
def test_estimates_know_how_well_tables_hold_a_race_of_many_turns(moments):
    """Of bodies with kappa = 316 and 1000, by legs alone."""
    disk, n = ex.Disk(I1=moments[0], I3=moments[1]), 1000
    orbits, best, status = orbits_anywhere(disk, n, 5, -8.0), np.full((8, n), np.nan), np.zeros(n, np.int8)
    orbit_batch(orbits, 1e-11, packed_rules(), disk.natural, best, status)
    best = OrbitRow(*best)
    for accuracy in (1e-3, 1e-5, 1e-7):
        found = periods_by_legs(disk, orbits, accuracy)
        both = np.isfinite(found.time) & (status == 0)
        assert both.sum() > 10
        angle = np.fmax(abs(found.chi - best.chi), abs(found.psi - best.psi))[both]
        assert (angle <= 10.0 * (found.angle_error + best.angle_error)[both]).all()


@pytest.mark.parametrize(
    "disk", [BODIES["hoop"], BODIES["thick"], ex.Disk(I1=5.0, I3=3.0), ex.Disk(I1=0.25, I3=0.02)], ids=str
)
def test_errors_of_slow_ends_are_told_also_below_the_energy_of_flat(disk):
    """Last coefficients may be small there, and those behind them not, whether the vertical is crossed or not."""
    rng, n = np.random.default_rng(21), 1500
    speed, sides = 10.0 ** rng.uniform(-4.0, -1.0, n), rng.choice([-1.0, 1.0], n)
    states = ex.phi_to_states(disk, 1e-4 * sides, speed, *rng.normal(0.0, 0.8, (2, n)))
    orbits = orbit_starts(states, natural_constants(states).linear)
    best, status = np.full((8, n), np.nan), np.zeros(n, np.int8)
    orbit_batch(orbits, 1e-9, packed_rules(), disk.natural, best, status)
    best = OrbitRow(*best)
    for accuracy in (1e-3, 1e-5, 1e-7):
        found = periods_by_legs(disk, orbits, accuracy)
        known = np.isfinite(found.time) & (status == 0)
        assert known.mean() > 0.3
        assert (abs(found.chi - best.chi) <= 2.5 * found.angle_error + best.angle_error)[known].all()
        time = abs(found.time - best.time)
        assert (time <= (2.5 * found.time_error + best.time_error) * best.time)[known].all()
