"""The exact layer against arithmetic in 30 and 40 digits, against integration, and at the extremes."""

import json
import math

import numpy as np
import pytest
from conftest import BODIES
from reference.report_extremes import measure, rows

import explorer as ex
from explorer.commands.passage import passage_report
from explorer.phase.gauss import gauss
from explorer.phase.states import constants_to_states, phi_to_states

EXTREMES = list(rows())


def test_gauss_rules_integrate_polynomials_of_their_degree_to_the_last_digit():
    for n in (12, 64, 280):
        x, w = gauss(n)
        for degree in (0, 2, n, 2 * n - 2):
            degree -= degree % 2
            assert (w * x**degree).sum() == pytest.approx(2 / (degree + 1), rel=4e-15)


@pytest.mark.parametrize("accuracy", [1e-3, 1e-6, 1e-9, 1e-12])
def test_passages_agree_with_forty_digits_and_their_error_estimates_are_honest(reference_passages, accuracy):
    for row in reference_passages:
        disk = ex.Disk(*(row[key] for key in ("m", "r", "g", "I1", "I3")))
        got = ex.passages(disk, row["sigma3_bar"], row["eta_hat"], row["phidot"], accuracy=accuracy)
        assert got.status[0] == ex.Status.OK
        angle = max(abs(got.delta_chi[0] - row["delta_chi"]), abs(got.delta_psi[0] - row["delta_psi"]))
        scale = max(abs(got.duration[0] / row["duration"] - 1), abs(got.theta_min[0] / row["theta_min"] - 1))
        assert angle <= max(accuracy, 1e-11)
        assert scale <= max(accuracy, 1e-12)
        assert max(angle, scale) <= 10 * got.error_estimate[0] + 1e-13
        assert got.energy[0] == pytest.approx(row["energy"], rel=1e-14)


@pytest.mark.parametrize(("name", "row", "units"), EXTREMES, ids=[name for name, _, _ in EXTREMES])
def test_the_extremes_agree_with_34_digits(name, row, units):
    """Errors within ten times the estimate and within the accuracy met; otherwise no number at all."""
    accuracy, status, angle, relative, estimate = measure(row, units)
    if status == ex.Status.OK:
        assert max(angle, relative) <= 10 * estimate + 1e-13
        assert angle <= 10 * accuracy * max(1.0, abs(float(row["delta_chi"])))
        assert relative <= 10 * accuracy
    else:
        assert status == ex.Status.STEP_LIMIT
        assert np.isnan(angle)


def test_all_extremes_but_those_next_to_a_separatrix_are_resolved():
    met = {name: measure(row, units)[:2] for name, row, units in EXTREMES}
    unresolved = {name for name, (_, status) in met.items() if status != ex.Status.OK}
    assert all("separatrix" in name or "equilibrium" in name for name in unresolved)
    ordinary = [name for name in met if "separatrix" not in name and "equilibrium" not in name]
    # Bodies whose inertia is next to nothing about one axis: terms of the energy cancel.
    hard = {"m r^2/I1 = 1e+06, flat", "I3/I1 = 0.001", "I3/I1 = 1e-06"}
    assert {name for name in ordinary if met[name][0] > 1e-11} <= hard


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


def test_quadrature_and_both_integrators_agree_within_their_stated_errors():
    rng = np.random.default_rng(12)
    n = 20_000
    arguments = (
        rng.uniform(-2, 2, n),
        10 ** rng.uniform(-4, -1, n) * rng.choice([-1, 1], n),
        rng.uniform(0.05, 3, n),
        rng.choice([-1, 1], n),
    )
    exact = ex.passages(BODIES["uniform"], *arguments, accuracy=1e-9)
    for method in ("dopri5", "rk4", "dop853", "rk8"):
        other = ex.passages(BODIES["uniform"], *arguments, method=method)
        allowed = exact.error_estimate + other.error_estimate
        assert (exact.status == 0).all()
        assert (other.status == 0).all()
        for name in ("delta_chi", "delta_psi"):
            assert (abs(getattr(exact, name) - getattr(other, name)) <= allowed).all()
        for name in ("duration", "theta_min"):
            assert (abs(getattr(exact, name) / getattr(other, name) - 1) <= allowed).all()


