"""Legs in lanes against adaptive rules and forty digits: errors are told, few nodes serve coarse accuracies."""

import json
from pathlib import Path

import numpy as np
from conftest import BODIES
from passing import orbits_anywhere, periods_by_legs

import explorer as ex
from explorer.motion.legs import first_rule, legs_of
from kernels.integrals.legs import leg_batch
from kernels.integrals.point import Orbits

ROWS = json.loads((Path(__file__).parents[2] / "reference" / "wobbles.json").read_text(encoding="utf-8"))


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
            found = periods_by_legs(disk, Orbits(*(np.array([column]) for column in columns)), accuracy)
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
    assert first_rule(disk, 1e-2) < first_rule(disk, 1e-6) < first_rule(disk, 1e-10)
