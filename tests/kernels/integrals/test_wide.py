"""Passages that turn far from flat, side by side: against adaptive rules, and what they leave to these."""

import numpy as np
import pytest
from conftest import BODIES

from explorer.phase.disk import Disk
from explorer.phase.gauss import packed_rules
from kernels.integrals import passages
from kernels.integrals.point import VERTICAL
from kernels.integrals.tabulated import WIDEST


def both(disk, sigma3_bar, eta_hat, speed, accuracy):
    """Passages (8, n) by wide rules, NaN where they do not serve, and by adaptive rules; status of these."""
    n = speed.size
    crossings = passages.Crossings(sigma3_bar, eta_hat * disk.body.I3 * disk.body.r0, speed)
    found, status = np.full((2, 8, n), np.nan), np.zeros(n, np.int8)
    passages.wide_batch(crossings, accuracy, disk.tables, disk.natural, found[0], np.zeros(n, np.int8))
    finer, rules = min(accuracy, 1e-9), packed_rules()
    passages.passage_by_rules_batch(crossings, VERTICAL, finer, rules, disk.natural, found[1], status)
    return found, status


@pytest.mark.parametrize("name", ["uniform", "hoop", "thick", "heavy-core"])
@pytest.mark.parametrize("accuracy", [1e-2, 1e-3, 1e-5, 1e-7, 1e-9, 1e-10, 1e-11])
def test_wide_passages_are_those_of_adaptive_rules_within_their_estimates(name, accuracy):
    rng, n = np.random.default_rng(2), 2000
    eta_hat = rng.choice([-1.0, 1.0], n) * 10.0 ** rng.uniform(-1.0, 0.5, n)
    (wide, exact), status = both(
        BODIES[name], rng.uniform(-2, 2, n), eta_hat, 10 ** rng.uniform(-0.5, 0.5, n), accuracy
    )
    answered = np.isfinite(wide[0])
    assert (status == 0).all()
    far = exact[0] > WIDEST
    assert answered[far].mean() > (0.9 if accuracy > 1e-6 else 0.7 if accuracy > 1e-10 else 0.3)
    angles = np.fmax(abs(wide[1] - exact[1]), abs(wide[2] - exact[2]))
    shares = np.fmax(abs(wide[3] / exact[3] - 1.0), abs(wide[0] / exact[0] - 1.0))
    assert (angles <= 10 * wide[5] + exact[5])[answered].all()
    assert (shares <= 10 * wide[6] + exact[6])[answered].all()
    assert (np.fmax(wide[5], wide[6]) <= accuracy)[answered].all()
    assert (np.sign(wide[7]) == np.sign(exact[7]))[answered].all()


@pytest.mark.parametrize("inertia", [(2.0, 0.5), (3.0, 1.0), (1.0, 1.0)])
@pytest.mark.parametrize("accuracy", [1e-5, 1e-6, 1e-8, 1e-10])
def test_estimates_cover_slow_starts_too(inertia, accuracy):
    """Where two rules have failed a third may look converged: those are left to adaptive rules."""
    rng, n = np.random.default_rng(3), 10_000
    eta_hat = rng.choice([-1.0, 1.0], n) * 10.0 ** rng.uniform(-1.0, 0.5, n)
    disk, speed = Disk(I1=inertia[0], I3=inertia[1]), 10.0 ** rng.uniform(-2.0, 1.0, n)
    (wide, exact), status = both(disk, rng.uniform(-4.0, 4.0, n), eta_hat, speed, accuracy)
    answered = np.isfinite(wide[0]) & (status == 0)
    assert answered.sum() > 500
    angles = np.fmax(abs(wide[1] - exact[1]), abs(wide[2] - exact[2]))
    shares = np.fmax(abs(wide[3] / exact[3] - 1.0), abs(wide[0] / exact[0] - 1.0))
    error, estimate = np.fmax(angles, shares), np.fmax(wide[5], wide[6]) + np.fmax(exact[5], exact[6])
    assert (error <= 2.0 * estimate)[answered].all()


def test_what_has_an_answer_is_left_alone():
    disk, one = BODIES["uniform"], np.ones(2)
    crossings = passages.Crossings(one, np.array([0.5, 0.5]), one)
    out, status = np.array([np.zeros(8), np.full(8, np.nan)]).T.copy(), np.zeros(2, np.int8)
    passages.wide_batch(crossings, 1e-3, disk.tables, disk.natural, out, status)
    assert (out[:, 0] == 0.0).all()
    assert np.isfinite(out[:, 1]).all()


def test_a_barrier_between_two_tilts_is_left_to_adaptive_rules():
    """Some of these starts have hardly the energy for the highest point on their way: no answer misses it."""
    disk, n = BODIES["thick"], 4000
    rng = np.random.default_rng(7)
    speed = 10.0 ** rng.uniform(-2, 0, n)
    (wide, exact), status = both(disk, rng.uniform(-4, 4, n), 10.0 ** rng.uniform(-1.5, 0.3, n), speed, 1e-3)
    answered = np.isfinite(wide[0]) & (status == 0)
    assert answered.sum() > 500
    assert abs(wide[0] / exact[0] - 1.0)[answered].max() < 1e-3
