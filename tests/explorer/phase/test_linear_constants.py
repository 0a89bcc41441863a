"""The lines l_+ and l_-, the chart beside them, and the one rule for the nearer face."""

import numpy as np
import pytest

import explorer as ex
from explorer.phase.energy import eta_hat_to_eta
from explorer.phase.linear_constants import line_chart, line_slope, motion_given, nearer_plus, other_eta_hat

SLOPES = {"uniform": 0.7285923160189477, "hoop": 0.6761665138414456, "matching": 0.7079432039590211}


def test_the_lines_have_the_published_slopes(paper_body):
    assert line_slope(paper_body) == pytest.approx(SLOPES[paper_body.name], rel=1e-14)


def test_the_nearer_face_is_that_of_the_smaller_eta_and_plus_in_doubt():
    plus = np.array([1.0, -2.0, 2.0, 0.0, np.nan, 1.0, np.nan])
    minus = np.array([2.0, 1.0, -2.0, 0.0, 1.0, np.nan, np.nan])
    assert nearer_plus(plus, minus).tolist() == [True, False, True, True, True, True, True]


def test_eta_hat_and_eta_are_the_same_in_two_units(body):
    eta_hat = np.array([1e-300, -1e-3, 0.7])
    eta = body.eta_hat_to_eta(eta_hat)
    np.testing.assert_allclose(body.eta_to_eta_hat(eta), eta_hat, rtol=4e-16)
    found = ex.constants(ex.phi_to_states(body, 0.3, *(np.array([[0.4, 0.9, -0.2]]).T * body.rate_unit)))
    np.testing.assert_allclose(body.eta_hat_to_eta(found.eta_hat_plus), found.eta_plus, rtol=1e-15)
    np.testing.assert_allclose(body.eta_to_eta_hat(found.eta_plus), found.eta_hat_plus, rtol=1e-15)


def test_the_chart_gives_the_constants_that_states_have(body):
    rng = np.random.default_rng(5)
    phi, s3, s4 = rng.uniform(-1.5, 1.5, 50), rng.uniform(-2, 2, 50), rng.uniform(-2, 2, 50)
    chart = line_chart(body, np.cos(phi), np.sin(phi))
    determinant = chart.bar_to_sigma3 * chart.eta_hat_to_sigma4 - chart.eta_hat_to_sigma3 * chart.bar_to_sigma4
    np.testing.assert_allclose(determinant, -1.0, rtol=1e-11)
    unit = body.rate_unit
    found = ex.constants(ex.phi_to_states(body, phi, 0.0, s3 * unit, s4 * unit))
    bar, eta_hat = found.sigma3_bar / unit, found.eta_hat_plus / unit
    np.testing.assert_allclose(chart.rates(bar, eta_hat), [s3, s4], atol=1e-11)
    other = other_eta_hat(body, bar, eta_hat) * unit
    np.testing.assert_allclose(other, found.eta_hat_minus, atol=1e-11 * unit)


def test_constants_that_are_given_put_eta_on_the_face_it_was_given_for(body):
    plus = np.array([True, False])
    found = motion_given(body, np.full(2, 0.6), np.full(2, 1e-200), plus)
    eta = eta_hat_to_eta(body.body, 1e-200)
    assert [found.eta_plus[0], found.eta_minus[1]] == [eta, eta]
    b = body.body
    both = 2.0 * b.I1 * b.dr0 * 0.6
    assert [found.eta_minus[0], found.eta_plus[1]] == [both, both]


def test_a_line_needs_axial_inertia():
    with pytest.raises(ex.InputError, match="I3 = 0"):
        line_slope(ex.Disk(I1=0.3, I3=0.0))
