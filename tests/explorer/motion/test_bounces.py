"""Every approach to flat: against passages, periods, and a dense integration of the full equations."""

from itertools import pairwise

import numpy as np
import pytest
from shares import anywhere

import explorer as ex
from explorer.motion.bounces import motion_constants

DISKS = {
    "uniform": ex.Disk.uniform(),
    "hoop": ex.Disk.hoop(),
    "coin": ex.Disk.uniform(m=5.67e-3, r=12.1e-3, g=9.81),
}


@pytest.mark.parametrize("eta_hat", [1e-2, 1e-8, 1e-200])
@pytest.mark.parametrize("name", DISKS)
def test_bounces_from_the_vertical_are_the_passages(name, eta_hat):
    disk, unit = DISKS[name], DISKS[name].rate_unit
    eta = eta_hat * unit * np.tile([1.0, -1.0], 10)
    bar, speed, face = (
        np.linspace(-1.5, 1.5, 20) * unit,
        np.linspace(0.6, 2.0, 20) * unit,
        np.tile([1, 1, -1, -1], 5),
    )
    passages = ex.passages(disk, bar, eta, speed, face, accuracy=1e-10)
    bounces = ex.bounces(ex.constants_to_states(disk, bar, eta, speed, face), accuracy=1e-10)
    assert bounces.shape == (20, 1)
    assert (bounces.face[:, 0] == face).all()
    assert (bounces.side[:, 0] == np.sign(eta)).all()
    for column in ("race_angle", "delta_chi", "delta_psi", "fall_angle"):
        np.testing.assert_allclose(getattr(bounces, column)[:, 0], getattr(passages, column), atol=1e-9)
    for column in ("theta_min", "duration"):
        np.testing.assert_allclose(getattr(bounces, column)[:, 0], getattr(passages, column), rtol=1e-9)


@pytest.mark.parametrize("name", DISKS)
def test_the_bounces_of_a_period_add_up_to_it(name):
    states = anywhere(DISKS[name], 300, 1)
    periods, bounces = ex.periods(states, accuracy=1e-9), ex.bounces(states, 3, accuracy=1e-9)
    crosses, known = periods.crosses, (periods.status == 0) & (bounces.status[:, 0] == 0)
    assert crosses[known].any()
    assert (~crosses[known]).any()
    last = np.where(crosses, 2, 1)
    rows = np.arange(300)
    np.testing.assert_allclose(
        (bounces.time[rows, last] - bounces.time[:, 0])[known], periods.period[known], rtol=1e-9
    )
    for of_period, of_bounce in ((periods.chi, bounces.delta_chi), (periods.psi, bounces.delta_psi)):
        total = np.where(crosses, of_bounce[:, 0] + of_bounce[:, 1], of_bounce[:, 0])
        np.testing.assert_allclose(total[known], of_period[known], atol=1e-9)


def test_the_disk_is_flattest_when_a_bounce_says_so():
    disk = DISKS["hoop"]
    states = anywhere(disk, 40, 2)
    bounces = ex.bounces(states, 3, accuracy=1e-10)
    for i in np.flatnonzero(bounces.status[:, 0] == 0):
        how = {"observables": ("phi", "phidot"), "method": "dop853", "accuracy": 1e-11}  # knows no turning points
        motion = ex.simulate(states[i], t_eval=bounces.time[i], **how)
        np.testing.assert_allclose(0.5 * np.pi - abs(motion.phi), bounces.theta_min[i], atol=1e-8)
        np.testing.assert_allclose(motion.phidot, 0.0, atol=1e-6)
        assert (np.sign(motion.phi) == bounces.face[i]).all()


def test_race_angles_of_a_wobbling_coin_tend_to_kappa_pi_by_decade():
    """Tilt, precession and spin in SI, all within a degree of flat: not one of these motions is ever upright."""
    coin, random, count = DISKS["coin"], np.random.default_rng(3), 20_000
    tilt = np.radians(random.uniform(0.1, 1.0, count))
    precession, spin = random.normal(0.0, 60.0, count), random.normal(0.0, 1.0, count)
    states = ex.rates_to_states(coin, tilt, random.normal(0.0, 5.0, count), precession, spin)
    bounces = ex.bounces(states)
    assert bounces.ok.all()
    assert not ex.periods(states[:2000]).crosses.any()
    known = ex.constants(states)
    eta = abs(np.where(bounces.face[:, 0] > 0, known.eta_hat_plus, known.eta_hat_minus)) / coin.rate_unit
    away = abs(bounces.race_angle - bounces.side * coin.race_limit)[:, 0]
    medians = [np.median(away[(eta >= low) & (eta < 10.0 * low)]) for low in (1e-4, 1e-5, 1e-6, 1e-7)]
    assert all(nearer < 0.5 * further for further, nearer in pairwise(medians))
    assert medians[-1] < 0.01


