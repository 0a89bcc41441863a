"""Motions at any time: beside motions in 128 bits, there and back, on from any state, after many periods."""

import numpy as np
import pytest
from conftest import BODIES
from motions import trajectories
from reference.motions import BY_CONSTANTS, FALLS, IN_TIME, MOTIONS, TIMES, of_one_body
from reference.motions import states_of as given_states

import explorer as ex
from explorer import compiled
from explorer.motion.plan import LOOSEST

ANGLES = ("phi", "chi", "psi")
STATE = ("phi", "phidot", "sigma3", "sigma4")
RANDOM = np.random.default_rng(11).uniform(-1.0, 1.0, (4, 100)) * np.array([[1.3], [1.5], [1.5], [1.5]])
FOUR = pytest.mark.parametrize("name", ["uniform", "hoop", "thick", "coin"])


def random_states(disk):
    phi, *rates = RANDOM
    return ex.phi_to_states(disk, phi, *(rate * disk.rate_unit for rate in rates))


def states_at(disk, motion, row=-1):
    """The states in which motions are at one of their times."""
    return ex.phi_to_states(disk, *(getattr(motion, name)[..., row] for name in STATE))


# Of 600, those without an answer: beside crests, where rounding of the state decides, and of fast spins.
REFUSED = {1e-9: 29, 1e-6: 5, 1e-3: 0}


@pytest.mark.parametrize("accuracy", REFUSED)
def test_motions_are_those_of_an_integration_in_128_bits(accuracy):
    refused = 0
    for row in IN_TIME:
        disk = ex.Disk(I1=row["I1"], I3=row["I3"])
        states = ex.phi_to_states(disk, *(row[name] for name in STATE))
        for t in TIMES:
            found = ex.simulate(states, t_eval=[t], observables=ANGLES, accuracy=accuracy)
            if not found.ok:
                assert found.status == ex.Status.TOO_FEW_DIGITS
                refused += 1
                continue
            error = max(abs(getattr(found, name)[0] - row[f"{name}_{t}"]) for name in ANGLES)
            rounded = 2.2e-16 * (abs(row[f"chi_{t}"]) + abs(row[f"psi_{t}"]))  # of what is compared with
            assert error <= 3.0 * found.error_estimate + rounded
            assert error <= min(accuracy * max(1.0, 0.5 * t), LOOSEST)
    assert refused <= REFUSED[accuracy]


@FOUR
def test_there_and_back_again_every_digit_is_as_it_was(name):
    disk = BODIES[name]
    states, time = random_states(disk), 7.3 * disk.time_unit
    there = trajectories(states, t_eval=[time], observables=(*STATE, "chi", "psi", "path"))
    back = trajectories(
        states_at(disk, there), t_eval=[-time], observables=(*STATE, "chi", "psi", "path"), chi0=there.chi[:, 0]
    )
    ok = there.ok & back.ok
    assert ok.mean() > 0.97
    for quantity, size in zip(STATE, (1.0, *[disk.rate_unit] * 3), strict=True):
        off = (getattr(back, quantity)[:, 0] - getattr(states, quantity)) / size
        assert abs(off[ok]).max() < 1e-12 * amplified(there, ok), quantity
    for off in (back.chi, there.psi + back.psi, (there.path + back.path)[..., :2] / disk.r):
        assert abs(off[ok]).max() < 1e-12 * amplified(there, ok)


def amplified(motion, ok):
    """By how much rounding of a state in between is amplified on its way."""
    return np.fmax(1.0, motion.error_estimate[ok].max() / 1e-13)


@FOUR
def test_a_motion_goes_on_from_any_of_its_states(name):
    """Both halves of the way to 11.3 are the whole."""
    disk = BODIES[name]
    states, names = random_states(disk), (*STATE, "chi", "psi", "path")
    first, last = 3.7 * disk.time_unit, 11.3 * disk.time_unit
    whole = trajectories(states, t_eval=[first, last], observables=names)
    second = trajectories(
        states_at(disk, whole, 0), t_eval=[last - first], observables=names, chi0=whole.chi[:, 0]
    )
    ok = whole.ok & second.ok
    assert ok.mean() > 0.97
    apart = {
        "phi": second.phi[:, 0] - whole.phi[:, 1],
        "chi": second.chi[:, 0] - whole.chi[:, 1],
        "psi": whole.psi[:, 0] + second.psi[:, 0] - whole.psi[:, 1],
        "path": (whole.path[:, 0] + second.path[:, 0] - whole.path[:, 1])[:, :2] / disk.r,
    }
    for quantity, off in apart.items():
        assert abs(off[ok]).max() < 1e-12 * amplified(whole, ok), quantity


