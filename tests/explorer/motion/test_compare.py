"""Bounces and periods by integrators against quadrature, and what a comparison says of them."""

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex

DRAWN = np.random.default_rng(3).uniform(-1.0, 1.0, (4, 300)) * np.array([[1.4], [2.0], [2.0], [2.0]])
INTEGRATORS = ("rk4", "rk8", "dopri5", "dop853")
ANGLES = ("race_angle", "delta_chi", "delta_psi")


def at_rest(disk):
    """States at turning points, flattest or upright, of motions of both kinds."""
    return ex.rates_to_states(
        disk, [0.3, 1.2, 0.3, 1.5, 0.2], 0.0, [0.1, 2.0, 4.0, 0.2, 3.0], [0.1, 1.0, 0.2, 0.0, 0.1]
    )


@pytest.mark.parametrize("method", INTEGRATORS)
def test_bounces_by_integration_are_those_by_quadrature(body, method):
    for states in (ex.phi_to_states(body, *DRAWN), at_rest(body)):
        exact, found = (ex.bounces(states, 3, accuracy=1e-7, method=by) for by in ("quadrature", method))
        assert found.ok.mean() > 0.97
        both = found.ok & exact.ok
        for name in ("face", "side"):
            np.testing.assert_array_equal(getattr(found, name)[both], getattr(exact, name)[both])
        for name in ANGLES:
            np.testing.assert_allclose(getattr(found, name)[both], getattr(exact, name)[both], atol=3e-7)
        for name in ("theta_min", "duration", "time"):
            np.testing.assert_allclose(
                getattr(found, name)[both], getattr(exact, name)[both], rtol=1e-7, atol=1e-8
            )


@pytest.mark.parametrize("method", INTEGRATORS)
def test_periods_by_integration_are_those_by_quadrature(body, method):
    states = ex.phi_to_states(body, *DRAWN)
    exact, found = (ex.periods(states, accuracy=1e-7, method=by) for by in ("quadrature", method))
    assert found.ok.mean() > 0.97
    both = found.ok & exact.ok
    np.testing.assert_array_equal(found.crosses[both], exact.crosses[both])
    for name in ("chi", "psi"):
        np.testing.assert_allclose(getattr(found, name)[both], getattr(exact, name)[both], atol=3e-7)
    for name in ("period", "theta_min"):
        np.testing.assert_allclose(getattr(found, name)[both], getattr(exact, name)[both], rtol=1e-7)


def test_an_eta_that_was_given_is_integrated_too():
    states = ex.constants_to_states(BODIES["uniform"], 1.0, [1e-9, -1e-12], 1.0)
    found = ex.bounces(states, 2, accuracy=1e-8, method="dop853")
    np.testing.assert_allclose(found.race_angle[:, 0], [7.0248147, -7.0248147], atol=1e-6)
    np.testing.assert_allclose(found.theta_min, ex.bounces(states, 2).theta_min, rtol=1e-8)


def test_more_accuracy_brings_the_methods_nearer():
    states, largest = ex.phi_to_states(BODIES["hoop"], *DRAWN), []
    for accuracy in (1e-4, 1e-7, 1e-10):
        found = ex.compare(states, ("quadrature", "dop853"), accuracy=accuracy)
        largest.append(np.nanmax(found.differences("delta_chi")["dop853"]))
        assert largest[-1] < accuracy
    assert largest[0] > 100 * largest[1] > 10_000 * largest[2]


def test_a_comparison_is_of_what_each_method_answers():
    states = ex.phi_to_states(BODIES["uniform"], *DRAWN[:, :50])
    found = ex.compare(states, ["rk8", "quadrature"], count=2)
    assert list(found.bounces) == list(found.seconds) == ["rk8", "quadrature"]
    alone = ex.bounces(states, 2, method="rk8")
    np.testing.assert_array_equal(found.bounces["rk8"].race_angle, alone.race_angle)
    away = found.differences("theta_min")
    assert list(away) == ["quadrature"]
    exact = ex.bounces(states, 2)
    np.testing.assert_allclose(away["quadrature"], abs(exact.theta_min / alone.theta_min - 1), atol=1e-15)
    first, *lines = repr(found).split("\n")
    assert "100 bounces" in first
    assert [line.split(":")[0].strip() for line in lines] == ["rk8", "quadrature"]
    assert " rad" in lines[1]
    with pytest.raises(ex.InputError, match="did you mean 'theta_min'"):
        found.differences("tilt_min")


@pytest.mark.parametrize("methods", [(), ("rk8",), ("rk8", "rk8"), "rk8", ("rk8", "euler")])
def test_fewer_than_two_methods_are_refused(methods):
    states = ex.phi_to_states(BODIES["uniform"], *DRAWN[:, :2])
    with pytest.raises(ex.InputError, match="method"):
        ex.compare(states, methods)


def test_a_difference_that_is_not_known_is_not_told():
    nowhere = ex.phi_to_states(BODIES["uniform"], [9.0, np.nan], 1.0, 1.0, 1.0)
    for states in (nowhere, nowhere[:0]):
        assert not any(name in repr(ex.compare(states)).splitlines()[2] for name in (*ANGLES, "theta_min", "time"))