def test_the_side_is_right_at_any_distance_from_f():
    eta = np.array([1e-200, -1e-200, 1e-300, -1e-300])
    bounces = ex.bounces(ex.constants_to_states(DISKS["uniform"], 0.8, eta, 1.0), 2)
    assert (bounces.side[:, 0] == np.sign(eta)).all()
    limit = np.sign(eta) * DISKS["uniform"].race_limit
    np.testing.assert_allclose(bounces.race_angle[:, 0], limit, atol=1e-6)


def test_jobs_do_not_change_the_numbers():
    states = anywhere(DISKS["uniform"], 101, 4)
    one, two = ex.bounces(states, 2), ex.bounces(states, 2, jobs=2)
    for name, values in one.columns.items():
        np.testing.assert_array_equal(values, two.columns[name])


def test_a_motion_without_a_limit_motion_has_no_race_angle():
    """The energy is below V_0, so that no motion with these constants comes flat."""
    states = ex.phi_to_states(DISKS["uniform"], -1.2543, -0.0647, 1.056, -2.2335)
    bounces = ex.bounces(states)
    assert bounces.ok.all()
    assert np.isnan(bounces.race_angle).all()
    assert np.isfinite(bounces.delta_chi).all()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: ex.bounces([0.0, 1.0, 1.0, 0.7]), "give States"),
        (lambda: ex.bounces(anywhere(DISKS["hoop"], 1, 0), 0), "count = 0"),
        (lambda: ex.bounces(anywhere(DISKS["hoop"], 1, 0), 1, jobs=0), "jobs = 0"),
        (lambda: ex.bounces(ex.phi_to_states(ex.Disk(I3=0.0), 0.0, 1.0, 1.0, 0.7)), "I3 = 0"),
    ],
)
def test_what_cannot_be_followed_is_refused_in_words(call, message):
    with pytest.raises(ex.InputError, match=message):
        call()


def test_a_bad_state_is_a_status_and_its_neighbours_are_as_without_it():
    disk = DISKS["uniform"]
    bounces = ex.bounces(ex.phi_to_states(disk, [0.3, np.nan, 0.3], 0.5, 0.4, 0.2), 2)
    assert bounces.status_names[:, 0].tolist() == ["ok", "bad_input", "ok"]
    assert np.isnan(bounces.delta_chi[1]).all()
    np.testing.assert_array_equal(bounces.delta_chi[0], bounces.delta_chi[2])


@pytest.mark.parametrize("accuracy", [1e-3, 1e-6, 1e-8])
def test_a_cloud_about_steady_motion_is_known_to_any_accuracy(accuracy):
    """A coin at 10 +- 1 degrees; among them swings of a thousandth of a degree, and the steady motion itself."""
    coin, random = DISKS["coin"], np.random.default_rng(6)
    spin = ex.steady_motions(coin, np.radians(10.0), 60.0).spin
    spread = np.append(10.0 ** random.uniform(-5.0, 0.0, 199), 0.0)
    normal = random.normal(0.0, 1.0, (4, 200)) * spread
    tilt = np.radians(10.0 + normal[0])
    states = ex.rates_to_states(coin, tilt, 0.5 * normal[1], 60.0 + normal[2], spin + 0.5 * normal[3])
    bounces, periods, best = (
        ex.bounces(states, 2, accuracy=accuracy),
        ex.periods(states, accuracy=accuracy),
        ex.periods(states, accuracy=1e-12),
    )
    assert bounces.ok.all()
    assert periods.ok.all()
    assert best.ok.all()
    np.testing.assert_allclose(periods.period, best.period, rtol=accuracy)
    np.testing.assert_allclose(bounces.duration[:, 1], best.period, rtol=accuracy)
    np.testing.assert_allclose(bounces.delta_chi[:, 0], best.chi, atol=accuracy)
    np.testing.assert_allclose(np.diff(bounces.time)[:, 0], best.period, rtol=accuracy)


@pytest.mark.parametrize("accuracy", [1e-4, 1e-6, 1e-8])
def test_a_narrow_well_beside_the_vertical_is_known_to_any_accuracy(accuracy):
    """From rest beside the upright crest of V, so that its wobble is narrow and yet far from harmonic."""
    random, n = np.random.default_rng(0), 20_000
    states = ex.rates_to_states(
        DISKS["coin"],
        random.uniform(80.0, 100.0, n),
        0.0,
        random.normal(0.0, 900.0, n),
        random.uniform(-900.0, 900.0, n),
        degrees=True,
    )
    bounces = ex.bounces(states, 1, accuracy=accuracy)
    assert bounces.ok.all()
    best, stepped = (
        ex.bounces(states, 1, accuracy=1e-10),
        ex.bounces(states[:500], 1, accuracy=1e-8, method="dop853"),
    )
    both = best.ok[:500] & stepped.ok
    assert both.sum() > 490
    np.testing.assert_allclose(stepped.delta_chi[both], best.delta_chi[:500][both], atol=1e-7)
    off, told = abs(bounces.delta_chi - best.delta_chi), bounces.error_estimate + best.error_estimate
    assert off[best.ok].max() <= accuracy
    assert (off <= 3.0 * told)[best.ok].all()


