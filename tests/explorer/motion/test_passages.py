"""Passages near flat: the race and its law, falls, windows, mirror images, and input that is none."""

import numpy as np
import pytest
from conftest import BODIES
from scipy.special import ellipkinc
from shares import INTEGRATORS, Passages, assert_paid_for

import explorer as ex
from explorer.motion.passage_starts import starts_at_vertical
from explorer.motion.passages import passages_by, reference_passages
from explorer.motion.plan import plan
from explorer.phase.coordinates import constants_to_states
from explorer.phase.states import phi_to_states


@pytest.mark.parametrize("face", [1, -1])
def test_the_other_side_is_the_mirror_image(face):
    disk = BODIES["thick"]
    here = ex.passages(disk, 0.7, [1e-3, -1e-9], 0.9, face=face)
    there = ex.passages(disk, 0.7, [1e-3, -1e-9], 0.9, face=-face)
    np.testing.assert_array_equal(here.delta_chi, there.delta_chi)
    np.testing.assert_array_equal(here.delta_psi, -there.delta_psi)
    integrated = ex.passages(disk, 0.7, [1e-3, -1e-3], 0.9, face=face, method="dopri5", accuracy=1e-9)
    exact = ex.passages(disk, 0.7, [1e-3, -1e-3], 0.9, face=face)
    np.testing.assert_allclose(integrated.delta_psi, exact.delta_psi, atol=1e-7)


def test_the_race_tends_to_kappa_pi_for_every_body_and_start():
    rng = np.random.default_rng(14)
    for disk in (*BODIES.values(), ex.Disk(I1=1e-4, I3=2e-4), ex.Disk(I1=1e4, I3=1e4)):
        unit = disk.rate_unit
        n = 200
        eta = 10 ** rng.uniform(-40, -14, n) * rng.choice([-1, 1], n) * unit
        got = ex.passages(disk, rng.uniform(-2, 2, n) * unit, eta, rng.uniform(0.3, 3, n) * unit, accuracy=1e-9)
        assert (got.status == 0).all()
        np.testing.assert_allclose(got.race_angle, np.sign(eta) * disk.race_limit, atol=1e-8 * disk.kappa)


@pytest.mark.parametrize("name", ["uniform", "hoop", "thick"])
def test_the_law_of_the_race_angle(name):
    """2 m g r eta ln(1/|eta|) / (I1 M A^3) + O(eta): the coefficient within 1 %, from its slope in ln eta."""
    disk = BODIES[name]
    b = disk.body
    eta_hat = np.array([1e-6, 1e-7, 1e-8, 1e-9])
    got = ex.passages(disk, 1.0, eta_hat, 1.0, accuracy=1e-13)
    eta = eta_hat * b.I3 * b.r0
    rest = (got.race_angle - got.limit) / eta
    slope = np.polyfit(np.log(1 / eta), rest, 1)[0]
    assert slope == pytest.approx(2.0 / (b.I1 * b.M * got.impact_speed[0] ** 3), rel=0.01)


def test_a_window_loses_what_section_5_says():
    """2 kappa asin(theta_m / q_w) to leading order, of the race."""
    disk = BODIES["uniform"]
    window = 1e-3
    got = ex.passages(disk, 1.0, [1e-5, -1e-5], 1.0, window=window, accuracy=1e-10)
    lost = disk.race_limit - abs(got.race_angle)
    np.testing.assert_allclose(lost, 2 * disk.kappa * np.arcsin(got.theta_min / window), rtol=5e-3)


def test_a_window_however_narrow_is_crossed_with_the_speed_of_impact():
    """A disk that comes 1e-200 near flat falls the last of its way like a free particle: 2 w/A, but for O(w^2)."""
    disk = BODIES["uniform"]
    for window in 10.0 ** -np.arange(1.0, 151.0):
        got = ex.passages(disk, 1.0, 1e-200, 1.0, window=float(window), accuracy=1e-9)
        assert got.status == ex.Status.OK
        share = got.duration * got.impact_speed / (2.0 * window)
        assert abs(share - 1.0) <= window + 3.0 * got.error_estimate
        assert got.race_angle == pytest.approx(disk.race_limit, abs=1e-9)


def test_the_widest_window_is_the_vertical():
    disk = BODIES["uniform"]
    start = 1.0, [1e-3, -0.1], 1.0
    np.testing.assert_array_equal(
        ex.passages(disk, *start, window=1.0).delta_chi, ex.passages(disk, *start).delta_chi
    )


