"""Constants of motion as users get them."""

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.phase.constants import constants
from explorer.phase.coordinates import constants_to_states


def test_at_the_vertical_the_constants_are_the_state_itself(body):
    unit = body.rate_unit
    found = ex.constants(
        ex.phi_to_states(body, 0.0, 0.3 * unit, [1.0 * unit, -0.4 * unit], [0.6 * unit, 0.9 * unit])
    )
    np.testing.assert_allclose(found.sigma3_bar, [unit, -0.4 * unit], rtol=1e-14)
    np.testing.assert_allclose(found.sigma4_bar, [0.6 * unit, 0.9 * unit], rtol=1e-13)
    b = body.body
    eta = body.eta_unit * (b.I1 * b.dr0 * np.array([1.0, -0.4]) - b.I3 * b.r0 * np.array([0.6, 0.9]))
    np.testing.assert_allclose(found.eta_plus, eta, rtol=1e-13)


def test_energy_is_eq_2_19_in_the_units_of_the_disk(body):
    phi, phidot, s3, s4 = 0.4, 1.3 * body.rate_unit, 0.7 * body.rate_unit, -0.2 * body.rate_unit
    q2 = np.cos(phi) ** 2
    mr2 = body.m * body.r**2
    want = (
        (body.I1 + mr2) * phidot**2 / 2
        + body.I1 * s3**2 / q2 / 2
        + (body.I3 + mr2) * s4**2 / 2
        + body.m * body.g * body.r * np.cos(phi)
    )
    assert ex.constants(ex.phi_to_states(body, phi, phidot, s3, s4)).energy == pytest.approx(want, rel=1e-14)


def test_mirror_images_have_mirrored_constants(body):
    """Eq. (3.2): (sigma1, sigma3, sigma4) -> (-sigma1, -sigma3, sigma4), and so on."""
    rng = np.random.default_rng(0)
    phi, rates = rng.uniform(-1.5, 1.5, 30), rng.uniform(-2, 2, (3, 30)) * body.rate_unit
    plain = ex.constants(ex.phi_to_states(body, phi, *rates))
    flipped = ex.constants(ex.phi_to_states(body, -phi, -rates[0], rates[1], -rates[2]))
    np.testing.assert_array_equal(plain.sigma3_bar, flipped.sigma3_bar)
    np.testing.assert_array_equal(plain.eta_plus, flipped.eta_minus)
    np.testing.assert_array_equal(plain.energy, flipped.energy)
    other = ex.constants(ex.phi_to_states(body, -phi, -rates[0], -rates[1], rates[2]))
    np.testing.assert_array_equal(plain.eta_plus, -other.eta_minus)


def test_a_state_at_given_eta_hat_reports_it(paper_body):
    eta_hat = np.array([1e-2, -1e-4, 1e-6, -1e-10])
    for face in (1, -1):
        found = constants(constants_to_states(paper_body, 1.3, eta_hat, 0.5, face))
        got = found.eta_hat_plus if face > 0 else found.eta_hat_minus
        np.testing.assert_allclose(got, eta_hat, atol=2e-15)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_bad_input_is_flagged_and_its_neighbours_are_untouched(bad):
    disk = BODIES["uniform"]
    for place in range(4):
        columns = np.ones((4, 3)) * [[0.3], [0.5], [0.7], [0.2]]
        columns[place, 1] = bad
        found = ex.constants(ex.phi_to_states(disk, *columns))
        assert found.status.tolist() == [ex.Status.OK, ex.Status.BAD_INPUT, ex.Status.OK]
        clean = ex.constants(ex.phi_to_states(disk, 0.3, 0.5, 0.7, 0.2))
        assert found.sigma3_bar[0] == found.sigma3_bar[2] == clean.sigma3_bar
        assert np.isnan([found.sigma3_bar[1], found.eta_plus[1], found.energy[1]]).all()


@pytest.mark.parametrize("phi", [np.pi / 2, -np.pi / 2, 2.0, 7.0])
def test_flat_and_impossible_tilts_are_bad_input(phi):
    assert ex.constants(ex.phi_to_states(BODIES["uniform"], phi, 0, 1, 1)).status == ex.Status.BAD_INPUT


def test_a_body_without_axial_inertia_has_eta_but_no_eta_hat():
    disk = ex.Disk(I1=0.3, I3=0.0)
    found = ex.constants(ex.phi_to_states(disk, 0.2, 0.1, 0.5, 0.4))
    assert np.isnan(found.eta_hat_plus)
    assert found.eta_plus == pytest.approx(0.3 * 0.5)  # eta = I1 sigma3, which is constant
    with pytest.raises(ex.InputError, match="I3 = 0"):
        ex.falls(ex.phi_to_states(disk, 0.2, 0.1, 0.5, 0.4))
