"""Whole periods by quadrature: the numbers of the paper, returns, and eta at the extremes."""

import dataclasses
import math

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.phase.coordinates import constants_to_states
from explorer.phase.potential import curvature_of
from explorer.phase.states import phi_to_states

ROWS = {  # mathematics, section 10
    ("uniform", 0.01): (3.5309125568, 10.16442885, 4.88619430),
    ("uniform", -0.01): (3.5069444328, -3.87572184, -9.14592890),
    ("hoop", 0.01): (3.5443368831, 8.57037740, 3.49347084),
    ("hoop", -0.01): (3.5168724512, -2.31358306, -7.37252693),
}


@pytest.mark.parametrize("key", ROWS, ids=str)
def test_whole_periods_of_the_figures(key):
    name, eta_hat = key
    got = ex.periods(constants_to_states(BODIES[name], 1.0, eta_hat, 1.0), accuracy=1e-11)
    assert (got.period, got.chi, got.psi) == pytest.approx(ROWS[key], abs=1e-8)
    assert got.crosses


def test_periods_without_crossing_the_vertical_bring_the_motion_back():
    rng = np.random.default_rng(15)
    disk = BODIES["hoop"]
    n = 60
    states = np.column_stack([rng.uniform(0.3, 1.4, n) * rng.choice([-1, 1], n), rng.uniform(-0.2, 0.2, (n, 3))])
    got = ex.periods(phi_to_states(disk, *states.T), accuracy=1e-9)
    inside = (got.status == 0) & ~got.crosses & (got.theta_min > 1e-3)
    assert inside.sum() > 20
    for i in np.flatnonzero(inside)[:12]:
        after = ex.simulate(
            ex.phi_to_states(disk, *states[i]),
            t_eval=[got.period[i]],
            observables=("phi", "phidot", "chi", "psi"),
            method="dop853",
            accuracy=1e-10,
        )
        assert after.phi[0] == pytest.approx(states[i, 0], abs=1e-8)
        assert after.phidot[0] == pytest.approx(states[i, 1], abs=1e-7)
        assert after.chi[0] == pytest.approx(got.chi[i], abs=1e-8)
        assert after.psi[0] == pytest.approx(got.psi[i], abs=1e-8)


def test_slow_rocking_near_flat_turns_by_the_eulers_disk_angle():
    """Bottom of the near-flat well: 2 pi sqrt(M / (3 I1)) per bounce (section 5)."""
    for name, turn in (("uniform", 2.58177), ("hoop", 1.99983)):
        disk = BODIES[name]
        b = disk.body
        eta = 1e-9
        theta0 = eta ** (2 / 3) / b.I1 ** (1 / 3)
        excess = math.sqrt(2 * (1.001 - 1) * 1.5 * theta0 / b.M)
        bar = ex.constants(ex.theta_to_states(disk, theta0, excess, eta / b.I1, 0.0)).sigma3_bar
        given = {"phi": 0.5 * math.pi - theta0, "phidot": -excess, "sigma3_bar": bar}
        got = ex.periods(ex.coordinates_to_states(disk, **given, eta_hat=eta / (b.I3 * b.r0)), accuracy=1e-6)
        assert got.status == ex.Status.OK
        assert got.chi / np.pi == pytest.approx(turn, abs=2e-3)


def test_periods_on_f_fall_and_beside_it_need_the_eta_they_were_given():
    disk = BODIES["uniform"]
    on_f = ex.periods(constants_to_states(disk, 1.0, 0.0, 1.0))
    assert on_f.status == ex.Status.FALLS
    found = ex.periods(constants_to_states(disk, 1.0, [1e-200, -1e-200], 1.0))
    assert (found.status == ex.Status.OK).all()
    assert found.chi[0] - found.chi[1] == pytest.approx(2 * disk.race_limit, abs=1e-9)
    rows = phi_to_states(disk, 0.0, 1.0, 1.0, 0.7285923160189477)
    assert ex.periods(rows).status in (ex.Status.FALLS, ex.Status.UNRESOLVED_SIDE)


