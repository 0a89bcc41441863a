"""The two one-sided limit motions, section 7."""

import numpy as np
import pytest
from conftest import BODIES
from motions import trajectories
from moving import nu, velocity
from passing import start_on_f

import explorer as ex
from explorer.motion.fall_integrals import fall_from_vertical
from explorer.motion.limit_motions import limit_motion
from explorer.phase.coordinates import constants_to_states

ALL = ("phi", "phidot", "chi", "psi", "path", "contact")
IMPACT = {"uniform": 1.816042, "hoop": 1.758017}


@pytest.mark.parametrize("face", [1, -1])
@pytest.mark.parametrize("sign", [1, -1])
def test_motions_beside_f_converge_to_the_limit_of_their_side(body, face, sign):
    """Away from the impacts, in every observable, through three falls."""
    unit = body.rate_unit
    limit = limit_motion(start_on_f(body, face), sign)
    times = np.linspace(0.0, 3 * limit.period, 200)
    times = times[abs(times[:, None] - limit.impacts(4 * limit.period)).min(axis=1) > 0.1 * limit.period]
    want = limit(times)
    sizes = {"phidot": unit, "path": body.r, "contact": body.r}
    distances = []
    for eta_hat in (1e-4, 1e-6):
        states = constants_to_states(body, unit, sign * eta_hat * unit, unit, face)
        got = trajectories(states, t_eval=times, observables=ALL, accuracy=1e-9)
        assert got.status == ex.Status.OK
        distances.append(
            [abs(getattr(got, name) - getattr(want, name)).max() / sizes.get(name, 1.0) for name in ALL]
        )
    far, near = np.array(distances)
    kappa = body.kappa
    assert (near < 2e-4 * kappa).all()
    assert (near < 0.05 * far).all()  # eta ln(1/eta) gives 0.015; crossings of zero spread it


@pytest.mark.parametrize("name", IMPACT)
def test_impact_speed_is_the_published_one(name):
    """Checklist 36."""
    limit = limit_motion(start_on_f(BODIES[name], 1), 1)
    assert limit.impact_speed == pytest.approx(IMPACT[name], abs=5e-7)


@pytest.mark.parametrize("face", [1, -1])
def test_jumps_at_an_impact_are_those_of_section_7(body, face):
    """chi by sgn(eta) kappa pi, psi by face times that, phidot reversed; the centre does not jump."""
    for sign in (1, -1):
        limit = limit_motion(start_on_f(body, face), sign)
        hit = limit.impacts(5 * limit.period)
        step = 1e-7 * body.time_unit
        for time in hit[:3]:
            before, after = limit(time - step), limit(time + step)
            assert after.chi - before.chi == pytest.approx(sign * body.race_limit, abs=1e-5)
            assert after.psi - before.psi == pytest.approx(face * sign * body.race_limit, abs=1e-5)
            assert before.phidot == pytest.approx(face * limit.impact_speed, rel=1e-5)
            assert after.phidot == pytest.approx(-face * limit.impact_speed, rel=1e-5)
            assert np.linalg.norm(after.path - before.path) < 1e-5 * body.r


def test_horizontal_velocity_of_the_centre_turns_by_kappa_pi_at_an_impact():
    """Cor. 2, with the vertical part reflected."""
    disk = BODIES["hoop"]
    for sign in (1, -1):
        limit = limit_motion(start_on_f(disk, 1), sign)
        time, step = limit.impacts(10.0)[0], 1e-6
        before = (limit(time - step).path - limit(time - 2 * step).path) / step
        after = (limit(time + 2 * step).path - limit(time + step).path) / step
        turn = np.angle(complex(*after[:2]) / complex(*before[:2]))
        assert np.cos(turn - sign * disk.race_limit) == pytest.approx(1.0, abs=1e-6)
        assert after[2] == pytest.approx(-before[2], rel=1e-4)


def test_the_two_limits_coincide_for_the_matching_body_and_only_for_it(paper_body):
    plus, minus = (limit_motion(start_on_f(paper_body, 1), sign) for sign in (1, -1))
    times = np.linspace(0.0, 3 * plus.period, 300)
    apart = abs(plus(times).contact - minus(times).contact).max()
    if paper_body.name == "matching":
        assert apart < 1e-9
    else:
        assert apart > 0.5
    turned = plus(times).chi[-1] - minus(times).chi[-1]
    falls = plus.impacts(times[-1]).size
    assert turned == pytest.approx(2 * falls * paper_body.race_limit, abs=1e-9)


