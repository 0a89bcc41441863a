"""Motions at their own steps: dense enough for curves, right at any time between, also inside a race."""

import numpy as np
import pytest
from conftest import BODIES
from motions import trajectories
from scipy.optimize import brentq

import explorer as ex
from explorer.motion import dense_output
from explorer.paper import eight_dimensions as plain_disk

ETAS = np.array([1e-1, -1e-2, 1e-3, -1e-4, 1e-6, -1e-8, 1e-10, -1e-12, 1e-100, -1e-300])


@pytest.fixture(scope="module")
def raced():
    """Motions at all distances from F, through three falls, and the same much more accurately."""
    states = ex.constants_to_states(BODIES["uniform"], 1.0, ETAS, 1.0)
    return ex.simulate(states, 10.0), ex.simulate(
        states, 10.0, accuracy=1e-11, observables=["phi", "phidot", "chi"]
    )


def test_chi_never_turns_by_more_than_a_fifth_between_two_times_at_any_distance_from_f(raced):
    for motion in raced:
        assert (motion.status == 0).all()
        assert (abs(np.diff(motion.chi)) <= dense_output.LONGEST_ANGLE).all()
    # Three races that take a millionth of the motion need few times.
    assert raced[0].lengths[4] < 2000
    # Three races, three falls
    assert (np.sign(ETAS) * (motion.chi[:, -1] - motion.chi[:, 0]) > 3.0 * np.pi).all()


@pytest.mark.parametrize("name", ["hoop", "heavy-core", "thick", "coin"])
@pytest.mark.parametrize("method", ["auto", "rk4"])
def test_so_it_is_for_other_bodies_and_for_fixed_steps(name, method):
    disk = BODIES[name]
    unit = disk.rate_unit
    states = ex.constants_to_states(disk, 0.7 * unit, [1e-2 * unit, -1e-9 * unit], unit)
    motion = ex.simulate(states, 8.0 / unit, accuracy=1e-4, method=method)
    assert (motion.status == 0).all()
    assert abs(np.diff(motion.chi)).max() <= dense_output.LONGEST_ANGLE
    assert (np.diff(motion.t) >= 0.0).all()
    np.testing.assert_allclose(motion.t[:, [0, -1]], [[0.0, 8.0 / unit]] * 2, rtol=1e-15)


def test_rows_of_shorter_motions_repeat_their_end(raced):
    motion = raced[0]
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
    for one in ("phi", "chi", "path", "contact"):
        np.testing.assert_array_equal(getattr(again, one), getattr(motion, one))


def test_between_the_records_the_full_equations_are_met_in_and_out_of_a_race():
    """Eq. (2.13) in eight dimensions by another integrator, at times that nothing recorded."""
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


def test_between_the_records_a_motion_is_as_accurate_as_they_are(raced):
    motion, tight = raced
    times = np.linspace(0.0, 10.0, 173)
    flattest = ex.bounces(ex.constants_to_states(BODIES["uniform"], 1.0, 1e-6, 1.0), 5).time
    away = (abs(times[:, None] - flattest) > 0.2).all(axis=1)
    for name in ("phi", "chi"):
        error = abs(getattr(motion(times), name) - getattr(tight(times), name))
        assert error[:, away].max() < 3e-6