def test_jobs_do_not_change_a_bit():
    rng = np.random.default_rng(1)
    arguments = (BODIES["hoop"], rng.uniform(-2, 2, 999), 10 ** rng.uniform(-200, -1, 999), 1.0)
    one, two = (ex.passages(*arguments, jobs=jobs) for jobs in (1, 2))
    np.testing.assert_array_equal(one.delta_chi, two.delta_chi)


@pytest.mark.parametrize("arguments", [(1.0, 50.0, 0.0), (0.1, 0.5, 0.0), (1e7, 1e5, 1.0)])
def test_what_is_no_passage_is_not_reported_as_one(arguments):
    """From rest where the potential rises towards flat the disk goes the other way."""
    got = ex.passages(BODIES["uniform"], *arguments)
    assert got.status != ex.Status.OK or got.error_estimate <= 1e-6
    assert got.status == ex.Status.OK or np.isnan(got.delta_chi)


def test_an_accuracy_that_rounding_does_not_allow_is_not_claimed():
    got = ex.passages(BODIES["uniform"], [1e-160, 1e7], [1e-170, 1e-3], [1e-160, 1.0])
    ok = got.status == ex.Status.OK
    assert (got.error_estimate[ok] <= 1e-6).all()


def test_an_upright_roll_has_the_period_of_its_wobble_where_it_is_stable_and_none_elsewhere():
    """Rolling straight: I1 (I1 + m r^2) omega^2 = I3 (I3 + m r^2) sigma4^2 - I1 m g r for small tilts."""
    still = ex.periods(phi_to_states(BODIES["uniform"], 0.0, 0.0, 0.0, [1.0, 0.3]))
    assert still.status[0] == ex.Status.OK
    assert still.period[0] == pytest.approx(2.0 * np.pi / np.sqrt((0.5 * 1.5 - 0.25) / (0.25 * 1.25)), rel=1e-12)
    assert still.status[1] != ex.Status.OK


def test_falls_carry_an_error_estimate():
    disk = BODIES["uniform"]
    got = ex.passages(disk, 1.0, 0.0, [1.0, 1e-3], accuracy=1e-9)
    assert (got.status == ex.Status.FALLS).all()
    assert (got.error_estimate < 1e-9).all()
    quick = ex.limit_motion(constants_to_states(disk, 1.0, 0.0, 1.0))
    assert got.fall_time[0] == pytest.approx(quick.impacts(quick.period)[0], abs=1e-10)


def test_a_fall_from_rest_is_not_given_and_one_from_a_hair_beside_is_known():
    """From (sigma3_bar, phidot) = (0, 0) it never leaves; a hair beside, its time is an elliptic integral."""
    disk, phidot = BODIES["uniform"], 1e-12
    got = ex.passages(disk, [0.0, 0.0], 0.0, [0.0, phidot], accuracy=1e-12)
    assert (got.status == [ex.Status.STEP_LIMIT, ex.Status.FALLS]).all()
    assert np.isnan(got.fall_time[0])
    kinetic = 0.5 * disk.body.M * phidot**2
    exact = np.sqrt(2.0 * disk.body.M / kinetic) * ellipkinc(0.25 * np.pi, -2.0 / kinetic)
    assert got.fall_time[1] == pytest.approx(exact, rel=1e-12)


def test_a_passage_that_turns_before_flat_is_refused_by_all_methods():
    """It never reaches the flat state that it was sent to."""
    for method in ("quadrature", "rk4", "dop853"):
        got = ex.passages(BODIES["uniform"], 0.2, 0.45, 0.0, method=method)
        assert got.status == ex.Status.BAD_INPUT
        assert not got.wrong_way


@pytest.mark.parametrize("method", ["quadrature", "dop853"])
def test_a_passage_with_too_little_energy_to_fall_has_no_race_and_is_else_as_any_other(method):
    """Of bodies whose I3 is far less than 2 I1 one in twelve is such: the bounce of the motion, without a race."""
    for disk in (ex.Disk(I1=0.5, I3=0.02), ex.Disk(I1=1.5e-5, I3=1e-6)):
        random = np.random.default_rng(4)
        eta_hat = 10.0 ** random.uniform(-3.0, 0.5, 100) * random.choice([-1.0, 1.0], 100)
        start = random.normal(0.0, 2.0, 100), eta_hat, random.uniform(0.01, 1.0, 100)
        got = ex.passages(disk, *start, method=method, accuracy=1e-5)
        bounces = ex.bounces(ex.constants_to_states(disk, *start), accuracy=1e-9)
        without = got.ok & ~(got.energy > disk.energy_at_flat(start[0]))
        assert without.sum() >= 3
        np.testing.assert_array_equal(np.isfinite(got.race_angle), got.ok & ~without)
        for name in ("fall_angle", "limit", "impact_speed"):
            assert np.isnan(getattr(got, name)[without]).all()
        off = abs(got.delta_chi - bounces.delta_chi.ravel())[without]
        assert (off <= 3.0 * (got.error_estimate + bounces.error_estimate.ravel())[without]).all()


