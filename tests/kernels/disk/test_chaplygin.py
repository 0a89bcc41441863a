"""Chaplygin's solutions against gamma and hypergeometric functions."""

import math

import mpmath
import numpy as np
import pytest
from slow_chaplygin import hypergeometric

from kernels.disk.chaplygin import make_series, solutions

mpmath.mp.dps = 40
PARAMETERS = (0.0, 1e-6, 0.1, 0.25, 0.25 + 1e-12, 1.0, 6 / 5, 4 / 3, 2.0)


@pytest.mark.parametrize("c", PARAMETERS)
def test_values_at_the_vertical_agree_with_gamma_functions_also_across_c_one_quarter(c):
    """Eqs (5.11), (5.12): arguments real below c = 1/4, complex above."""
    _, r0, dr0 = make_series(c)
    root = mpmath.sqrt(1 - 4 * mpmath.mpf(c)) / 4
    for got, shift, top in ((r0, mpmath.mpf(5) / 4, 1.5), (dr0, mpmath.mpf(3) / 4, 0.5)):
        want = mpmath.gamma(top) / (mpmath.gamma(shift - root) * mpmath.gamma(shift + root))
        assert got == pytest.approx(float(want.real), rel=1e-15)


@pytest.mark.parametrize("c", PARAMETERS)
@pytest.mark.parametrize("S", [1e-100, 1e-16, 1e-6, 0.01, 0.3, 0.77, 1.0])
def test_both_solutions_are_at_rounding_error_from_flat_to_vertical(c, S):
    f = solutions(S, math.log(S), c, make_series(c)[0])
    for name, want in zip(("rho", "drho", "D", "dD"), hypergeometric(c, S), strict=True):
        got = getattr(f, name)
        # D goes from 1 at flat to 0 at the vertical: there its error is relative to 1
        assert abs(got - want) <= 2e-15 * max(abs(want), 1.0 if name == "D" else 0.0), name


@pytest.mark.parametrize("c", PARAMETERS)
def test_the_wronskian_is_minus_one(c):
    series = make_series(c)[0]
    for S in np.concatenate([np.geomspace(1e-290, 1e-3, 40), np.linspace(0.001, 1.0, 40)]):
        f = solutions(S, math.log(S), c, series)
        assert f.rho * f.dD - f.drho * f.D == pytest.approx(-1.0, abs=2e-14)


def test_recessive_solution_and_its_derivative_are_positive():
    """Checklist 20."""
    for c in PARAMETERS:
        series = make_series(c)[0]
        for S in np.linspace(1e-3, 1.0, 50):
            f = solutions(S, math.log(S), c, series)
            assert f.rho > 0
            assert f.drho > 0