@pytest.mark.parametrize(
    ("method", "accuracy"),
    [
        ("quadrature", 1e-3),
        ("quadrature", 1e-9),
        ("dopri5", 1e-1),
        ("dopri5", 1e-6),
        ("dop853", 1e-1),
        ("dop853", 1e-8),
        ("rk4", 1e-1),
        ("rk4", 1e-4),
        ("rk8", 1e-1),
        ("rk8", 1e-8),
    ],
)
@pytest.mark.parametrize("name", ["uniform", "heavy-core", "thick"])
def test_no_race_goes_silently_the_wrong_way_from_1e_minus_1_to_1e_minus_300(name, method, accuracy):
    rng = np.random.default_rng(13)
    n = 30_000
    got = ex.passages(
        BODIES[name],
        rng.uniform(-2, 2, n),
        10 ** rng.uniform(-300, -1, n) * rng.choice([-1, 1], n),
        rng.uniform(0, 3, n),
        rng.choice([-1, 1], n),
        method=method,
        accuracy=accuracy,
    )
    assert not got.wrong_way.any()
    codes = set(np.unique(got.status).tolist())
    if method == "quadrature":
        # A start almost at rest loses digits to rounding; at 1e-9 a few say so.
        assert codes <= {int(ex.Status.OK), int(ex.Status.STEP_LIMIT)}
        assert (got.status == ex.Status.OK).mean() > 0.999
    else:
        # Between what rounding of the state lets pass and what it hides, theta_min misses the accuracy.
        assert codes <= {int(ex.Status.OK), int(ex.Status.UNRESOLVED_SIDE), int(ex.Status.STEP_LIMIT)}
        assert (got.status == ex.Status.STEP_LIMIT).mean() < 0.03
        assert (got.status == ex.Status.UNRESOLVED_SIDE).mean() > 0.9


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


def test_the_fall_itself_is_reported_with_both_continuations():
    report = passage_report("hoop", 0.0, 0.0, 1.0)
    assert report["status"] == "falls"
    assert report["fall_time"] == pytest.approx(1.325324, abs=5e-7)
    assert report["duration"] is None
    assert (
        report["limits"]["plus"]["race_angle"]
        == -report["limits"]["minus"]["race_angle"]
        == BODIES["hoop"].race_limit
    )
    assert json.loads(json.dumps(report)) == report


def test_a_passage_says_when_a_real_disk_would_lift_off():
    """Section 8: the normal force of the paper's own scenes falls to -0.97 m g (uniform), -0.89 (hoop)."""
    for name, least in (("uniform", -0.97), ("hoop", -0.89)):
        report = passage_report(name, 1.0, 0.01, 1.0)
        assert report["min_normal_force"] == pytest.approx(least, abs=0.01)
        assert "lift off" in report["warnings"][0]
    calm = ex.passage_forces(BODIES["uniform"], 0.05, 0.3, 0.2)
    assert np.isfinite(calm.min_normal_force[0])


def test_bad_input_is_flagged_sample_by_sample():
    got = ex.passages(
        BODIES["uniform"],
        [1.0, np.nan, 1.0, 1.0, 1.0],
        [1e-3] * 5,
        [1.0, 1.0, -1.0, np.inf, 1.0],
        face=[1, 1, 1, 1, 2],
    )
    assert got.status.tolist() == [0, 2, 2, 2, 2]
    alone = ex.passages(BODIES["uniform"], 1.0, 1e-3, 1.0)
    assert got.delta_chi[0] == alone.delta_chi[0]
    assert np.isnan(got.delta_chi[1:]).all()