def test_a_disk_that_spins_upright_comes_down_on_both_faces_in_turn():
    """It wobbles about the vertical: half a period on either face, while the wobble can be told from none."""
    disk = DISKS["hoop"]
    bounces = ex.bounces(ex.phi_to_states(disk, 0.0, [1e-1, 1e-3, 1e-6], 2.0, 0.0), 2)
    periods = ex.periods(ex.phi_to_states(disk, 0.0, [1e-1, 1e-3, 1e-6, 1e-12, 0.0], 2.0, 0.0), accuracy=1e-10)
    assert bounces.ok.all()
    assert periods.ok.all()
    assert bounces.face.tolist() == [[1, -1]] * 3
    np.testing.assert_allclose(bounces.duration.sum(axis=1), periods.period[:3], rtol=1e-6)
    np.testing.assert_allclose(bounces.duration[:, 0], 0.5 * periods.period[:3], rtol=1e-6)
    np.testing.assert_allclose(periods.period[3:], periods.period[2], rtol=1e-10)
    still = ex.bounces(ex.phi_to_states(disk, 0.0, 0.0, 2.0, 0.0))
    assert still.ok.all()
    assert still.theta_min[0] == pytest.approx(0.5 * np.pi)
    assert still.duration[0] == pytest.approx(periods.period[4])


@pytest.mark.filterwarnings("ignore:t_eval")  # only the two ends of the stretch are asked for
def test_turns_of_a_wobbling_coin_are_those_of_the_integrated_equations():
    """From turning point to turning point, within a degree of flat: chi by dop853 against the quadrature."""
    random, count = np.random.default_rng(3), 8
    tilt = np.radians(random.uniform(0.1, 1.0, count))
    rates = random.normal(0.0, [[5.0], [60.0], [1.0]], (3, count))
    states = ex.rates_to_states(DISKS["coin"], tilt, *rates)
    bounces = ex.bounces(states, 2, accuracy=1e-9)
    for i in range(count):
        ends = bounces.time[i, 1] + 0.5 * bounces.duration[i, 1] * np.array([-1.0, 1.0])
        motion = ex.simulate(states[i], t_eval=ends, observables=("chi",), method="dop853", accuracy=1e-10)
        assert np.diff(np.ravel(motion.chi))[0] == pytest.approx(bounces.delta_chi[i, 1], abs=1e-9)


def flattest(disk, count, seed):
    """States that rest at their flattest moment, phi not negative; a third of them are near flat."""
    random = np.random.default_rng(seed)
    phi, rates = random.uniform(0.1, 1.5, count), disk.rate_unit * random.normal(size=(2, count))
    at_rest = ex.phi_to_states(disk, phi, 0.0, *rates)
    found = ex.bounces(at_rest)
    return at_rest.at(np.flatnonzero(found.ok[:, 0] & (found.time[:, 0] == 0.0)))


