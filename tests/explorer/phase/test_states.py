"""Charts of the phase space."""

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.phase.coordinates import constants_to_states
from explorer.phase.states import States, phi_to_states, theta_to_states


def test_arguments_that_do_not_broadcast_are_refused():
    with pytest.raises(ex.InputError, match="do not fit together"):
        phi_to_states(BODIES["uniform"], [0, 1], [1, 2, 3], 0, 0)


@pytest.mark.parametrize(
    "call", [ex.simulate, ex.constants, ex.falls, ex.limit_motion, ex.periods], ids=lambda call: call.__name__
)
def test_anything_but_states_is_refused_with_the_way_to_make_them(call):
    for given in (BODIES["uniform"], [0.0, 1.0, 1.0, 0.7], "flat", None):
        with pytest.raises(ex.InputError, match="phi_to_states"):
            call(given)


def test_both_charts_of_the_tilt_name_the_same_states(body):
    rng = np.random.default_rng(8)
    face = rng.choice([-1.0, 1.0], 40)
    theta, rates = rng.uniform(0.1, 1.5, 40), rng.uniform(-2, 2, (3, 40)) * body.rate_unit
    here = theta_to_states(body, theta, rates[0], rates[1], rates[2], face)
    there = phi_to_states(body, face * (0.5 * np.pi - theta), -face * rates[0], rates[1], rates[2])
    np.testing.assert_allclose(here.natural, there.natural, rtol=1e-14, atol=1e-15)


def test_a_tilt_far_below_what_phi_can_say_is_kept():
    states = theta_to_states(BODIES["hoop"], [1e-300, 0.0, np.pi, 1.0], 0.0, 0.0, 0.5, [1, 1, 1, 2])
    assert states.natural[0, 0] == 1e-300
    assert states.status.tolist() == [0, 2, 2, 2]


def test_states_from_constants_keep_the_eta_that_doubles_of_a_state_lose():
    disk = BODIES["uniform"]
    states = constants_to_states(disk, 1.0, [1e-250, -1e-3], 0.5, [1, -1])
    chosen = states.at(np.array([1, 0]))
    assert chosen.motion.eta_plus[1] == disk.eta_hat_to_eta(1e-250)
    assert chosen.motion.eta_minus[0] == disk.eta_hat_to_eta(-1e-3)
    turned = states.reversed()
    np.testing.assert_array_equal(turned.motion, states.motion)
    np.testing.assert_array_equal(turned.natural[2], -states.natural[2])
    np.testing.assert_array_equal(turned.natural[3:], states.natural[3:])


def test_what_is_no_number_is_named():
    with pytest.raises(ex.InputError, match="sigma3 = 'x'"):
        phi_to_states(BODIES["uniform"], 0.0, 1.0, "x", 0.7)


def test_states_are_made_by_their_charts():
    disk = ex.Disk.uniform()
    good = ex.phi_to_states(disk, 0.1, [0.2, 0.3], 0.4, 0.5)
    ordered = np.asfortranarray(good.natural)
    for natural, status in (
        (good.natural, good.status[:1]),
        (good.natural.T, good.status),
        (ordered, good.status),
    ):
        with pytest.raises(ex.InputError, match="make them by phi_to_states or another of its kind"):
            ex.States(disk, natural, status)
    with pytest.raises(ex.InputError, match="make them by phi_to_states or another of its kind"):
        ex.States(disk, good.natural, good.status, shape=(3,))
    with pytest.raises(ex.InputError, match="is not a Disk"):
        ex.States("uniform", good.natural, good.status)


@pytest.mark.parametrize("small", [1e-300, 1e-310, 1e-320])
def test_what_underflows_is_zero(small):
    disk = BODIES["uniform"]
    for states in (
        phi_to_states(disk, small, small, small, 1.0),
        theta_to_states(disk, small, 1.0, small, small),
        ex.rates_to_states(disk, tilt=small, tilt_rate=1.0, precession=1e-310, spin=1.0),
    ):
        assert states.status == ex.Status.OK
        assert np.isfinite([states.phi, states.phidot, states.sigma3, states.sigma4]).all()
        assert np.isfinite(ex.constants(states).energy).all()
        assert np.isfinite(ex.falls(states).distance).all()


def test_every_status_may_be_that_of_a_state():
    codes = np.array(list(ex.Status), np.int8)
    assert codes.tolist() == list(range(len(codes)))  # so that the ends tell which are none
    known = phi_to_states(BODIES["uniform"], np.zeros(codes.size), 1.0, 1.0, 0.7)
    assert len(repr(States(known.disk, known.natural, codes)).split(",")) == codes.size
