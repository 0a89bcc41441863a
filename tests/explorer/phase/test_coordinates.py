"""States from rates that an experimenter knows, and from constants of motion."""

import numpy as np
import pytest

import explorer as ex

COIN = ex.Disk.uniform(m=5.67e-3, r=12.1e-3, g=9.81)


@pytest.mark.parametrize("face", [1, -1])
def test_rates_give_back_the_precession_and_the_spin(face):
    tilt, precession, spin = np.array([0.02, 0.5, 1.2]), 40.0, -7.0
    states = ex.rates_to_states(COIN, tilt, 3.0, precession, spin, face)
    np.testing.assert_allclose(states.phi, face * (0.5 * np.pi - tilt), rtol=1e-14)
    np.testing.assert_allclose(states.phidot, -face * 3.0, rtol=1e-14)
    np.testing.assert_allclose(states.sigma4, spin, rtol=1e-14)
    short = 1e-7
    motion = ex.simulate(states, t_eval=[short], observables=("chi",), accuracy=1e-10)
    np.testing.assert_allclose(motion.chi[:, 0] / short, precession, rtol=1e-4)


def test_degrees_are_radians_times_180_over_pi():
    radians = ex.rates_to_states(COIN, 0.3, 1.0, 20.0, 5.0)
    degrees = ex.rates_to_states(COIN, *np.degrees([0.3, 1.0, 20.0, 5.0]), degrees=True)
    np.testing.assert_allclose(degrees.natural, radians.natural, rtol=1e-14)


@pytest.mark.parametrize("phi", [0.0, 0.8, -1.1])
def test_every_complete_set_names_the_same_state(phi):
    disk = ex.Disk.hoop()
    state = ex.phi_to_states(disk, phi, 0.7, 0.4, -0.3)
    known = ex.constants(ex.phi_to_states(disk, phi, 0.7, 0.4, -0.3))
    spins = (
        {"sigma3": 0.4, "sigma4": -0.3},
        {"sigma3_bar": known.sigma3_bar, "sigma4_bar": known.sigma4_bar},
        {"sigma3_bar": known.sigma3_bar, "eta_hat": known.eta_hat_plus},
    )
    for pair in spins:
        for speed in ({"phidot": 0.7}, {"energy": known.energy}):
            made = ex.coordinates_to_states(disk, phi=phi, **speed, **pair)
            np.testing.assert_allclose(made.natural, state.natural, rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize(
    ("given", "same"),
    [
        ({"tilt": 0.4, "precession": 3.0, "spin": 0.2}, ex.rates_to_states(COIN, 0.4, 0.0, 3.0, 0.2)),
        (
            {"theta": 1e-9, "thetadot": -0.3, "sigma3": 1e-12, "sigma4": 0.2, "face": -1},
            ex.theta_to_states(COIN, 1e-9, -0.3, 1e-12, 0.2, -1),
        ),
    ],
)
def test_every_chart_is_read_by_name(given, same):
    np.testing.assert_array_equal(ex.coordinates_to_states(COIN, **given).natural, same.natural)


def test_an_eta_that_is_given_is_kept_as_it_is():
    states = ex.coordinates_to_states(ex.Disk.uniform(), phi=0.4, phidot=1.0, sigma3_bar=0.7, eta_hat=-1e-200)
    assert ex.bounces(states).side[0] == -1


def test_too_small_an_energy_is_bad_input_not_a_guess():
    states = ex.coordinates_to_states(ex.Disk.uniform(), energy=[0.5, 3.0], sigma3=0.5, sigma4=0.5)
    assert states.status.tolist() == [ex.Status.BAD_INPUT, ex.Status.OK]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"phidot": 1.0, "sigma3": 1.0}, "add sigma4"),
        ({"phidot": 1.0, "energy": 2.0, "sigma3": 1.0, "sigma4": 1.0}, "energy: leave out"),
        ({"phidot": 1.0, "sigma3": 1.0, "sigma5": 1.0}, "did you mean"),
        ({"phidot": "fast", "sigma3": 1.0, "sigma4": 1.0}, "phidot"),
    ],
)
def test_what_is_no_complete_set_is_refused_in_words(given, message):
    with pytest.raises(ex.InputError, match=message):
        ex.coordinates_to_states(ex.Disk.uniform(), **given)