def test_jobs_do_not_change_a_bit():
    rng = np.random.default_rng(1)
    arguments = (BODIES["hoop"], rng.uniform(-2, 2, 999), 10 ** rng.uniform(-200, -1, 999), 1.0)
    one, two = (ex.passages(*arguments, jobs=jobs) for jobs in (1, 2))
    np.testing.assert_array_equal(one.delta_chi, two.delta_chi)


ROWS = {  # mathematics, section 10
    ("uniform", 0.01): (3.5309125568, 10.16442885, 4.88619430),
    ("uniform", -0.01): (3.5069444328, -3.87572184, -9.14592890),
    ("hoop", 0.01): (3.5443368831, 8.57037740, 3.49347084),
    ("hoop", -0.01): (3.5168724512, -2.31358306, -7.37252693),
}


@pytest.mark.parametrize("key", ROWS, ids=str)
def test_whole_periods_of_the_figures(key):
    name, eta_hat = key
    got = ex.periods(constants_to_states(BODIES[name], 1.0, eta_hat, 1.0), 1e-11)
    assert (got.period[0], got.chi[0], got.psi[0]) == pytest.approx(ROWS[key], abs=1e-8)
    assert got.crosses[0]


def test_periods_without_crossing_the_vertical_bring_the_motion_back():
    rng = np.random.default_rng(15)
    disk = BODIES["hoop"]
    n = 60
    states = np.column_stack([rng.uniform(0.3, 1.4, n) * rng.choice([-1, 1], n), rng.uniform(-0.2, 0.2, (n, 3))])
    got = ex.periods(phi_to_states(disk, *states.T), 1e-9)
    inside = (got.status == 0) & ~got.crosses & (got.theta_min > 1e-3)
    assert inside.sum() > 20
    for i in np.flatnonzero(inside)[:12]:
        after = ex.simulate(
            disk, states[i], t_eval=[got.period[i]], observables=("phi", "phidot", "chi", "psi"), accuracy=1e-10
        )
        assert after.phi[0, 0] == pytest.approx(states[i, 0], abs=1e-8)
        assert after.phidot[0, 0] == pytest.approx(states[i, 1], abs=1e-7)
        assert after.chi[0, 0] == pytest.approx(got.chi[i], abs=1e-8)
        assert after.psi[0, 0] == pytest.approx(got.psi[i], abs=1e-8)


def test_slow_rocking_near_flat_turns_by_the_eulers_disk_angle():
    """Bottom of the near-flat well: 2 pi sqrt(M / (3 I1)) per bounce (section 5)."""
    for name, turn in (("uniform", 2.58177), ("hoop", 1.99983)):
        disk = BODIES[name]
        b = disk.body
        eta = 1e-9
        theta0 = eta ** (2 / 3) / b.I1 ** (1 / 3)
        excess = math.sqrt(2 * (1.001 - 1) * 1.5 * theta0 / b.M)
        eta_hat = eta / (b.I3 * b.r0)
        states = ex.theta_to_states(disk, theta0, excess, eta / b.I1, 0.0)
        got = ex.periods(states, 1e-6, eta_hat=eta_hat)
        assert got.status[0] == ex.Status.OK
        assert got.chi[0] / np.pi == pytest.approx(turn, abs=2e-3)


def test_trajectories_go_the_right_way_round_bounce_after_bounce_at_any_eta():
    disk = BODIES["uniform"]
    states = constants_to_states(disk, 1.0, [1e-12, -1e-12, 1e-30, -1e-60, 1e-120], 1.0)
    limits = {s: ex.limit_motion(disk, constants_to_states(disk, 1.0, 0.0, 1.0), s) for s in (1, -1)}
    times = np.arange(1, 9) * limits[1].period + 0.2
    got = ex.simulate(disk, states, t_eval=times, observables=("phi", "chi", "psi", "path"), accuracy=1e-8)
    assert (got.status == 0).all()
    for row, sign in enumerate((1, -1, 1, -1, 1)):
        want = limits[sign](times)
        for name in ("phi", "chi", "psi", "path"):
            np.testing.assert_allclose(getattr(got, name)[row], getattr(want, name), atol=2e-6)


