"""Where a page begins."""

from types import SimpleNamespace

import numpy as np
import pytest

import explorer as ex
from explorer.phase.constants import constants_of
from explorer.view.page import view

COIN = ex.Disk.uniform(m=5.67e-3, r=12.1e-3, g=9.81)


def test_numbers_in_the_units_of_the_disk_become_natural():
    unit = COIN.rate_unit
    start = view(COIN, 1.5 * unit, -1e-12 * unit, 0.5 * unit, face=-1).start
    assert (start.sigma3_bar, start.eta_hat, start.phidot) == pytest.approx((1.5, -1e-12, 0.5), rel=1e-15)
    assert start.face == -1
    assert start.theta == np.pi / 2


@pytest.mark.parametrize("face", [1, -1])
def test_states_at_the_vertical_keep_the_eta_hat_they_were_made_with(face):
    states = ex.constants_to_states(COIN, [20.0, 25.0], [3e-9, -1e-11], [face * 15.0, face * 30.0], face)
    start = view(states=states, row=1).start
    unit = COIN.rate_unit
    assert start.eta_hat * unit == pytest.approx(-1e-11, rel=1e-12)
    assert start.sigma3_bar * unit == pytest.approx(25.0, rel=1e-12)
    assert start.phidot * unit == pytest.approx(30.0, rel=1e-12)
    assert (start.face, start.theta) == (face, np.pi / 2)


@pytest.mark.parametrize("face", [1, -1])
def test_states_near_flat_keep_their_tilt(face):
    disk = ex.Disk.hoop()
    states = ex.theta_to_states(disk, 1e-9, 0.3, 1e-9, 0.2, face)
    start = view(states=states).start
    assert start.theta == pytest.approx(1e-9, rel=1e-12)
    # theta grows, so the motion leaves its face.
    assert start.phidot == pytest.approx(-0.3)
    assert start.face == face
    constants = constants_of(states)
    eta_hat = constants.eta_hat_plus if face > 0 else constants.eta_hat_minus
    assert start.eta_hat == pytest.approx(eta_hat[0], rel=1e-12)


def test_a_trajectory_that_knows_its_states_opens_where_it_began():
    states = ex.phi_to_states(COIN, 0.3, 10.0, 20.0, 11.0)
    start = view(states=SimpleNamespace(states=states)).start
    assert start == view(states=states).start


def test_passages_that_know_their_arguments_open_where_they_began():
    passages = SimpleNamespace(disk=COIN, sigma3_bar=20.0, eta_hat=np.array([1e-3, -1e-6]), phidot=15.0, face=-1)
    start = view(states=passages, row=1).start
    assert start == view(COIN, 20.0, -1e-6, 15.0, -1).start


@pytest.mark.parametrize("eta_hat", [0.0, 1e-31])
def test_a_fall_is_refused_with_a_remedy(eta_hat):
    with pytest.raises(ex.InputError, match=r"falls flat.*1e-12 or -1e-12"):
        view(eta_hat=eta_hat)
    with pytest.raises(ex.InputError, match=r"row 0.*1e-12 or -1e-12"):
        view(states=ex.constants_to_states(ex.Disk.uniform(), 1.0, eta_hat, 1.0))


def test_states_on_the_line_to_rounding_are_refused():
    disk = ex.Disk.uniform()
    states = ex.constants_to_states(disk, 1.0, 1e-18, 1.0)
    blurred = ex.phi_to_states(disk, 0.0, 1.0, 1.0, states.natural[4])
    with pytest.raises(ex.InputError, match="row 0"):
        view(states=blurred)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"face": 0}, "face"),
        ({"face": 2}, "face"),
        ({"phidot": "fast"}, "phidot"),
        ({"sigma3_bar": np.inf}, "sigma3_bar"),
        ({"disk": "banana"}, "banana"),
        ({"disk": ex.Disk(I1=0.25, I3=0.0)}, "I3 = 0"),
        ({"states": 3}, "int is neither"),
        ({"states": ex.phi_to_states(ex.Disk.uniform(), 0.0, 1.0, 1.0, 0.5), "row": 1}, "row"),
        ({"states": ex.phi_to_states(ex.Disk.uniform(), 2.0, 1.0, 1.0, 0.5)}, "row 0"),
    ],
    ids=str,
)
def test_what_cannot_be_shown_is_named(arguments, message):
    with pytest.raises(ex.InputError, match=message):
        view(**arguments)
