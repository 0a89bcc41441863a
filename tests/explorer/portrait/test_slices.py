"""Slices of the phase space: tilts and sides against motions that are followed."""

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.portrait.slices import Slice, map_slice

UNIFORM, HOOP = BODIES["uniform"], BODIES["hoop"]


@pytest.fixture(scope="module")
def slice_of_uniform():
    return map_slice(UNIFORM, Slice.defaults(UNIFORM)[0], 61)


@pytest.mark.parametrize("number", [0, 1])
def test_the_tilt_by_quadrature_is_that_of_the_integrated_slices(number):
    where = Slice.defaults(HOOP)[number]
    one, other = map_slice(HOOP, where, 31), map_slice(HOOP, where, 31, "dopri5")
    both = np.isfinite(one.theta_min) & np.isfinite(other.theta_min)
    assert both.mean() > 0.98
    np.testing.assert_allclose(one.theta_min[both], other.theta_min[both], rtol=3e-3)


def test_the_side_is_the_direction_of_the_contact_point_at_the_flattest_moment(slice_of_uniform):
    """Against passages from the vertical, where chi is integrated: its sign near F."""
    at = slice_of_uniform
    x, y = np.meshgrid(at.x, at.y)
    known = ex.constants(ex.phi_to_states(UNIFORM, 0.0, 1.0, x, y))
    face = np.ravel(slice_of_uniform.face)
    eta = np.where(face > 0, known.eta_hat_plus, known.eta_hat_minus)
    near = (abs(eta) < 0.1) & (abs(eta) > 1e-3) & (np.ravel(slice_of_uniform.side) != 0)
    assert near.sum() > 100
    turned = ex.passages(UNIFORM, known.sigma3_bar[near], eta[near], 1.0, face[near]).race_angle
    np.testing.assert_array_equal(np.sign(turned), np.ravel(slice_of_uniform.side)[near])


def test_the_colours_change_on_f_and_the_tilt_vanishes_there(slice_of_uniform):
    """Along a column the strongest cells of the two colours are the neighbours of l_+ and l_-."""
    at = slice_of_uniform
    slope = 0.7285923160189477
    column = int(np.argmin(abs(at.x - 1.0)))
    tilt, side = at.theta_min[:, column], slice_of_uniform.side[:, column]
    for line in (slope, -slope):
        above = int(np.searchsorted(at.y, line * at.x[column]))
        assert {side[above - 1], side[above]} == {-1, 1}
        assert max(tilt[above - 1], tilt[above]) < 0.1
    assert np.median(tilt[side != 0]) > 0.2


@pytest.mark.parametrize(("asked", "done"), [("auto", "quadrature"), ("dopri5", "dopri5"), ("rk8", "rk8")])
def test_a_slice_says_how_it_was_computed(asked, done):
    assert map_slice(UNIFORM, Slice.defaults(UNIFORM)[0], 3, asked).method == done


@pytest.mark.parametrize("points", [1, 4001, 2.5, True, "many"])
def test_a_number_of_points_that_cannot_be_is_named(points):
    with pytest.raises(ex.InputError, match="points = "):
        map_slice(UNIFORM, Slice.defaults(UNIFORM)[0], points)
