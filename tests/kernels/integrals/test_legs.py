"""Legs in lanes against adaptive rules and forty digits: errors are told, few nodes serve coarse accuracies."""

import json
from pathlib import Path

import numpy as np
import pytest
from conftest import BODIES
from passing import orbits_anywhere

import explorer as ex
from explorer.motion.legs import first_rule, legs_of
from explorer.motion.starts import orbit_starts
from explorer.phase.constants import natural_constants
from explorer.phase.gauss import packed_rules
from kernels.integrals.legs import leg_batch
from kernels.integrals.orbits import OrbitRow, orbit_batch, orbits_of_legs
from kernels.integrals.point import Orbits

ROWS = json.loads((Path(__file__).parents[2] / "reference" / "wobbles.json").read_text(encoding="utf-8"))


def periods(disk, orbits, accuracy):
    """Periods by legs alone; NaN where lanes do not settle them."""
    n = orbits.h.size
    out, status = np.empty((8, n)), np.zeros(n, np.int8)
    ends, legs, _upright = legs_of(disk, orbits, status, accuracy, 2)
    orbits_of_legs(orbits, ends, legs, disk.natural, out, status)
    return OrbitRow(*out)


@pytest.mark.parametrize("name", ["uniform", "hoop", "heavy-core", "thick"])
def test_errors_of_legs_are_told(name):
    disk, n = BODIES[name], 400
    orbits, best, status = orbits_anywhere(disk, n, 1), np.full((8, n), np.nan), np.zeros(n, np.int8)
    orbit_batch(orbits, 1e-11, packed_rules(), disk.natural, best, status)
    best = OrbitRow(*best)
    for accuracy in (1e-2, 1e-4, 1e-6, 1e-9):
        found = periods(disk, orbits, accuracy)
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
    disk, n = ex.Disk(*moments), 1000
    orbits, best, status = orbits_anywhere(disk, n, 5, -8.0), np.full((8, n), np.nan), np.zeros(n, np.int8)
    orbit_batch(orbits, 1e-11, packed_rules(), disk.natural, best, status)
    best = OrbitRow(*best)
    for accuracy in (1e-3, 1e-5, 1e-7):
        found = periods(disk, orbits, accuracy)
        both = np.isfinite(found.time) & (status == 0)
        assert both.sum() > 10
        angle = np.fmax(abs(found.chi - best.chi), abs(found.psi - best.psi))[both]
        assert (angle <= 10.0 * (found.angle_error + best.angle_error)[both]).all()


@pytest.mark.parametrize("disk", [BODIES["hoop"], BODIES["thick"], ex.Disk(I1=5.0, I3=3.0)], ids=str)
def test_errors_of_slow_crossings_are_told_also_below_the_energy_of_flat(disk):
    """The last coefficients may be small there while those behind them are not."""
    rng, n = np.random.default_rng(21), 1500
    speed, sides = 10.0 ** rng.uniform(-4.0, -1.0, n), rng.choice([-1.0, 1.0], n)
    states = ex.phi_to_states(disk, 1e-4 * sides, speed, *rng.normal(0.0, 0.8, (2, n)))
    orbits = orbit_starts(states, natural_constants(states).linear)
    best, status = np.full((8, n), np.nan), np.zeros(n, np.int8)
    orbit_batch(orbits, 1e-9, packed_rules(), disk.natural, best, status)
    best = OrbitRow(*best)
    for accuracy in (1e-3, 1e-5, 1e-7):
        found = periods(disk, orbits, accuracy)
        known = np.isfinite(found.time) & (status == 0)
        assert known.mean() > 0.3
        assert (abs(found.chi - best.chi) <= 2.5 * found.angle_error + best.angle_error)[known].all()
        time = abs(found.time - best.time)
        assert (time <= (2.5 * found.time_error + best.time_error) * best.time)[known].all()


def test_wobbles_that_legs_answer_are_those_of_forty_digits():
    """Smaller ones are known to rounding of E - V only, and left to series where that is too little."""
    known = dict.fromkeys((0.01, 1e-05, 1e-09), 0)
    for row in ROWS:
        disk = ex.Disk(I1=row["I1"], I3=row["I3"])
        b, bar = disk.body, row["sigma3_bar"]
        near = row["eta_hat"] * b.I3 * b.r0
        theta, far = row["theta"], 2.0 * b.I1 * b.dr0 * bar - near
        columns = 2.0 * np.sin(0.5 * theta), row["rate"], bar, near, far, np.cos(theta)
        for accuracy in known:
            found = periods(disk, Orbits(*(np.array([column]) for column in columns)), accuracy)
            if np.isfinite(found.time[0]):
                known[accuracy] += 1
                angle = max(abs(found.chi[0] - float(row["chi"])), abs(found.psi[0] - float(row["psi"])))
                assert angle <= 10.0 * found.angle_error[0]
                assert abs(found.time[0] / float(row["period"]) - 1.0) <= 10.0 * found.time_error[0]
                assert found.angle_error[0] <= 2.0 * max(accuracy, 1e-11 * abs(found.chi[0]))
    assert known[1e-2] >= known[1e-5] >= known[1e-9] > 0


def test_a_coarse_accuracy_takes_few_nodes():
    """At 1e-2 eight nodes are enough for nine legs of ten, at 1e-9 for hardly any."""
    disk, n = BODIES["uniform"], 400
    orbits, tables = orbits_anywhere(disk, n, 2, least=-1.0), disk.leg_tables
    few = tables.sizes[tables.sizes <= 8]
    short = tables._replace(sizes=few, rules=np.ascontiguousarray(tables.rules[:, : few.sum()]))
    settled = {}
    for accuracy in (1e-2, 1e-9):
        ends, every, _upright = legs_of(disk, orbits, np.zeros(n, np.int8), accuracy, 3)
        out = np.full((5, 3 * n), np.nan)
        leg_batch(orbits, ends, 0, accuracy, short, disk.natural, out)
        settled[accuracy] = np.isfinite(out[0]).sum() / np.isfinite(every[0]).sum()
    assert settled[1e-2] > 0.85
    assert settled[1e-9] < 0.3
    assert first_rule(1e-2) < first_rule(1e-6) < first_rule(1e-10)
