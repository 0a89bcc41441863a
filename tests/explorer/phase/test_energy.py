"""The energy and the amended potential, written once, against the kernels that integrate."""

import numpy as np
import pytest

import explorer as ex
from explorer.phase.energy import energy_at
from explorer.phase.potential import Potential


def test_it_is_the_energy_that_states_have(body):
    rng = np.random.default_rng(7)
    phi, p, s3, s4 = rng.uniform(-1.4, 1.4, 50), *rng.uniform(-2.0, 2.0, (3, 50))
    unit, q = body.rate_unit, np.cos(phi)
    found = ex.constants(ex.phi_to_states(body, phi, p * unit, s3 * unit, s4 * unit))
    np.testing.assert_allclose(energy_at(body.body, p, s3 / q, s4, q) * body.energy_unit, found.energy, rtol=1e-13)


def test_at_flat_it_is_the_limit_of_the_potential_on_a_line(body):
    phi = 0.5 * np.pi - np.array([1e-4, 1e-5, 1e-6])
    line = Potential(body, 0.7, 0.0)
    above = (line.V(phi) - body.energy_at_flat(line.sigma3_bar)) / body.energy_unit
    np.testing.assert_allclose(above, 0.0, atol=1e-3)
    assert np.all(np.diff(abs(above)) < 0.0)
    assert line.at_flat(1) == pytest.approx(body.energy_at_flat(line.sigma3_bar), rel=1e-14)