def test_any_number_of_threads_gives_the_same_periods():
    states = phi_to_states(BODIES["hoop"], np.linspace(-1.7, 1.2, 41), 0.3, 0.4, 0.2)
    one, three = (ex.periods(states, jobs=jobs) for jobs in (1, 3))
    for name, values in one.columns.items():
        np.testing.assert_array_equal(values, three.columns[name])
    assert len(ex.periods(phi_to_states(BODIES["hoop"], [], 0.3, 0.4, 0.2), jobs=2)) == 0


@pytest.mark.parametrize("name", ["uniform", "hoop", "thick", "coin"])
def test_periods_of_steady_motions_are_those_of_the_linear_wobble(name):
    """2 pi sqrt(M / V'') of the portrait, from almost flat to upright, and what the angles gain in that time."""
    disk = BODIES[name]
    tilt = np.repeat(np.radians([0.01, 1.0, 10.0, 45.0, 89.0, 90.0]), 2)
    rate = np.tile([1.5, -4.0], 6) * np.sqrt(np.maximum(1.0, 1.0 / tilt)) * disk.rate_unit
    steady = ex.steady_motions(disk, tilt, rate, face=np.tile([1, 1, -1, -1], 3))
    q, z, _, rho, sigma4 = steady.states.rows
    curvature = curvature_of(q, z, q * rho, sigma4, disk.body) * disk.energy_unit
    found = ex.periods(steady.states, accuracy=1e-10)
    assert steady.stable.all()
    assert steady.ok.all()
    assert found.ok.all()
    M = disk.I1 + disk.m * disk.r**2
    expected = 2.0 * np.pi * np.sqrt(M / curvature)
    np.testing.assert_allclose(found.period, expected, rtol=1e-9)
    np.testing.assert_allclose(found.chi, expected * steady.precession, rtol=1e-9)
    turn = expected * (np.sin(steady.states.phi) * steady.precession - steady.states.sigma4)
    np.testing.assert_allclose(found.psi, turn, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(found.theta_min, tilt, rtol=1e-10)
    # Smaller and smaller pushes lead there: the period changes like the square of the amplitude.
    for push in (1e-2, 1e-4, 1e-9, 1e-300):
        rates = push * tilt * disk.rate_unit * np.sqrt(np.maximum(1.0, 1.0 / tilt))
        pushed = ex.phi_to_states(disk, steady.states.phi, rates, steady.states.sigma3, steady.states.sigma4)
        wobble = ex.periods(pushed, accuracy=1e-10)
        assert wobble.ok.all()
        np.testing.assert_allclose(wobble.period, expected, rtol=10.0 * push**2 + 1e-9)


@pytest.mark.parametrize("accuracy", [1e-3, 1e-6, 1e-8, 1e-10, 1e-12])
@pytest.mark.parametrize("phidot", [2.794852785676193e-08, 1e-7, 3e-7])
def test_a_motion_that_is_at_the_vertical_and_moves_crosses_it_at_any_accuracy(accuracy, phidot):
    """E - V there is 5e-16 and more: the speed tells it, and a difference of energies does not."""
    states = ex.constants_to_states(ex.Disk.uniform(), 1.5203067953112497, 4.1155149013182496e-07, phidot)
    found, bounces = ex.periods(states, accuracy=accuracy), ex.bounces(states, 2, accuracy=accuracy)
    assert found.ok.all()
    assert found.crosses.all()
    assert bounces.ok.all()
    assert (bounces.face == [1, -1]).all()
    assert bounces.duration[1] == pytest.approx(0.98969326 * phidot, rel=1e-3)


@pytest.mark.parametrize("inertia", [(0.25, 0.02), (0.25, 1e-4), (0.25, 1e-6), (1.0, 1e-8)])
def test_beside_the_vertical_periods_are_told_by_their_errors_from_either_face(inertia):
    """Seen from the face of the larger |eta| the energy is a difference; what rounding leaves open is refused."""
    disk, rng, n = ex.Disk(I1=inertia[0], I3=inertia[1]), np.random.default_rng(5), 100
    eta_hat = 10.0 ** rng.uniform(-8.0, 0.0, n) * rng.choice([-1.0, 1.0], n)
    upright = constants_to_states(disk, rng.normal(0.0, 1.2, n), eta_hat, -rng.uniform(0.02, 2.5, n), -1)
    natural = np.array(upright.natural)
    natural[1] = 1e-16  # of z = cos theta: in the hemisphere of face +1
    beside, true = dataclasses.replace(upright, natural=natural), ex.periods(upright, accuracy=1e-10)
    for accuracy in (1e-2, 1e-6, 1e-10):
        found = ex.periods(beside, accuracy=accuracy)
        known = found.ok & true.ok
        error = 10.0 * (found.error_estimate + true.error_estimate)[known]
        assert (abs(found.psi - true.psi)[known] <= error).all()
        assert found.ok.mean() > (0.99 if accuracy > 1e-7 else 0.9)
    assert ex.bounces(beside, 2, accuracy=1e-2).ok.mean() > 0.9


def test_a_disk_at_rest_on_a_crest_of_the_potential_has_no_period():
    """Balanced upright, or rolling straight ahead too slowly: there is no moment at which it begins to fall."""
    disk = BODIES["uniform"]
    states = phi_to_states(disk, 0.0, 0.0, [0.0, 0.1], 0.0)
    assert not ex.periods(states).ok.any()
    assert not ex.bounces(states).ok.any()


def test_where_a_crest_lies_close_beyond_a_turning_point_its_rounding_is_estimated():
    """The period and chi in 40 digits, by Taylor series of the plain equations."""
    states = phi_to_states(
        BODIES["uniform"], -0.5017996019765992, 0.5175905567043116, -0.13049307588008152, 0.16551832927098242
    )
    for accuracy in (1e-8, 1e-6, 1e-3, 1e-1):
        found = ex.periods(states, accuracy=accuracy)
        if found.status == ex.Status.OK:
            assert abs(found.period / 49.691376 - 1.0) <= 3.0 * found.error_estimate
            assert abs(found.chi + 13.281190) <= 3.0 * found.error_estimate
    assert found.status == ex.Status.OK


@pytest.mark.parametrize(("phidot", "accuracy"), [(1e-3, 1e-6), (1e-4, 1e-6), (1e-5, 1e-3)])
def test_a_kick_off_a_crest_of_the_potential_has_a_period(phidot, accuracy):
    """Of unstable rolling at a tilt of 1.3; the second one is 107.789119 in 40 digits."""
    disk = BODIES["uniform"]
    steady = ex.steady_motions(disk, 1.3, -0.7).states
    found = ex.periods(ex.phi_to_states(disk, steady.phi, phidot, steady.sigma3, steady.sigma4), accuracy=accuracy)
    assert found.status == ex.Status.OK
    if phidot == 1e-4:
        assert abs(found.period - 107.789119) < 1e-6


@pytest.mark.parametrize("method", ["rk8", "dop853"])
def test_an_eta_hat_that_was_given_is_kept_by_integration_too(method):
    states = constants_to_states(BODIES["hoop"], 1.0, [1e-18, -1e-300], 1.0)
    exact, found = ex.periods(states), ex.periods(states, method=method)
    assert found.ok.all()
    np.testing.assert_allclose(found.theta_min, exact.theta_min, rtol=1e-6)
    np.testing.assert_allclose(found.period, exact.period, rtol=1e-6)


@pytest.mark.parametrize("method", ["rk4", "rk8", "dopri5", "dop853"])
def test_integration_gives_no_period_where_rounding_is_all_that_moves(method):
    """At rest in a centre or on a saddle, and where half a million steps hardly change the tilt."""
    disk = BODIES["uniform"]
    steady = ex.steady_motions(disk, [0.5, 0.5, 1.0, 0.2, 1.3], [2.0, 5.0, 1.5, 4.0, 3.0]).states
    saddle = next(place for place in ex.potential(disk, 0.25, 1e-3).equilibria if place.kind == "saddle")
    given = {"phi": saddle.phi, "phidot": 0.0, "sigma3_bar": 0.25, "eta_hat": 1e-3}
    on_saddle = ex.coordinates_to_states(disk, **given)
    fast = ex.phi_to_states(disk, 1.570670265030739, 0.0, 5.664449226128087e-11, -1509442.4646270527)
    for states in (steady, on_saddle, *([fast] if method == "dop853" else [])):
        for found in (ex.periods(states, method=method), ex.bounces(states, method=method)):
            assert (found.status == ex.Status.STEP_LIMIT).all()


@pytest.mark.parametrize("method", ["rk4", "rk8", "dopri5", "dop853"])
@pytest.mark.parametrize("name", ["uniform", "thick"])
def test_small_swings_by_integration_err_by_what_is_estimated(name, method):
    """About steady motions, stable or not: dopri5 was wrong by 6e-4 where it estimated 3e-7."""
    body, accuracy = BODIES[name], 1e-3 if method == "rk4" else 1e-6
    tilt, precession = np.meshgrid([0.1, 0.5, 1.0, 1.3, 0.5 * np.pi], [0.3, 2.0, 7.0])
    steady = ex.steady_motions(body, tilt.ravel(), precession.ravel() * body.rate_unit)
    phi, sigma3, sigma4 = (
        np.tile(column[steady.ok], 6) for column in (steady.states.phi, steady.states.sigma3, steady.states.sigma4)
    )
    swing = np.repeat(10.0 ** -np.arange(3.0, 15.0, 2.0), steady.ok.sum())
    states = ex.phi_to_states(body, phi + swing, 0.0, sigma3, sigma4)
    found, true = ex.periods(states, accuracy=accuracy, method=method), ex.periods(states, accuracy=1e-2)
    known = found.ok & true.ok
    error = 4.0 * (found.error_estimate + true.error_estimate)[known]
    assert (abs(found.period / true.period - 1.0)[known] <= error).all()
    assert (abs(found.chi - true.chi)[known] <= error).all()
    assert (abs(found.psi - true.psi)[known] <= error).all()
    stable = np.tile(steady.stable[steady.ok], 6)
    assert found.ok[stable & (swing > 1e-11 / accuracy)].mean() > 0.9


@pytest.mark.parametrize("accuracy", [1e-3, 1e-6, 1e-9])
def test_a_push_from_rest_however_slow_changes_nothing(accuracy):
    """Squares of such speeds and of the ways they lead are below the smallest number of the machine."""
    disk, speeds = ex.Disk.uniform(), 10.0 ** -np.arange(20.0, 301.0)
    at_rest = ex.phi_to_states(disk, 0.3, 0.0, 0.5, 0.6)
    for pushed in (speeds, -speeds):
        states = ex.phi_to_states(disk, 0.3, pushed, 0.5, 0.6)
        found, rest = ex.periods(states, accuracy=accuracy), ex.periods(at_rest, accuracy=accuracy)
        assert found.ok.all()
        np.testing.assert_allclose(found.period, rest.period, rtol=accuracy)
        bounces, resting = ex.bounces(states, accuracy=accuracy), ex.bounces(at_rest, accuracy=accuracy)
        assert bounces.ok.all()
        np.testing.assert_allclose(bounces.time, resting.time[0], rtol=accuracy)


@pytest.mark.parametrize("method", ["quadrature", "dop853"])
def test_where_digits_of_the_state_lack_the_status_says_so_and_its_remedies_help(method):
    """Within 1e-13 of F doubles leave a few digits of eta, and so of the smallest tilt."""
    disk = ex.Disk.uniform()
    given = ex.constants_to_states(disk, 1.0, [1e-13, -1e-13], 1.0)
    rounded = ex.phi_to_states(disk, given.phi, given.phidot, given.sigma3, given.sigma4)
    for call in (ex.periods, ex.bounces):
        assert (call(rounded, accuracy=1e-3, method=method).status == ex.Status.TOO_FEW_DIGITS).all()
        assert call(given, accuracy=1e-3, method=method).ok.all()  # eta_hat itself
        assert call(rounded, accuracy=1e-1, method=method).ok.all()  # a larger accuracy