@pytest.mark.filterwarnings("ignore:t_eval")
@pytest.mark.parametrize("accuracy", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("name", DISKS)
def test_beside_its_flattest_moment_a_motion_is_that_of_rest_shifted_in_time(name, accuracy):
    """Its time is v/a for a small speed v, the acceleration a being read off the integrated equations."""
    rest = flattest(DISKS[name], 60, 11)
    assert len(rest) > 10
    unit, best = DISKS[name].time_unit, ex.bounces(rest, accuracy=1e-9)
    how = {"observables": ("phidot",), "method": "dop853", "accuracy": 1e-11}
    later = ex.simulate(rest, t_eval=[1e-4 * unit], **how)
    push = abs(later.phidot[:, 0]) / (1e-4 * unit)
    for speed in (1e-14, 1e-9, 1e-6):
        moving = ex.phi_to_states(rest.disk, rest.phi, speed / unit, rest.sigma3, rest.sigma4)
        found = ex.bounces(moving, accuracy=accuracy)
        assert found.ok.all()
        np.testing.assert_allclose(found.delta_chi, best.delta_chi, atol=10.0 * accuracy)
        np.testing.assert_allclose(found.time[:, 0], speed / unit / push, rtol=1e-3, atol=0.0)


@pytest.mark.filterwarnings("ignore:t_eval")
def test_at_rest_just_beyond_the_vertical_the_first_bounce_is_a_short_one():
    """At a distance d the acceleration a is constant: the stretch takes 2 sqrt(2 d/a)."""
    disk, distance = DISKS["uniform"], np.array([1e-6, 1e-9, 1e-12])
    states = ex.phi_to_states(disk, -distance, 0.0, 0.3, 0.7)
    found = ex.bounces(states, 2)
    assert found.ok.all()
    assert found.face.tolist() == [[-1, 1]] * 3
    how = {"observables": ("phidot",), "method": "dop853", "accuracy": 1e-11}
    speed = ex.simulate(states[1], t_eval=[1e-4], **how).phidot.item()
    np.testing.assert_allclose(found.duration[:, 0], 2.0 * np.sqrt(2e-4 * distance / speed), rtol=1e-5)
    np.testing.assert_allclose(found.theta_min[:, 0], 0.5 * np.pi - distance, rtol=1e-12)
    assert ex.periods(states).ok.all()


@pytest.mark.parametrize("I3", [1e-4, 1e-6, 1e-8])
def test_almost_without_axial_inertia_a_motion_bounces_as_it_passes(I3):
    """What is known of it at the vertical is carried on: a difference of energies has no digits left."""
    disk, eta = ex.Disk(I1=0.25, I3=I3), np.tile([1e-1, -1e-4, 1e-8, -1e-200], 5)
    bar = np.linspace(-1.5, 1.5, 20)
    bounces = ex.bounces(ex.constants_to_states(disk, bar, eta, 1.0), 2)
    passages = ex.passages(disk, bar, eta, 1.0)
    known = passages.ok & bounces.ok[:, 0]
    assert known.sum() >= 18
    assert bounces.ok.all()
    error = abs(bounces.delta_chi[:, 0] - passages.delta_chi)[known]
    assert (error <= (bounces.error_estimate[:, 0] + passages.error_estimate)[known]).all()
    np.testing.assert_allclose(bounces.duration[known, 0], passages.duration[known], rtol=1e-6)


@pytest.mark.parametrize("accuracy", [1e-2, 1e-5, 1e-8])
def test_estimates_know_how_far_later_times_are_off(accuracy):
    random = np.random.default_rng(11)
    states = ex.phi_to_states(ex.Disk.uniform(), random.uniform(-1.4, 1.4, 200), *random.uniform(-1, 1, (3, 200)))
    best, found = ex.bounces(states, 50, accuracy=1e-11), ex.bounces(states, 50, accuracy=accuracy)
    ok = (best.ok & found.ok).all(axis=1)
    assert ok.mean() > 0.95
    longest = np.fmax(best.time, ex.periods(states).period[:, None])
    off = abs(found.time - best.time) / longest / (found.error_estimate + best.error_estimate)
    assert off[ok].max() < 10.0
    of_both = found.error_estimate[:, :2].max(axis=1)
    assert (found.error_estimate <= 2.0 * of_both[:, None])[ok].all()


def test_bounces_near_f_keep_the_constants_of_their_motion_and_go_no_wrong_way():
    states = ex.constants_to_states(
        DISKS["coin"], sigma3_bar=[7.0, 7.0], eta_hat=[1e-3, -1e-3], phidot=30.0, face=1
    )
    table = motion_constants(ex.bounces(states, 3))
    for name, values in (("sigma3_bar", 7.0), ("energy", ex.constants(states).energy[:, None])):
        np.testing.assert_allclose(table[name], np.broadcast_to(values, (2, 3)), rtol=1e-12)
    np.testing.assert_allclose(table["eta_hat"][:, [0, 2]], [[1e-3] * 2, [-1e-3] * 2], rtol=1e-9)
    assert not table["wrong_way"].any()


def test_chosen_bounces_know_the_constants_of_their_motions():
    states = ex.constants_to_states(ex.Disk.hoop(), 1.0, [1e-3, -1e-6, 0.1], 1.0)
    found = ex.bounces(states, 2)
    whole = motion_constants(found)
    for rows in (1, np.s_[:, 0], np.s_[1:], found.face > 0, (np.arange(3), found.theta_min.argmin(-1))):
        for name, values in motion_constants(found[rows]).items():
            np.testing.assert_array_equal(values, np.atleast_1d(whole[name][rows]), err_msg=name)
    assert ex.picture("race-histogram", found[found.face > 0]).axes


@pytest.mark.parametrize("theta", [1e-61, 1e-80, 1e-290])
def test_states_however_flat_have_bounces_and_periods(theta):
    states = ex.theta_to_states(ex.Disk.uniform(), theta, 0.5, theta, 0.3)
    by_steps = ex.bounces(states, method="rk8").theta_min
    for found in (ex.bounces(states).theta_min, ex.periods(states).theta_min, by_steps):
        assert found.ravel() == pytest.approx(ex.falls(states).theta_min_estimate, rel=1e-7)