def test_a_motion_on_a_line_that_cannot_fall_passes_like_its_neighbours():
    """With eta_hat = 0 only more energy than V_0 leads to flat."""
    disk = ex.Disk(I1=0.5, I3=0.02)
    got = ex.passages(disk, [6.0, 6.0, 1.0], [0.0, 1e-12, 0.0], [1e-3, 1e-3, 1.0])
    energy = got.energy / disk.energy_at_flat(got.sigma3_bar)
    assert (energy[:2] < 1.0).all() == (got.status[0] == ex.Status.OK)
    assert got.status[2] == ex.Status.FALLS


@pytest.mark.parametrize(
    ("call", "named"),
    [
        (lambda disk: ex.passages("uniform", 1.0, 1e-3, 1.0), "disk = 'uniform'"),
        (lambda disk: ex.passages(disk, "x", 1e-3, 1.0), "sigma3_bar = 'x'"),
        (lambda disk: ex.passages(disk, [1.0, 2.0], [1e-3] * 3, 1.0), "shapes"),
        (lambda disk: ex.passages(disk, 1.0, 1e-3, 1.0, jobs="two"), "jobs = two"),
        (lambda disk: ex.passages(disk, 1.0, 1e-3, 1.0, window="x"), "window = x"),
        (lambda disk: ex.simulate(ex.phi_to_states(disk, 0, 1, 1, 0.7), t_end="x"), "t_end = x"),
        (lambda disk: ex.limit_motion(constants_to_states(disk, 1, 0, 1))("x"), "t = 'x'"),
        (lambda disk: ex.limit_motion(constants_to_states(disk, 1, 0, 1)).impacts(np.inf), "t_end = inf"),
    ],
)
def test_wrong_arguments_are_named(call, named):
    with pytest.raises(ex.InputError, match=named.replace("[", r"\[")):
        call(BODIES["uniform"])


def test_tables_and_adaptive_rules_give_the_same_passages():
    rng = np.random.default_rng(4)
    eta_hat = rng.choice([-1.0, 1.0], 40) * 10.0 ** rng.uniform(-8, 0, 40)
    columns = rng.uniform(-2, 2, 40), eta_hat, rng.uniform(0.5, 2, 40), np.ones(40)
    start = starts_at_vertical(BODIES["hoop"], *columns)
    rules = reference_passages(BODIES["hoop"], start)
    tables, _ = passages_by(BODIES["hoop"], start, plan(("race_angle",), 1e-11, "quadrature"))
    assert rules.ok.all()
    assert tables.ok.all()
    for name in ("race_angle", "delta_psi", "duration", "theta_min"):
        assert getattr(tables, name) == pytest.approx(getattr(rules, name), rel=1e-11, abs=1e-11)


@pytest.fixture(scope="module")
def beside_truth(body):
    return Passages(body, 500, 5)


@pytest.mark.parametrize("method", ["quadrature", *INTEGRATORS])
def test_the_accuracy_asked_is_the_accuracy_paid_for(beside_truth, method):
    """The 99th percentile of the error is within it, of integrators not below a hundredth; all are answered."""
    assert_paid_for(beside_truth, method)


@pytest.mark.parametrize("accuracy", [1e-9, 1e-6, 1e-3])
@pytest.mark.parametrize("body", ["uniform", "thick"])
def test_slow_starts_that_are_answered_to_all_digits_are_answered_to_fewer(body, accuracy):
    """Their falls take long, and it is the share of the time that counts."""
    random = np.random.default_rng(3)
    speed = 10.0 ** random.uniform(-9.0, -1.0, 400)
    start = speed * random.uniform(-1.0, 1.0, 400), speed * random.uniform(-1.0, 1.0, 400), speed
    fine, found = (ex.passages(BODIES[body], *start, accuracy=each) for each in (1e-11, accuracy))
    assert fine.ok.sum() > 300
    assert found.ok[fine.ok].all()
    off = abs(found.race_angle - fine.race_angle)[fine.ok]
    assert (off <= 3.0 * (found.error_estimate + fine.error_estimate)[fine.ok]).all()
