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


def best_periods(disk, orbits, accuracy=1e-11):
    """Periods as well as adaptive rules tell them, and which they are sure of."""
    out, status = np.full((8, orbits.h.size), np.nan), np.zeros(orbits.h.size, np.int8)
    orbit_batch(orbits, accuracy, packed_rules(), disk.natural, out, status)
    return OrbitRow(*out), status == 0


def angles_missed(found, best):
    """Errors of chi and psi (rad), and what estimates say of them."""
    return np.fmax(abs(found.chi - best.chi), abs(found.psi - best.psi)), found.angle_error + best.angle_error


@pytest.mark.parametrize("name", ["uniform", "hoop", "heavy-core", "thick"])
def test_errors_of_legs_are_told(name):
    disk = BODIES[name]
    orbits = orbits_anywhere(disk, 400, 1)
    best, known = best_periods(disk, orbits)
    for accuracy in (1e-2, 1e-4, 1e-6, 1e-9):
        found = periods_by_legs(disk, orbits, accuracy)
        both = np.isfinite(found.time) & known
        assert np.isfinite(found.time).mean() > (0.9 if accuracy > 1e-9 else 0.5)
        angle, told = angles_missed(found, best)
        time = abs(found.time[both] / best.time[both] - 1.0)
        assert (angle <= 10.0 * told)[both].all()
        assert (time <= 10.0 * (found.time_error + best.time_error)[both]).all()
        assert np.percentile(np.fmax(angle[both], time), 99) <= accuracy


@pytest.mark.parametrize("moments", [(1e-5, 2e-5), (1e-6, 2e-6)])
def test_estimates_know_how_well_tables_hold_a_race_of_many_turns(moments):
    """Of bodies with kappa = 316 and 1000, by legs alone."""
    disk = ex.Disk(I1=moments[0], I3=moments[1])
    orbits = orbits_anywhere(disk, 1000, 5, -8.0)
    best, known = best_periods(disk, orbits)
    for accuracy in (1e-3, 1e-5, 1e-7):
        found = periods_by_legs(disk, orbits, accuracy)
        both = np.isfinite(found.time) & known
        assert both.sum() > 10
        angle, told = angles_missed(found, best)
        assert (angle <= 10.0 * told)[both].all()


@pytest.mark.parametrize(
    "disk", [BODIES["hoop"], BODIES["thick"], ex.Disk(I1=5.0, I3=3.0), ex.Disk(I1=0.25, I3=0.02)], ids=str
)
def test_errors_of_slow_ends_are_told_also_below_the_energy_of_flat(disk):
    """Last coefficients may be small there, and those behind them not, whether the vertical is crossed or not."""
    rng, n = np.random.default_rng(21), 1500
    speed, sides = 10.0 ** rng.uniform(-4.0, -1.0, n), rng.choice([-1.0, 1.0], n)
    states = ex.phi_to_states(disk, 1e-4 * sides, speed, *rng.normal(0.0, 0.8, (2, n)))
    orbits = orbit_starts(states, natural_constants(states).linear)
    best, sure = best_periods(disk, orbits, 1e-9)
    for accuracy in (1e-3, 1e-5, 1e-7):
        found = periods_by_legs(disk, orbits, accuracy)
        known = np.isfinite(found.time) & sure
        assert known.mean() > 0.3
        assert (abs(found.chi - best.chi) <= 2.5 * found.angle_error + best.angle_error)[known].all()
        time = abs(found.time - best.time)
        assert (time <= (2.5 * found.time_error + best.time_error) * best.time)[known].all()
