"""Exact motions: at any time, and as curves, dense at any distance from F and right inside a race."""

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.motion import exact
from explorer.paper import eight_dimensions as plain_disk

ETAS = np.array([1e-1, -1e-2, 1e-3, -1e-4, 1e-6, -1e-8, 1e-10, -1e-12, 1e-100, -1e-300])


@pytest.fixture(scope="module")
def raced():
    """Motions at all distances from F, through three falls."""
    return ex.simulate(ex.constants_to_states(BODIES["uniform"], 1.0, ETAS, 1.0), 10.0)


def test_chi_never_turns_by_more_than_a_fifth_between_two_times_at_any_distance_from_f(raced):
    assert (raced.status == 0).all()
    assert (abs(np.diff(raced.chi)) <= exact.LONGEST_ANGLE).all()
    # Three races that take a millionth of the motion need few times.
    assert raced.lengths[4] < 2000
    # Three races, three falls
    assert (np.sign(ETAS) * (raced.chi[:, -1] - raced.chi[:, 0]) > 3.0 * np.pi).all()


@pytest.mark.parametrize("name", ["hoop", "heavy-core", "thick", "coin"])
def test_so_it_is_for_other_bodies(name):
    disk = BODIES[name]
    unit = disk.rate_unit
    states = ex.constants_to_states(disk, 0.7 * unit, [1e-2 * unit, -1e-9 * unit], unit)
    motion = ex.simulate(states, 8.0 / unit)
    assert (motion.status == 0).all()
    assert abs(np.diff(motion.chi)).max() <= exact.LONGEST_ANGLE
    assert (np.diff(motion.t) >= 0.0).all()
    np.testing.assert_allclose(motion.t[:, [0, -1]], [[0.0, 8.0 / unit]] * 2, rtol=1e-15)


def test_rows_of_shorter_motions_repeat_their_end(raced):
    motion = raced
    assert motion.lengths.max() == motion.t.shape[1] > motion.lengths.min()
    for row, length in enumerate(motion.lengths):
        for name in ("t", "phi", "chi", "psi", "path", "contact"):
            values = getattr(motion, name)[row]
            assert (values[length:] == values[length - 1]).all()
        assert motion.t[row, length - 1] == motion.t_end > motion.t[row, length - 2]


@pytest.mark.parametrize("name", ["uniform", "coin"])
def test_called_at_its_own_times_a_motion_gives_its_own_points(name):
    disk = BODIES[name]
    states = ex.constants_to_states(disk, disk.rate_unit, 1e-11 * disk.rate_unit, disk.rate_unit)
    motion = ex.simulate(states, 5.0 * disk.time_unit)
    again = motion(motion.t)
    for one, size in (("phi", 1.0), ("path", disk.r)):
        np.testing.assert_allclose(getattr(again, one), getattr(motion, one), rtol=0.0, atol=1e-14 * size)
    away = abs(motion.phi) < 0.5 * np.pi - 1e-3  # inside a race a time since the start does not tell chi
    for one in ("chi", "contact"):
        np.testing.assert_allclose(getattr(again, one)[away], getattr(motion, one)[away], rtol=0.0, atol=1e-10)


def test_the_full_equations_are_met_in_and_out_of_a_race():
    """Eq. (2.13) in eight dimensions by another integrator, whose own error is some 1e-10."""
    disk = BODIES["hoop"]
    states = ex.constants_to_states(disk, 1.0, 0.01, 1.0)
    middle = ex.bounces(states).time
    times = np.sort(np.concatenate([np.linspace(0.05, 3.0, 60), middle + np.linspace(-0.02, 0.02, 60)]))
    full = plain_disk.integrate(disk, np.array([0.0, 1.0, states.sigma3, states.sigma4]), times)
    motion = ex.simulate(states, 3.1, accuracy=1e-10)
    got = motion(times)
    assert np.ptp(got.chi[abs(times - middle) < 0.02]) > 0.5 * disk.race_limit
    np.testing.assert_allclose(got.path, full.a, atol=1e-9)
    np.testing.assert_allclose(got.contact, full.contact, atol=1e-9)
    np.testing.assert_allclose(np.sin(got.phi), full.sigma[:, 0], atol=1e-9)