@pytest.mark.parametrize(
    ("method", "accuracy"), [("dopri5", 1e-6), ("dop853", 1e-6), ("rk4", 1e-4), ("rk8", 1e-6)]
)
def test_errors_grow_like_the_number_of_passages_not_its_square(method, accuracy):
    """Against whole periods by quadrature: 1000 of them, and a hundredth."""
    disk = BODIES["uniform"]
    states = constants_to_states(disk, 1.0, -1e-6, 1.0)
    one = ex.periods(states, 1e-11)
    errors = []
    for periods in (10, 1000):
        got = ex.simulate(
            disk,
            states,
            t_eval=periods * one.period,
            observables=("chi",),
            method=method,
            accuracy=accuracy,
        )
        errors.append(abs(got.chi[0, 0] - periods * one.chi[0]))
        assert errors[-1] < 10 * periods * accuracy
    assert errors[1] < 200 * errors[0]


def test_ten_thousand_passages_in_a_row_keep_their_constants():
    """Change of energy grows with the number of passages and is reported; sigma3_bar and eta cannot drift."""
    disk = BODIES["hoop"]
    states = constants_to_states(disk, 1.0, [1e-6, -1e-6], 1.0)
    one = ex.periods(states, 1e-11)
    times = np.array([100.0, 10_000.0]) * one.period.mean()
    constants_error = []
    for t in times:
        got = ex.simulate(disk, states, t_eval=[t], observables=("phi", "chi"), accuracy=1e-7, max_steps=10**7)
        constants_error.append(abs(got.constants_error))
        assert got.status[0] in (ex.Status.OK, ex.Status.INVARIANT_DRIFT)
    short, long = constants_error
    assert (short[0] < 1e-6).all()
    assert (long[0] < 200 * short[0]).all()
    assert (long[2] < 1e-12).all()


def test_the_pendulum_falls_to_both_sides_in_turn():
    disk = BODIES["uniform"]
    for sign in (1, -1):
        for face in (1, -1):
            limit = ex.limit_motion(disk, (0.0, float(face), 0.0, 0.0), sign)
            hits = limit.impacts(10.0)
            assert hits[0] == pytest.approx(1.293920, abs=5e-7)
            times = np.linspace(0.05, 9.0, 80)
            times = times[abs(times[:, None] - hits).min(axis=1) > 0.1]
            states = constants_to_states(disk, 0.0, face * sign * 1e-10, float(face), face)
            names = ("phi", "phidot", "chi", "psi", "path", "contact")
            got, want = ex.simulate(disk, states, t_eval=times, observables=names, accuracy=1e-10), limit(times)
            for name in names:
                np.testing.assert_allclose(getattr(got, name)[0], getattr(want, name), atol=1e-7)


@pytest.mark.parametrize("arguments", [(1.0, 50.0, 0.0), (0.1, 0.5, 0.0), (1e7, 1e5, 1.0)])
def test_what_is_no_passage_is_not_reported_as_one(arguments):
    """From rest where the potential rises towards flat the disk goes the other way."""
    got = ex.passages(BODIES["uniform"], *arguments)
    assert got.status[0] != ex.Status.OK or got.error_estimate[0] <= 1e-6
    assert got.status[0] == ex.Status.OK or np.isnan(got.delta_chi[0])


def test_an_accuracy_that_rounding_does_not_allow_is_not_claimed():
    got = ex.passages(BODIES["uniform"], [1e-160, 1e7], [1e-170, 1e-3], [1e-160, 1.0])
    ok = got.status == ex.Status.OK
    assert (got.error_estimate[ok] <= 1e-6).all()
    still = ex.periods(phi_to_states(BODIES["uniform"], 0.0, 0.0, 0.0, 1.0))
    assert still.status[0] != ex.Status.OK
