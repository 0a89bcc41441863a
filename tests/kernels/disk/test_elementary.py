"""Elementary functions for lanes."""

import numpy as np

from kernels.disk import elementary


def test_the_elementary_functions_are_at_rounding():
    d = np.linspace(0.0, elementary.DEEPEST, 500)
    got = [elementary.exp_fall(x) for x in d]
    np.testing.assert_allclose(got, np.exp(-d), rtol=8e-15)
    s = np.linspace(-1 / 3, 1 / 3, 501)
    np.testing.assert_allclose(
        [elementary.log_ratio(x) for x in s], np.log1p(s) - np.log1p(-s), rtol=1e-14, atol=0
    )
    x = np.linspace(0.0, 0.44, 200)
    np.testing.assert_allclose([elementary.arctan(v) for v in x], np.arctan(x), rtol=4e-16, atol=0)
