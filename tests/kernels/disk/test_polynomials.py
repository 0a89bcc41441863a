"""Polynomials in ascending powers."""

import math

import numpy as np
import pytest

from kernels.disk.polynomials import economise, horner, interpolate, long_horner, taylor


def value(powers, u):
    return float(np.polynomial.polynomial.polyval(2.0 * u - 1.0, powers))


@pytest.mark.parametrize("u", [0.0, 0.3, 1.0])
def test_a_polynomial_keeps_its_values_in_the_shifted_variable(u):
    coefficients = np.array([1.0, -2.0, 0.5, 3.0])
    powers = economise(coefficients, 6)
    assert powers.size == 7
    assert value(powers, u) == pytest.approx(np.polynomial.polynomial.polyval(u, coefficients), abs=1e-15)


@pytest.mark.parametrize("u", [0.0, 0.41, 1.0])
def test_a_series_and_an_interpolant_give_the_function(u):
    powers = taylor(lambda n: (-1.0) ** n / math.factorial(n), 14)
    assert value(powers, u) == pytest.approx(math.exp(-u), rel=1e-15)
    assert value(interpolate(np.exp, 16), u) == pytest.approx(math.exp(u), rel=2e-15)


@pytest.mark.parametrize("degree", [4, 10, 20])
def test_both_ways_to_evaluate_agree(degree):
    powers = tuple(np.random.default_rng(degree).uniform(-1.0, 1.0, degree + 1))
    for x in (-1.0, -0.3, 0.0, 0.9):
        assert horner(powers, x) == pytest.approx(np.polynomial.polynomial.polyval(x, powers), abs=2e-15)
        assert long_horner(powers, x) == pytest.approx(horner(powers, x), abs=2e-15)
