"""Where a page begins."""

import numpy as np
import pytest

import explorer as ex
from explorer.phase.constants import constants
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
    states = ex.constants_to_states(COIN, [20.0, 25.0], [3e-9, -1e-11], [15.0, 30.0], face)
    start = view(states, row=1).start
    unit = COIN.rate_unit
    assert start.eta_hat * unit == pytest.approx(-1e-11, rel=1e-12)
    assert start.sigma3_bar * unit == pytest.approx(25.0, rel=1e-12)
    assert start.phidot * unit == pytest.approx(30.0, rel=1e-12)
    assert (start.face, start.theta) == (face, np.pi / 2)


@pytest.mark.parametrize("face", [1, -1])
def test_states_near_flat_keep_their_tilt(face):
    disk = ex.Disk.hoop()
    states = ex.theta_to_states(disk, 1e-9, 0.3, 1e-9, 0.2, face)
    start = view(states).start
    assert start.theta == pytest.approx(1e-9, rel=1e-12)
    # theta grows, so the motion leaves its face.
    assert start.phidot == pytest.approx(-0.3)
    assert start.face == face
    known = constants(states)
    eta_hat = known.eta_hat_plus if face > 0 else known.eta_hat_minus
    assert start.eta_hat == pytest.approx(eta_hat, rel=1e-12)


def test_a_trajectory_opens_where_it_began():
    states = ex.constants_to_states(COIN, 20.0, [1e-3, -1e-14], 10.0)
    motion = ex.simulate(states, t_end=0.01, observables=("phi",))
    for row in (0, 1):
        assert view(motion, row=row) == view(motion(0.005), row=row) == view(states[row])


def test_passages_and_their_forces_open_where_they_began():
    given = (COIN, 20.0, [1e-3, -1e-6], 15.0)
    assert view(ex.passages(*given, face=-1), row=1) == view(COIN, 20.0, -1e-6, 15.0, -1)
    assert view(ex.passage_forces(*given), row=0) == view(COIN, 20.0, 1e-3, 15.0)


def test_a_bounce_opens_at_the_vertical_before_it():
    """Faces in turn, each with its own eta: computed here from the states at later crossings."""
    states = ex.constants_to_states(COIN, [20.0, 21.0], -1e-5, 15.0)
    bounces = ex.bounces(states, 3)
    constants = ex.constants(states)
    for row, (state, face) in enumerate(zip(bounces.row.ravel(), bounces.face.ravel(), strict=True)):
        eta_hat = (constants.eta_hat_plus if face > 0 else constants.eta_hat_minus)[state]
        start, expected = view(bounces, row=row).start, view(COIN, 20.0 + state, eta_hat, 15.0, int(face)).start
        assert (start.face, start.theta) == (expected.face, np.pi / 2)
        assert start.eta_hat == pytest.approx(expected.eta_hat, rel=1e-9)
        assert start.phidot == pytest.approx(expected.phidot, rel=1e-9)


def test_a_bounce_that_never_crosses_the_vertical_opens_at_its_state():
    states = ex.rates_to_states(COIN, tilt=10, tilt_rate=-300, precession=1000, spin=600, degrees=True)
    assert view(ex.bounces(states, 2), row=1) == view(states)


@pytest.mark.parametrize("key", [2, np.s_[::-1], [1, 1], np.s_[1:], np.array([True, False, True]), None])
def test_what_was_chosen_of_a_result_is_shown_as_it_was_in_all_of_it(key):
    states = ex.constants_to_states(COIN, [20.0, 21.0, 22.0], -0.3, 15.0)
    for found in (ex.bounces(states, 2), ex.periods(states), states):
        numbers = np.arange(found.size).reshape(found.shape)[key]
        for row, number in enumerate(np.ravel(numbers)):
            assert view(found[key], row=row) == view(found, row=int(number))


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(("bar", "phidot"), [(20.0, 15.0), (0.0, -60.0)], ids=["one face", "both faces"])
def test_a_limit_motion_is_shown_by_one_beside_it_on_its_side(side, bar, phidot):
    start = ex.constants_to_states(COIN, bar, 0.0, phidot, face=-1)
    found = view(ex.limit_motion(start, side)).start
    towards = phidot if found.face < 0 else -phidot
    assert found.eta_hat == side * 1e-12
    expected = (bar, towards, np.pi / 2)
    unit = COIN.rate_unit
    assert (found.sigma3_bar * unit, found.phidot * unit, found.theta) == pytest.approx(expected, rel=1e-12)


def test_numbers_left_out_are_those_of_natural_units():
    """A coin in SI units must not start a thousand times slower than it falls."""
    assert view(COIN).start == view().start


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"row": None}, r"row: .* which of the 2 states, 0 to 1"),
        ({"row": 2}, "row = 2"),
        ({"row": 0, "eta_hat": 1e-3}, "eta_hat = 0.001: States has its own"),
    ],
    ids=str,
)
def test_one_motion_is_shown_and_nothing_is_ignored(given, message):
    with pytest.raises(ex.InputError, match=message):
        view(ex.constants_to_states(COIN, 20.0, [1e-3, -1e-3], 10.0), **given)
    with pytest.raises(ex.InputError, match="a disk has no rows"):
        view(COIN, row=0)


@pytest.mark.parametrize("eta_hat", [0.0, 1e-31])
def test_a_fall_is_refused_with_a_remedy(eta_hat):
    with pytest.raises(ex.InputError, match=r"falls flat.*1e-12 or -1e-12"):
        view(eta_hat=eta_hat)
    with pytest.raises(ex.InputError, match=r"row 0.*1e-12 or -1e-12"):
        view(ex.constants_to_states(ex.Disk.uniform(), 1.0, eta_hat, 1.0))


def test_states_on_the_line_to_rounding_are_refused():
    disk = ex.Disk.uniform()
    states = ex.constants_to_states(disk, 1.0, 1e-18, 1.0)
    blurred = ex.phi_to_states(disk, 0.0, 1.0, 1.0, states.natural[4])
    with pytest.raises(ex.InputError, match="row 0"):
        view(blurred)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"face": 0}, "face"),
        ({"face": 2}, "face"),
        ({"phidot": "fast"}, "phidot"),
        ({"sigma3_bar": np.inf}, "sigma3_bar"),
        ({"motion": "banana"}, "banana"),
        ({"motion": ex.Disk(I1=0.25, I3=0.0)}, "I3 = 0"),
        ({"motion": 3}, "int is not a motion"),
        ({"motion": ex.phi_to_states(ex.Disk.uniform(), 0.0, 1.0, 1.0, 0.5), "row": 1}, "row"),
        ({"motion": ex.phi_to_states(ex.Disk.uniform(), 2.0, 1.0, 1.0, 0.5)}, "row 0"),
    ],
    ids=str,
)
def test_what_cannot_be_shown_is_named(arguments, message):
    with pytest.raises(ex.InputError, match=message):
        view(**arguments)