def test_states_keep_the_shape_to_which_the_coordinates_broadcast():
    disk = ex.Disk.uniform()
    assert ex.rates_to_states(disk, [[0.1], [0.2]], 0.0, [1.0, 2.0, 3.0], 1.0).shape == (2, 3)
    assert ex.coordinates_to_states(disk, phidot=[[1.0], [2.0]], sigma3_bar=[1.0, 2.0], eta_hat=0.1).shape == (
        2,
        2,
    )


def test_an_eta_hat_belongs_to_the_face_that_is_said():
    """The state as it stands, without what was given, has this distance from the line of that face."""
    disk, face, eta = ex.Disk.hoop(), np.array([1, -1, -1]), np.array([1e-3, -2e-3, 0.5])
    states = ex.coordinates_to_states(
        disk, phi=[0.5, -0.7, 0.9], phidot=0.3, sigma3_bar=0.6, eta_hat=eta, face=face
    )
    known = ex.constants(ex.phi_to_states(disk, states.phi, states.phidot, states.sigma3, states.sigma4))
    np.testing.assert_allclose(np.where(face > 0, known.eta_hat_plus, known.eta_hat_minus), eta, rtol=1e-10)
    np.testing.assert_allclose(known.sigma3_bar, 0.6, rtol=1e-13)


@pytest.mark.parametrize("tilt", [10.0, [2.0, 3.0]])
def test_tilts_that_are_probably_degrees_are_told(tilt):
    ways = (
        ex.rates_to_states,
        lambda *given: ex.steady_motions(*given[:2], given[3]),
        lambda *given: ex.coordinates_to_states(given[0], tilt=given[1], precession=given[3], spin=given[4]),
    )
    for make in ways:
        with pytest.warns(ex.StateWarning, match="degrees=True"):
            make(ex.Disk.uniform(), tilt, 0.0, 1.0, 1.0)


def test_tilts_in_degrees_that_are_said_to_be_are_silent():
    assert ex.rates_to_states(ex.Disk.uniform(), [10.0, 170.0], 0.0, 1.0, 1.0, degrees=True).status.tolist() == [
        0,
        0,
    ]
    assert ex.rates_to_states(ex.Disk.uniform(), [0.5, 2.0]).status.tolist() == [0, 0]


def test_coordinates_by_name_may_be_in_degrees_but_for_an_energy():
    for given in ({"tilt": 30.0, "precession": 60.0, "spin": 5.0}, {"phi": 30.0, "sigma3": 1.0, "sigma4": 2.0}):
        more = {"energy": 1.0} if "phi" in given else {}
        turned = ex.coordinates_to_states(COIN, degrees=True, **given, **more)
        same = ex.coordinates_to_states(COIN, **{k: np.radians(v) for k, v in given.items()}, **more)
        np.testing.assert_allclose(turned.natural, same.natural, rtol=1e-14)


def test_a_tilt_that_is_none_is_bad_input():
    assert ex.rates_to_states(ex.Disk.uniform(), [0.5, 2.0, np.nan, -0.1, 4.0]).status.tolist() == [0, 0, 2, 2, 2]


def test_warnings_of_tilts_point_at_the_line_of_the_user():
    for call in (
        lambda: ex.rates_to_states(COIN, 10.0, 0.0, 1.0, 1.0),
        lambda: ex.steady_motions(COIN, 10.0, 1.0),
        lambda: ex.coordinates_to_states(COIN, tilt=10.0, precession=1.0, spin=1.0),
    ):
        with pytest.warns(ex.StateWarning) as told:
            call()
        assert told[0].filename == __file__


@pytest.mark.parametrize("face", [1, -1])
def test_constants_of_motion_lead_to_the_face_that_is_named(face):
    """With a speed as with an energy; the first bounce is the passage with these constants."""
    passage = ex.passages(COIN, 20.0, 1e-9, 30.0, face)
    by_speed = ex.constants_to_states(COIN, 20.0, 1e-9, 30.0, face)
    energy = ex.constants(by_speed).energy
    by_energy = ex.coordinates_to_states(COIN, energy=energy, sigma3_bar=20.0, eta_hat=1e-9, face=face)
    for states in (by_speed, by_energy):
        assert np.sign(states.phidot) == face
        bounce = ex.bounces(states)
        assert bounce.face[0] == face
        assert bounce.theta_min[0] == pytest.approx(passage.theta_min, rel=1e-6)
    away = ex.constants_to_states(COIN, 20.0, 1e-9, -30.0, face)
    assert ex.bounces(away).face[0] == -face
