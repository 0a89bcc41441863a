"""Steady motions: what the potential says of them, motions that are followed, and thresholds."""

import math

import numpy as np
import pytest
from conftest import BODIES
from scipy.optimize import brentq

import explorer as ex
from explorer.phase.bifurcation import (
    PATHS,
    bifurcation,
    fold_curve,
    last_unstable_tilt,
    rolling_threshold,
    spinning_threshold,
    stability_edges,
    whole_path,
)
from explorer.phase.falling_set import well
from explorer.phase.potential import CENTRE, SADDLE

UNIFORM = BODIES["uniform"]


def steady(disk, phi, precession):
    """The steady motion at a tilt from the vertical, its constants and its potential."""
    motion = ex.steady_motions(disk, 0.5 * np.pi - abs(phi), precession, face=np.sign(phi))
    found = ex.constants(motion.states)
    return motion, found, ex.potential(disk, found.sigma3_bar, sigma4_bar=found.sigma4_bar)


def test_closed_forms_of_the_thresholds_are_those_of_v(body):
    """V'' of the upright motions changes its sign there, and V' vanishes on the circle."""
    roll, spin = rolling_threshold(body), spinning_threshold(body)
    for side in (-1.0, 1.0):
        for upright in (
            ex.potential(body, 0.0, sigma4_bar=roll * (1.0 + side * 1e-9)),
            ex.potential(body, spin * (1.0 + side * 1e-9), sigma4_bar=0.0),
        ):
            assert np.sign(upright.d2V(0.0)) == side
    for lean, radius in ((0.1, 5.0), (0.7, 1.0), (1.4, 2.0)):
        rate = ex.circular_rolling(body, lean, radius * body.r).precession
        slopes = [steady(body, -lean, rate)[2].dV(-lean + step) for step in (-1e-9, 1e-9)]
        assert slopes[0] * slopes[1] < 0.0


def test_thresholds_of_the_uniform_disk_and_the_hoop():
    """g/3r and g/4r for straight rolling, 4g/5r and 2g/3r for spinning."""
    for name, rolls, spins in (("uniform", 1 / 3, 4 / 5), ("hoop", 1 / 4, 2 / 3)):
        assert rolling_threshold(BODIES[name]) ** 2 == pytest.approx(rolls, rel=1e-9)
        assert spinning_threshold(BODIES[name]) ** 2 == pytest.approx(spins, rel=1e-9)


def test_steady_motions_solve_the_potential_and_simulate_as_circles(paper_body):
    disk = paper_body
    for phi, precession in ((-0.7, 1.3), (0.4, -2.0), (-1.3, 0.8)):
        motion, _, potential = steady(disk, phi, precession)
        assert abs(float(potential.dV(phi))) < 1e-13 * (1.0 + precession**2)
        assert (float(potential.d2V(phi)) > 0.0) == motion.stable
        assert min(abs(at.phi - phi) for at in potential.equilibria) < 1e-12
        run = ex.simulate(motion.states, 3.0, observables=("phi", "chi", "contact"), accuracy=1e-10)
        assert abs(run.phi - phi).max() < 1e-9
        assert run.chi[-1] == pytest.approx(3.0 * precession, rel=1e-9)
        # The contact point keeps its distance from the centre of its circle
        centre = run.contact[:, :2] + motion.radius * np.stack([np.cos(run.chi), np.sin(run.chi)], axis=1)
        assert abs(centre - centre[0]).max() < 1e-8


def test_saddle_nodes_have_no_slope_and_no_curvature_and_meet_the_line_where_the_well_ends(body):
    last = last_unstable_tilt(body)
    phi = last * np.array([-0.99, -0.6, -0.1, 0.3, 0.8])
    for precessions in stability_edges(body, phi):
        for tilt, rate in zip(phi, precessions, strict=True):
            potential = steady(body, tilt, rate)[2]
            size = body.energy_unit
            assert abs(float(potential.dV(tilt))) < 1e-12 * size
            assert abs(float(potential.d2V(tilt))) < 1e-11 * size
    assert np.isnan(stability_edges(body, [1.001 * last, -1.3])).all()

    def off_line(t):
        tilt = -last * math.sin(t)
        return steady(body, tilt, stability_edges(body, tilt)[1, 0])[1].eta_hat_plus

    at = brentq(off_line, 0.5, 0.5 * math.pi - 1e-6)
    tilt = -last * math.sin(at)
    found = steady(body, tilt, stability_edges(body, tilt)[1, 0])[1]
    angle, most = well(body)
    assert abs(found.sigma3_bar) == pytest.approx(most * body.rate_unit, rel=1e-9)
    assert tilt == pytest.approx(angle, abs=1e-5)


@pytest.mark.parametrize("path", ["spinning", "rolling", "line"])
def test_branches_of_a_path_change_at_its_threshold(path):
    branches, threshold = whole_path(UNIFORM, path), PATHS[path].threshold(UNIFORM)
    saddles = np.concatenate([branch.parameter for branch in branches if branch.kind == SADDLE])
    assert saddles.max() == pytest.approx(threshold, rel=1e-6)
    assert saddles.max() < threshold
    assert saddles.min() == -saddles.max()
    outside = [b for b in branches if b.parameter.min() > threshold]
    assert {b.kind for b in outside} == (set() if path == "line" else {CENTRE})


def test_the_fold_parts_one_steady_motion_from_three():
    x, y = fold_curve(UNIFORM)
    assert (x[0], y[0]) == (x[-1], y[-1])
    assert abs(x).max() == pytest.approx(spinning_threshold(UNIFORM), rel=1e-3)
    assert abs(y).max() == pytest.approx(rolling_threshold(UNIFORM), rel=1e-3)
    for i in range(5, x.size, 157):
        inside, outside = (ex.potential(UNIFORM, s * x[i], sigma4_bar=s * y[i]).equilibria for s in (0.99, 1.01))
        assert (len(inside), len(outside)) == (3, 1)


def test_the_fold_is_one_curve_without_a_jump(body):
    """Also at its cusps, where the two edges of instability meet within rounding."""
    x, y = fold_curve(body, 100)
    steps = np.hypot(np.diff(x) / np.ptp(x), np.diff(y) / np.ptp(y))
    assert steps.max() < 0.02


def test_bad_arguments_get_a_sentence():
    with pytest.raises(ex.InputError, match="lean = 2"):
        ex.circular_rolling(UNIFORM, 2.0, 1.0)
    with pytest.raises(ex.InputError, match="radius = -1"):
        ex.circular_rolling(UNIFORM, 1.0, -1.0)
    with pytest.raises(ex.InputError, match="rolls round circles above"):
        ex.circular_rolling(UNIFORM, 1.0, 0.1)
    with pytest.raises(ex.InputError, match="path 'up' is not known"):
        bifurcation(UNIFORM, "up", [0.1])