def test_every_bounce_turns_and_moves_the_picture_alike(paper_body):
    """By chi_per_period, a whole turn for the matching body; also before the start, and after a million."""
    limit = limit_motion(start_on_f(paper_body, 1), 1)
    first = np.array([-2, -1, 0, 1, 2, 10**6, 10**6 + 1, 10**6 + 2])
    steps = np.diff(limit(0.3 + limit.period * first).path @ [1.0, 1.0j, 0.0])
    assert steps[1:4] / steps[:3] == pytest.approx(np.exp(1j * limit.chi_per_period), abs=1e-12)
    assert steps[6] / steps[5] == pytest.approx(np.exp(1j * limit.chi_per_period), abs=1e-6)
    assert abs(steps[5]) == pytest.approx(abs(steps[0]), rel=1e-6)


def test_the_limit_starts_where_it_was_asked_and_may_start_anywhere_on_f():
    disk = BODIES["uniform"]
    first = limit_motion(start_on_f(disk, 1), 1)
    for time in (0.3, 1.5, 2.9):
        there = first(time)
        sigma = natural_state_on_f(disk, float(there.phi))
        second = limit_motion(ex.phi_to_states(disk, float(there.phi), float(there.phidot), *sigma), 1)
        start = second(0.0)
        assert float(start.phi) == pytest.approx(float(there.phi), abs=1e-9)
        assert float(start.phidot) == pytest.approx(float(there.phidot), abs=1e-9)
        assert float(start.chi) == 0.0
        assert float(second(1.1).phi) == pytest.approx(float(first(time + 1.1).phi), abs=1e-8)
        turned = float(first(time + 1.1).chi - there.chi)
        assert float(second(1.1).chi) == pytest.approx(turned, abs=1e-8)


def natural_state_on_f(disk, phi):
    """(sigma3, sigma4) at phi on l_+ with sigma3_bar = 1."""
    from kernels.disk.falling import on_f

    f = on_f(np.cos(phi), np.sin(phi), 1.0 / disk.body.r0, disk.natural)
    return f.turn * np.cos(phi) ** 2, f.sigma4


@pytest.mark.parametrize("speed", [1e-6, 1e-3, 0.1, 1.0, 30.0])
def test_the_fall_is_integrated_well_however_slowly_it_starts(speed):
    """Against SciPy on the plain second-order equation M phi'' = -V'(phi) on F."""
    from scipy.integrate import solve_ivp

    from kernels.disk.falling import on_f

    disk = BODIES["hoop"]
    b, X = disk.body, 1.0 / disk.body.r0

    def rate(_t, y):
        f = on_f(np.cos(y[0]), np.sin(y[0]), X, disk.natural)
        return [y[1], -f.dV / b.M, f.turn]

    def flat(_t, y):
        return y[0] - 1.5

    flat.terminal = True
    natural = start_on_f(disk, 1, 1.0, speed).motion
    slow = solve_ivp(rate, (0, 50), [0.0, speed, 0.0], "DOP853", events=flat, rtol=1e-12, atol=1e-13)
    limit = limit_motion(start_on_f(disk, 1, 1.0, speed), 1)
    got = limit(slow.t_events[0][0])
    assert float(got.phi) == pytest.approx(1.5, abs=1e-8)
    assert float(got.chi) == pytest.approx(slow.y_events[0][0][2], abs=1e-8)
    time, _chi, _psi, _error = fall_from_vertical(disk, natural.sigma3_bar, natural.energy)
    assert time[0] == pytest.approx(limit.impacts(50.0)[0], rel=1e-9)


@pytest.mark.parametrize(
    ("state", "sign", "message"),
    [
        ((0.0, 1.0, 1.0, 0.7286), 2, "side"),
        ((0.0, 0.0, 3.0, 0.0), 1, "would not fall"),
        ((np.nan, 0.0, 3.0, 0.0), 1, "would not fall"),
        ((0.0, 1e-9, 0.0, 0.0), 1, "would not fall"),
    ],
)
def test_states_without_a_limit_motion_are_refused_in_words(state, sign, message):
    with pytest.raises(ex.InputError, match=message):
        limit_motion(ex.phi_to_states(BODIES["uniform"], *state), sign)


@pytest.mark.parametrize("face", [1, -1])
@pytest.mark.parametrize("side", [1, -1])
def test_before_the_start_a_limit_motion_is_that_of_the_reversed_state(body, face, side):
    """Eq. (3.12): with the signs of phidot and time changed, chi and psi turn back, mirrored at the start."""
    unit = body.rate_unit
    there, back = (
        limit_motion(ex.constants_to_states(body, 0.8 * unit, 0.0, 1.3 * unit * way, face), side)
        for way in (1, -1)
    )
    times = np.linspace(0.01, 9.0, 50) * body.time_unit
    before, after = there(-times), back(times)
    for name, way in (("phi", 1), ("phidot", -1), ("sigma3", 1), ("sigma4", 1)):
        np.testing.assert_allclose(getattr(before, name), way * getattr(after, name), atol=1e-11 * unit)
    # The picture of an upright start is mirrored in the line through both points of contact.
    for name in ("chi", "psi"):
        np.testing.assert_allclose(getattr(before, name), -getattr(after, name), atol=1e-11)
    np.testing.assert_allclose(before.path, after.path * [1.0, -1.0, 1.0], atol=1e-11 * body.r)