@pytest.mark.parametrize("periods", [1, 7, 10**6, -(10**6)])
def test_periods_turn_the_picture_and_move_it_along_and_leave_the_tilt_as_it_is(body, periods):
    """However many; a time of so many periods is itself rounded at 1e-16 of it."""
    states = random_states(body)
    motion = ex.simulate(states, t_eval=[0.0], observables=("phi", "chi", "psi", "path"), chi0=0.3)
    later = [motion[row](periods * motion.period[row]) for row in range(states.size)]
    ok = np.array([bool(each.ok) for each in later])
    assert ok.mean() > 0.95
    phi, chi, path = (np.array([getattr(each, name) for each in later]) for name in ("phi", "chi", "path"))
    close = 1e-12 + 1e-14 * abs(periods)
    assert abs(phi - states.phi)[ok].max() < close
    assert abs(chi - 0.3 - periods * motion.turn)[ok].max() < close * (1.0 + abs(motion.turn[ok]).max())
    # Each period moves the centre by the same step, turned by one period more: a geometric series.
    steps = (motion.shift[:, 0] + 1j * motion.shift[:, 1]) / body.r
    half = 0.5 * motion.turn
    moved = steps * np.exp(1j * (periods - 1) * half) * np.sin(periods * half) / np.sin(half)
    centre = (path[:, 0] + 1j * path[:, 1]) / body.r
    sure = ok & (abs(np.sin(half)) > 1e-2)
    assert abs(centre - moved)[sure].max() < 100.0 * close * (1.0 + abs(moved[sure]).max())


@pytest.mark.parametrize("time", [1e6, -1e6, 1e9])
def test_late_times_are_those_of_period_arithmetic_in_many_digits(time):
    """Of some 370 motions, ordinary ones and extreme ones: after whole periods chi has turned by as many turns."""
    shares, off = [], []
    for rows in of_one_body(~FALLS & ~BY_CONSTANTS):
        motions = MOTIONS[rows]
        disk = ex.Disk(I1=motions["I1"][0], I3=motions["I3"][0])
        period, chi, psi = (
            np.nansum([motions[f"{name}_0"], motions[f"{name}_1"]], axis=0) for name in ("duration", "chi", "psi")
        )
        count = np.round(time / period)
        found = trajectories(
            given_states(disk, motions), t_eval=(count * period)[:, None], observables=ANGLES, accuracy=0.1
        )
        error = np.max(
            [
                abs(found.phi[:, 0] - motions["phi"]),
                abs(found.chi[:, 0] - count * chi),
                abs(found.psi[:, 0] - count * psi),
            ],
            axis=0,
        )
        # Periods and angles in the file, and times, have 16 digits.
        rates = (
            1.0
            + abs(motions["phidot"])
            + abs(motions["sigma4"])
            + abs(motions["sigma3"]) / np.cos(motions["phi"]) ** 2
        )
        known = 4.4e-16 * (abs(time) * rates + abs(count) * (abs(chi) + abs(psi)))
        ok = found.ok
        shares.append(error[ok] / (3.0 * found.error_estimate + known)[ok])
        off.append(error[ok])
    assert sum(map(len, off)) > 350
    assert np.concatenate(shares).max() <= 1.0
    assert np.median(np.concatenate(off)) < 2e-15 * abs(time)


def test_a_turn_and_a_period_are_those_by_quadrature(body):
    states = random_states(body)
    motion, known = ex.simulate(states, t_eval=[0.0]), ex.periods(states, accuracy=1e-11)
    ok = motion.ok & known.ok
    assert ok.mean() > 0.97
    np.testing.assert_allclose(motion.period[ok], known.period[ok], rtol=1e-11)
    np.testing.assert_allclose(motion.turn[ok], known.chi[ok], atol=1e-10)


@pytest.mark.parametrize("t", [-50.0, 0.3, 9.0, 1e4])
def test_constants_stay_what_they_are(body, t):
    """Of the states that are given, rounded, in four numbers each."""
    states = random_states(body)
    motion = ex.simulate(states, t_eval=[t * body.time_unit], observables=STATE)
    assert motion.ok.mean() > 0.97
    before, after = (ex.constants(each) for each in (states, states_at(body, motion)))
    for name, size in (
        ("energy", body.energy_unit),
        ("sigma3_bar", body.rate_unit),
        ("eta_hat_plus", body.rate_unit),
    ):
        off = abs(getattr(after, name) - getattr(before, name))[motion.ok] / size
        assert off.max() < 1e-12, name