@pytest.mark.parametrize("eta_hat", [1e-6, -1e-8, 1e-10, -1e-200])
def test_the_points_of_a_curve_are_right_inside_a_race(eta_hat):
    """As those of times since the lowest point with the same speed; times since the start tell nothing there."""
    states = ex.constants_to_states(BODIES["uniform"], 1.0, eta_hat, 1.0)
    curve = ex.simulate(states, 3.0, observables=("tilt", "phidot", "chi"))
    least = curve(0.0, since="lowest").tilt
    inside = curve.tilt < 2.0 * least
    phidot, chi = curve.phidot[inside], curve.chi[inside]
    assert phidot.size > 20
    speed = ex.limit_motion(ex.constants_to_states(BODIES["uniform"], 1.0, 0.0, 1.0)).impact_speed
    tangent = -phidot / np.sqrt(speed**2 - phidot**2)
    for _ in range(6):  # Newton's method; the tilt is very nearly least sqrt(1 + tangent^2)
        at = curve(tangent * least / speed, since="lowest")
        tangent = tangent + (at.phidot - phidot) / speed * (1.0 + tangent**2) ** 1.5
    np.testing.assert_allclose(at.phidot, phidot, rtol=0.0, atol=1e-14)
    np.testing.assert_allclose(at.chi, chi, rtol=0.0, atol=1e-11)


@pytest.mark.parametrize("t_eval", [None, [0.5, 2.0]])
def test_any_number_of_threads_gives_the_same_numbers(t_eval):
    disk = BODIES["uniform"]
    etas = [1e-3, -1e-9, 0.0, 0.1, np.nan, 1e-30, 1e-2]
    states = ex.constants_to_states(disk, np.linspace(0.5, 1.5, 7), etas, 1.0)
    names = ("phi", "chi", "path") if t_eval is None else ("phi",)
    one, three = (ex.simulate(states, 2.0, t_eval=t_eval, observables=names, jobs=jobs) for jobs in (1, 3))
    assert one.status.tolist() == three.status.tolist() == [0, 0, 1, 0, 2, 0, 0]
    for name in ("t", "phi", "chi", "path", "steps", "constants_error", "lengths"):
        np.testing.assert_array_equal(getattr(one, name), getattr(three, name))
    times = [1.9, 0.0, 0.3]
    np.testing.assert_array_equal(one(times).phi, three(times).phi)
    assert one(times).phi.shape == (7, 3)
    assert one(0.3).phi.shape == (7,)
    assert np.isnan(one(0.3).phi[[2, 4]]).all()


def test_curves_that_would_fill_the_memory_are_refused(monkeypatch):
    monkeypatch.setattr(exact, "MOST_POINTS", 5000)
    states = ex.phi_to_states(BODIES["uniform"], 0.2, 1.0, 1.0, [0.3] * 4)
    assert ex.simulate(states, 5.0).t.size < 5000
    with pytest.raises(ex.InputError, match="give t_eval, fewer states or a smaller t_end"):
        ex.simulate(states, 1e4)


@pytest.mark.parametrize("t_end", [1e300, 1.7e308])
def test_curves_that_no_memory_holds_are_refused_and_times_beyond_all_digits_have_no_answer(t_end):
    states = ex.phi_to_states(BODIES["uniform"], 0.3, 0.1, 0.5, 0.5)
    with pytest.raises(ex.InputError, match="give t_eval"):
        ex.simulate(states, t_end)
    assert ex.simulate(states, t_eval=[t_end]).status == ex.Status.TOO_FEW_DIGITS


def test_a_curve_shorter_than_its_least_step_is_right_within_it():
    states = ex.phi_to_states(BODIES["uniform"], 0.3, 0.2, 0.5, 0.4)
    within = ex.simulate(states, 0.01)(0.004)
    other = ex.simulate(states, t_eval=[0.004], method="rk8", accuracy=1e-11, observables=("phi", "chi", "psi"))
    for name in ("phi", "chi", "psi"):
        assert getattr(within, name) == pytest.approx(getattr(other, name)[0], abs=1e-13)