@pytest.mark.parametrize("face", [1, -1])
@pytest.mark.parametrize("name", ["uniform", "hoop", "thick"])
def test_limits_at_the_impact_are_those_of_sections_6_and_7(name, face):
    """(6.12), (6.15), (7.16)-(7.20) and Lemma 8, to 1e-9."""
    disk = BODIES[name]
    b = disk.body
    sigma3_bar = 0.8
    for sign in (1, -1):
        limit = limit_motion(start_on_f(disk, face, sigma3_bar), sign)
        A, B = limit.impact_speed, b.I1 * sigma3_bar / (b.I3 * b.r0)
        hit = limit.impacts(20.0)[1]
        before, after = limit(hit * (1 - 4e-16 * 8)), limit(hit * (1 + 4e-16 * 8))
        down, up = float(before.chi), float(after.chi)
        assert up - down == pytest.approx(sign * disk.race_limit, abs=1e-9)
        assert float(before.phidot) == pytest.approx(face * A, abs=1e-9)
        assert float(after.phidot) == pytest.approx(-face * A, abs=1e-9)
        want = (
            (nu(before), (face * A * np.sin(down), -face * A * np.cos(down), B)),
            (nu(after), (-face * A * np.sin(up), face * A * np.cos(up), B)),
            (velocity(before), (face * B * np.sin(down), -face * B * np.cos(down), -A)),
            (velocity(after), (face * B * np.sin(up), -face * B * np.cos(up), A)),
        )
        for got, expected in want:
            np.testing.assert_allclose(got, expected, atol=1e-9)
        # the points of contact are the hinges of the fall and of the rise
        for at, chi in ((before, down), (after, up)):
            np.testing.assert_allclose(
                at.contact - at.path, [face * np.cos(chi), face * np.sin(chi), 0.0], atol=1e-9
            )


def test_anything_but_one_state_is_refused():
    for states in ((0, 1, 1, 0.7), "flat", ex.phi_to_states(BODIES["uniform"], [0, 0], 1, 1, 0.7)):
        with pytest.raises(ex.InputError, match="state"):
            limit_motion(states)


def test_a_state_beside_f_has_no_limit_motion_and_rounding_is_no_distance():
    disk = BODIES["uniform"]
    with pytest.raises(ex.InputError, match=r"not on F, but at eta_hat = 0\.01; for the one on F use"):
        limit_motion(ex.constants_to_states(disk, 1.0, 0.01, 1.0), 1)
    rounded, exact = (limit_motion(ex.constants_to_states(disk, 1.0, eta, 1.0), 1) for eta in (1e-14, 0.0))
    assert rounded.period == pytest.approx(exact.period, rel=1e-12)


@pytest.mark.parametrize("sigma3_bar", [5e-324, -1e-310, 1e-300])
def test_the_smallest_numbers_that_are_not_zero_have_a_limit_motion_too(sigma3_bar):
    disk = BODIES["hoop"]
    tiny, small = (limit_motion(ex.constants_to_states(disk, s, 0.0, 1.0), 1) for s in (sigma3_bar, 1e-200))
    assert tiny.period == pytest.approx(small.period, rel=1e-12)
    assert np.isfinite(tiny([0.5, 2.0, 9.0]).chi).all()


def test_times_beyond_all_digits_have_no_answer_and_say_so():
    limit = limit_motion(start_on_f(BODIES["uniform"], 1), 1)
    for late in (1e300, -1e300):
        found = limit(late)
        assert found.status == ex.Status.TOO_FEW_DIGITS
        assert np.isnan(found.phi)
    for never in (np.inf, np.nan):
        with pytest.raises(ex.InputError, match="times must be finite"):
            limit(never)


@pytest.mark.parametrize("t", [0.5, [0.5], [[0.1, 0.2, 0.3]], []])
def test_a_limit_motion_has_all_observables_in_the_shape_of_the_times(t):
    found = limit_motion(start_on_f(ex.Disk.uniform(), 1))(t)
    for name in ("t", "phi", "tilt", "phidot", "sigma3", "sigma4", "chi", "psi"):
        assert getattr(found, name).shape == np.shape(t)
    for name in ("path", "contact"):
        assert getattr(found, name).shape == (*np.shape(t), 3)


@pytest.mark.filterwarnings("error")
def test_a_state_within_rounding_of_flat_is_refused_in_words():
    with pytest.raises(ex.InputError, match="period is infinite"):
        limit_motion(ex.theta_to_states(ex.Disk.uniform(), 1e-290, 0.1, 1e-120, 0.3))