@pytest.mark.parametrize("eta_hat", [1e-6, -1e-12, 1e-50, -1e-200, 1e-290])
def test_the_race_is_seen_at_any_distance_from_f_since_the_lowest_point(body, eta_hat):
    """chi follows kappa atan of the time over theta_min/A, section 7: half of kappa pi each way."""
    unit = body.rate_unit
    states = ex.constants_to_states(body, unit, eta_hat * unit, unit)
    motion = ex.simulate(states, t_eval=[0.0], observables=("tilt", "phidot", "chi"))
    lowest = motion(0.0, since="lowest")
    speed = ex.limit_motion(ex.constants_to_states(body, unit, 0.0, unit)).impact_speed
    scale = lowest.tilt / speed
    parts = np.array([-1e3, -30.0, -2.0, -1.0, -0.1, 0.3, 1.0, 5.0, 1e3])
    race = motion(parts * scale, since="lowest")
    assert lowest.phidot == pytest.approx(0.0, abs=1e-12 * speed)
    close = 1e-10 + 1e4 * abs(eta_hat)
    expected = np.sign(eta_hat) * body.kappa * np.arctan(parts)
    np.testing.assert_allclose(race.chi - lowest.chi, expected, atol=close)
    np.testing.assert_allclose(race.tilt / lowest.tilt, np.hypot(1.0, parts), rtol=close)
    np.testing.assert_allclose(race.phidot, -speed * parts / np.hypot(1.0, parts), atol=close * speed)


def test_times_since_the_lowest_point_are_those_since_the_start_less_that_of_the_first_bounce(body):
    states = random_states(body)
    motion, first = ex.simulate(states, t_eval=[0.0], observables=ANGLES), ex.bounces(states, 2)
    lowest = motion(0.0, since="lowest")
    ok = motion.ok & first.ok.all(axis=1)
    # Of two bounces on both faces, the flatter one; times where both are equally flat say nothing.
    which = np.argmin(first.theta_min, axis=1)
    sure = ok & ((abs(np.diff(first.theta_min, axis=1)[:, 0]) > 1e-6) | (first.face[:, 0] == first.face[:, 1]))
    which = np.where(first.face[:, 0] == first.face[:, 1], 0, which)
    assert sure.mean() > 0.9
    flattest = np.take_along_axis(first.theta_min, which[:, None], axis=1)[:, 0]
    np.testing.assert_allclose(0.5 * np.pi - abs(lowest.phi)[sure], flattest[sure], atol=1e-9)
    for row in np.flatnonzero(sure)[:20]:
        t = 0.1 * body.time_unit * np.array([-1.0, 0.0, 7.0])
        since, start = motion[row](t, since="lowest"), motion[row](t + first.time[row, which[row]])
        np.testing.assert_allclose(since.chi, start.chi, atol=1e-4)
        np.testing.assert_allclose(since.phi, start.phi, atol=1e-5)


def test_integrations_ask_exact_motions_nothing(monkeypatch):
    """With their kernels out of order all that rests on integration alone, or on quadrature, still answers."""

    def broken(*_):
        raise AssertionError("an exact motion was asked for")

    states = ex.phi_to_states(BODIES["uniform"], [0.2, -0.4], 1.0, 0.8, 0.3)
    monkeypatch.setattr(compiled.motions, "motion_batch", broken)
    monkeypatch.setattr(compiled.motions, "course_batch", broken)
    with pytest.raises(AssertionError, match="was asked for"):
        ex.simulate(states, t_eval=[1.0])
    for method in ("rk8", "dop853"):
        how = {"method": method, "accuracy": 1e-6}
        assert ex.simulate(states, t_eval=[1.0], **how)(0.7).ok.all()
        assert ex.bounces(states, 2, **how).ok.all()
        assert ex.periods(states, **how).ok.all()
        assert ex.passages(BODIES["uniform"], 1.0, [1e-3, -1e-6], 1.0, **how).ok.all()
    assert ex.compare(states, ("quadrature", "rk8", "dop853")).bounces["rk8"].ok.all()
    trade = ex.trade(samples=256, eta_hat=(1e-6, 1.0), progress=False)
    assert {row.method for row in trade.rows} == {"quadrature", "rk4", "rk8", "dopri5", "dop853"}