@pytest.mark.parametrize("eta_hat", [1e-6, -1e-8, 1e-10])
def test_inside_a_race_chi_is_right_where_the_speed_is(eta_hat):
    """Two integrations differ in time by more than the race lasts; so they are compared at the same phidot."""
    states = ex.constants_to_states(BODIES["uniform"], 1.0, eta_hat, 1.0)
    names = ("phi", "phidot", "chi")
    motion, tight = (ex.simulate(states, 3.0, observables=names, accuracy=accuracy) for accuracy in (1e-6, 1e-11))
    own = motion.t[(abs(motion.phidot) < 1.6) & (np.cos(motion.phi) < 1e-3)]
    between = motion(0.5 * (own[1:] + own[:-1]))
    assert between.phi.size > 20
    ends = tight.t[np.cos(tight.phi) < 1e-3][[0, -1]]
    for speed, chi in zip(between.phidot, between.chi, strict=True):
        time = brentq(lambda t, speed=speed: tight(t).phidot - speed, *ends, xtol=1e-18, rtol=1e-15)
        # A time of order one is rounded at some 1e-15, and chidot is some 4/eta_hat
        assert tight(time).chi == pytest.approx(chi, abs=1e-5 + 1e-13 / abs(eta_hat))


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
    monkeypatch.setattr(dense_output, "MOST_POINTS", 5000)
    states = ex.phi_to_states(BODIES["uniform"], 0.2, 1.0, 1.0, [0.3] * 4)
    assert ex.simulate(states, 5.0).t.size < 5000
    with pytest.raises(ex.InputError, match="give t_eval, fewer states or a smaller t_end"):
        ex.simulate(states, 1e4)


@pytest.mark.parametrize("accuracy", [1e-2, 1e-6, 1e-10])
@pytest.mark.parametrize("method", ["rk8", "dop853", "dopri5"])
def test_the_accuracy_asked_of_a_curve_is_the_accuracy_met(method, accuracy):
    """At all of its points: the 99th percentile of the error per passage. Steps short enough to draw err less."""
    rng = np.random.default_rng(3)
    etas = rng.choice([-1.0, 1.0], 8) * 10.0 ** rng.uniform(-8.0, 0.0, 8)
    states = ex.constants_to_states(BODIES["uniform"], rng.uniform(-2, 2, 8), etas, rng.uniform(0.5, 2, 8))
    names = ("phi", "chi", "psi", "path")
    curve, found = ex.simulate(states, 5.0, method=method, accuracy=accuracy, observables=names), []
    for j, length in enumerate(curve.lengths):
        t, own = np.unique(curve.t[j, :length], return_index=True)
        exact = trajectories(states[j], t_eval=t, observables=names, method="rk8", accuracy=1e-11)
        error = np.linalg.norm(curve.path[j, own] - exact.path, axis=-1)
        for name in names[:3]:
            error = np.maximum(error, abs(getattr(curve, name)[j, own] - getattr(exact, name)))
        away = abs(exact.phi) < 0.5 * np.pi - 0.1  # in a race errors of the time count many times
        found.append((error / np.maximum(1.0, 0.5 * t))[away])
    assert np.percentile(np.concatenate(found), 99) < accuracy


def test_a_fast_spin_whose_error_no_second_run_could_tell_has_no_answer():
    """The second run takes finer steps; where those come to no end, nothing tells the error."""
    states = ex.phi_to_states(ex.Disk(I1=0.25, I3=1e-9), 0.03, -1000.0, [1.57, 0.5], -0.1)
    whole = ex.simulate(states, t_eval=[1.0], accuracy=1e-3)
    assert whole.ok.all()
    for jobs in (1, 2):
        motion = ex.simulate(states, t_eval=[1.0], accuracy=1e-3, max_steps=int(whole.steps.min()) // 4, jobs=jobs)
        assert (motion.status == ex.Status.STEP_LIMIT).all()
        assert np.isnan(motion.phi).all()


def test_a_curve_of_a_single_step_is_right_within_it():
    states = ex.phi_to_states(BODIES["uniform"], 0.3, 0.2, 0.5, 0.4)
    within = ex.simulate(states, 0.01)(0.004)
    exact = ex.simulate(states, t_eval=[0.004], accuracy=1e-11, observables=("phi", "chi", "psi"))
    for name in ("phi", "chi", "psi"):
        assert getattr(within, name) == pytest.approx(getattr(exact, name)[0], abs=1e-7)


@pytest.mark.parametrize("t_end", [1e300, 1.7e308])
def test_no_time_is_too_long_to_be_begun(t_end):
    states = ex.phi_to_states(BODIES["uniform"], 0.3, 0.1, 0.5, 0.5)
    assert ex.simulate(states, t_end, max_steps=1000).status == ex.Status.STEP_LIMIT
