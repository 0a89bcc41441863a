"""Elementary functions for lanes."""

import numpy as np

from kernels.disk import elementary


def test_the_elementary_functions_are_at_rounding():
    s = np.linspace(-1 / 3, 1 / 3, 501)
    np.testing.assert_allclose([elementary.log_ratio(x) for x in s], 2.0 * np.arctanh(s), rtol=7e-16, atol=0)
    x = np.linspace(0.0, 0.44, 200)
    np.testing.assert_allclose([elementary.arctan(v) for v in x], np.arctan(x), rtol=4e-16, atol=0)


def test_an_inverse_root_is_at_rounding_or_not_a_number():
    x = np.geomspace(1e-300, 1e300, 5001)
    np.testing.assert_allclose([elementary.inverse_root(v) for v in x], 1.0 / np.sqrt(x), rtol=3e-16, atol=0)
    assert np.isnan([elementary.inverse_root(v) for v in (0.0, -0.0, -1.0, -np.inf, np.nan)]).all()


def test_sines_and_cosines_keep_their_digits_where_they_vanish():
    phi = np.concatenate([np.linspace(-0.5 * np.pi, 0.5 * np.pi, 501), 0.5 * np.pi - np.geomspace(1e-15, 0.1, 50)])
    np.testing.assert_allclose([elementary.sine(x) for x in phi], np.sin(phi), rtol=6e-16, atol=0)
    np.testing.assert_allclose([elementary.cosine(x) for x in phi], np.cos(phi), rtol=8e-16, atol=0)


def test_sine_and_cosine_of_any_angle_are_those_of_the_library():
    """To rounding; of large angles to what their own rounding leaves."""
    rng = np.random.default_rng(5)
    angles = rng.uniform(-1.0, 1.0, 2000) * 10.0 ** rng.uniform(-8, 6, 2000)
    found = np.array([elementary.sine_cosine(angle) for angle in angles]).T
    allowed = 2.3e-16 + 1.2e-16 * abs(angles)
    assert (abs(found - [np.sin(angles), np.cos(angles)]) <= allowed).all()
    multiples = np.arange(-8, 9) * (0.5 * np.pi)
    found = np.array([elementary.sine_cosine(angle) for angle in multiples]).T
    np.testing.assert_allclose(found, [np.sin(multiples), np.cos(multiples)], rtol=0.0, atol=3e-16)
