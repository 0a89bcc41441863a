"""The reduced equations in tilt and in sigma are the same, and hold what they must."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from explorer.paper import four_dimensions
from explorer.paper.checks import BODIES, THICK, sample
from explorer.paper.closed_forms import amended, chaplygin


@pytest.mark.parametrize("face", [1, -1])
def test_the_equations_in_the_tilt_are_those_in_sigma(face):
    phi, phidot, s3, s4 = sample(THICK)
    start = 0.5 * np.pi - face * phi, -face * phidot, s3, s4
    tilt, rate, *momenta = four_dimensions.reduced(THICK, face, start, 1.5).y[:4, -1]
    run = solve_ivp(
        lambda _t, sigma: four_dimensions.sigma_rates(THICK, sigma),
        (0.0, 1.5),
        four_dimensions.sigma_at(phi, phidot, s3, s4),
        "DOP853",
        rtol=1e-12,
        atol=1e-13,
    )
    here = four_dimensions.sigma_at(face * (0.5 * np.pi - tilt), -face * rate, *momenta)
    assert here == pytest.approx(run.y[:, -1], abs=1e-10)


@pytest.mark.parametrize("disk", BODIES, ids=lambda disk: disk.name)
@pytest.mark.parametrize("face", [1, -1])
def test_motions_keep_the_energy(disk, face):
    run = four_dimensions.reduced(disk, face, (1.2, -0.3, 0.6, -0.4), 3.0)
    tilt, rate, s3, s4 = run.y[:4]
    energy = four_dimensions.sigma_energy(disk, four_dimensions.sigma_at(0.5 * np.pi - tilt, -rate, s3, s4))
    assert np.ptp(energy) < 1e-11


@pytest.mark.parametrize("disk", BODIES, ids=lambda disk: disk.name)
@pytest.mark.parametrize("face", [1, -1])
def test_what_is_integrated_down_to_a_tilt_is_the_series_about_the_vertical(disk, face):
    tilts = np.array([1.3, 0.9, 0.5])
    z = face * np.cos(tilts)
    sigma = four_dimensions.rates_down(disk, 0.4, -0.7, face, tilts)
    assert sigma == pytest.approx(np.array(chaplygin(disk, 0.4, -0.7, z)), abs=1e-12)
    assert four_dimensions.potential(disk, tilts, sigma) == pytest.approx(amended(disk, 0.4, -0.7, z), rel=1e-11)
