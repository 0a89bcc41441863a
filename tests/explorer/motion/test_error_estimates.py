"""Motions in time meet their accuracy whatever the body, in angles and in the path, and tell how far they err."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import BODIES
from motions import trajectories
from scipy.integrate import solve_ivp

import explorer as ex
from explorer import compiled
from explorer.motion.plan import plan
from explorer.motion.trajectories import trajectories_by

NAMES = ("phi", "chi", "psi", "path")
TIMES = np.array([0.6, 1.2, 1.8, 2.4, 5.0])
# Little I3, and very small and very large I1: far from any body that steps were calibrated on.
FAR = {"little-I3": ex.Disk(I1=0.25, I3=0.02), "core": ex.Disk(I1=1e-3, I3=2e-3), "ring": ex.Disk(I1=1e3, I3=2e3)}
METHODS = ("rk4", "rk8", "dopri5", "dop853")


def start(disk, slow=False):
    """Motions at all distances from F; slow: half of them hardly leave the vertical."""
    rng = np.random.default_rng(3)
    eta_hat = rng.choice([-1.0, 1.0], 40) * 10.0 ** rng.uniform(-8.0, 0.0, 40)
    phidot = rng.uniform(0.5, 2.0, 40)
    if slow:
        phidot[::2] = 10.0 ** rng.uniform(-5.0, -0.5, 20)
    return ex.constants_to_states(disk, rng.uniform(-2.0, 2.0, 40), eta_hat, phidot)


@pytest.fixture(scope="module")
def exact():
    """By far finer steps, each asked for once."""
    known = {}

    def followed(name, slow=False):
        if (name, slow) not in known:
            how = replace(plan(NAMES, 1e-11, "rk8"), accuracy=1.0, setting=0.03)
            known[name, slow] = trajectories_by(start(FAR[name], slow), how, TIMES, NAMES)
        return known[name, slow]

    return followed


def errors(got, true):
    """(of angles, of the path) (n, nt) outside of races, else 0."""
    away = np.maximum(abs(got.phi), abs(true.phi)) < 0.5 * np.pi - 0.1
    angles = np.max([abs(getattr(got, name) - getattr(true, name)) for name in NAMES[:3]], axis=0)
    path = np.linalg.norm(got.path - true.path, axis=-1)
    return np.where(away, angles, 0.0), np.where(away, path, 0.0)


@pytest.mark.parametrize("accuracy", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", FAR)
def test_the_accuracy_asked_is_met_far_from_the_bodies_it_was_calibrated_on(exact, name, method, accuracy):
    if method == "rk4" and accuracy < 1e-6:
        pytest.skip("thousands of steps of order four per passage; order eight is there for that")
    got = trajectories(start(FAR[name]), t_eval=TIMES, observables=NAMES, method=method, accuracy=accuracy)
    assert got.ok.all()
    passages = np.maximum(1.0, 0.5 * TIMES)
    angles, path = (np.percentile((error / passages).max(axis=1), 99) for error in errors(got, exact(name)))
    assert 0.01 * accuracy < max(angles, path) < accuracy


@pytest.mark.parametrize("method", METHODS[1:])
@pytest.mark.parametrize("name", FAR)
def test_estimates_cover_errors_of_slow_and_quick_motions_and_say_something(exact, name, method):
    states, covered = start(FAR[name], slow=True), []
    for accuracy in (1e-3, 1e-5, 1e-8):
        got = trajectories(states, t_eval=TIMES, observables=NAMES, method=method, accuracy=accuracy)
        assert got.ok.all()
        error = np.maximum(*errors(got, exact(name, slow=True))).max(axis=1)
        covered.append(got.error_estimate / error)
    assert np.min(covered) >= 0.1
    # The path of fixed steps may lose chi where this turns many times in a step; few do, and all are told so.
    assert method == "rk8" or np.median(np.array(covered)[:, 1::2]) < 50.0


@pytest.mark.parametrize("method", METHODS[1:])
def test_paths_of_thousands_of_radii_meet_their_accuracy_or_are_refused(method):
    disk, rng = ex.Disk(I1=0.25, I3=1e-4), np.random.default_rng(4)
    eta_hat = rng.choice([-1.0, 1.0], 30) * 10.0 ** rng.uniform(-8.0, 0.0, 30)
    states = ex.constants_to_states(disk, rng.uniform(-1.5, 1.5, 30), eta_hat, rng.uniform(0.3, 2.0, 30))
    other = "dop853" if method == "rk8" else "rk8"
    how = replace(plan(NAMES, 1e-9, other), accuracy=1.0, setting=3e-14 if other == "dop853" else 0.06)
    true = trajectories_by(states, how, np.array([1.0]), NAMES)
    got = {
        a: trajectories(states, None, [1.0], observables=NAMES, method=method, accuracy=a)
        for a in (1e-6, 1e-8, 1e-10)
    }
    assert all(got[accuracy].ok.all() for accuracy in (1e-6, 1e-8))
    assert abs(true.psi).max() > 2e3
    for accuracy in (1e-6, 1e-8):
        angles, path = errors(got[accuracy], true)
        assert max(angles.max(), path.max()) < accuracy
        assert np.all(got[accuracy].error_estimate >= 0.2 * np.maximum(angles, path)[:, 0])
    # Rounding alone moves these paths by some 1e-10 to 1e-9, whatever is asked; angles and short paths stand.
    refused = got[1e-10].status == ex.Status.STEP_TOO_SMALL
    long = abs(states.natural[4]) > 2e3
    assert refused[long].all()
    assert not refused[abs(states.natural[4]) < 20.0].any()
    assert (got[1e-10].ok | refused).all()
    assert np.isnan(got[1e-10].path[refused]).all()
    assert got[1e-10].error_estimate[refused].min() > 1e-10
    assert got[1e-10].error_estimate.max() < 1e-8
    angles_only = trajectories(states, None, [1.0], observables=NAMES[:3], method=method, accuracy=1e-10)
    # Many steps of dopri5 round a psi of thousands of radians by more than is asked; two runs show it.
    assert angles_only.ok[~long if method == "dopri5" else slice(None)].all()
    assert angles_only.ok.mean() > 0.9


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", ["uniform", "heavy-core"])
def test_estimates_know_what_an_error_of_the_time_does_inside_a_race(name, method):
    """There chi turns by 1/|eta_hat| in a unit of time: errors are many times the accuracy, and are told."""
    disk, rng, racing = BODIES[name], np.random.default_rng(6), 0
    for distance in (1e-2, 1e-4, 1e-6):
        eta_hat = rng.choice([-1.0, 1.0], 60) * distance
        passages = ex.passages(disk, 0.7, eta_hat, speed := 1.0 + 3e-1 * distance * rng.normal(size=60))
        states = ex.constants_to_states(disk, 0.7, eta_hat, speed)
        times = [0.5 * np.median(passages.duration)]
        true = trajectories(states, None, times, observables=("chi", "psi"), method="rk8", accuracy=1e-11)
        for accuracy in (1e-3, 1e-6, 1e-8):
            got = trajectories(states, None, times, observables=("chi", "psi"), method=method, accuracy=accuracy)
            error = np.maximum(abs(got.chi - true.chi), abs(got.psi - true.psi))[:, 0]
            assert (error <= 2.0 * (got.error_estimate + true.error_estimate)).all()
            racing += (error > 10.0 * accuracy).sum()
    assert racing > 100


def long_motions(kind, n=60):
    """Those that pass the vertical slowly, again and again, and wobbles of a moderate spin."""
    disk, rng = BODIES["uniform"], np.random.default_rng(12)
    if kind == "slow":
        eta_hat = 10.0 ** rng.uniform(-6.0, -1.0, n) * rng.choice([-1.0, 1.0], n)
        return ex.constants_to_states(disk, rng.uniform(-1.0, 1.0, n), eta_hat, 10.0 ** rng.uniform(-5.0, -1.0, n))
    spin = rng.uniform(1.5, 4.8, n) * rng.choice([-1.0, 1.0], n)
    return ex.phi_to_states(disk, rng.uniform(-1.4, 1.4, n), *rng.uniform(-0.5, 0.5, (2, n)), spin)


@pytest.mark.parametrize("kind", ["slow", "wobbles"])
def test_errors_of_long_motions_are_told_and_mended(kind):
    """Each slow passage of the vertical amplifies what the ones before have left; phases err over many periods."""
    states, names, time = long_motions(kind), ("phi", "chi", "psi"), 20.0
    true, other = (
        trajectories(states, None, [time], observables=names, method=m, accuracy=1e-11) for m in ("rk8", "dop853")
    )
    known = other.ok & (abs(true.chi - other.chi) + abs(true.psi - other.psi) < 1e-8)[:, 0]
    assert known.mean() > 0.9
    away = abs(true.phi[:, 0]) < 0.5 * np.pi - 0.1
    for method in METHODS:
        for accuracy in (1e-2, 1e-4, 1e-6):
            got = trajectories(states, None, [time], observables=names, method=method, accuracy=accuracy)
            error = np.maximum(abs(got.chi - true.chi), abs(got.psi - true.psi))[:, 0]
            sure = known & got.ok
            assert sure.mean() > 0.85
            assert (error <= 10.0 * got.error_estimate)[sure].all()
            assert np.percentile(error[sure & away], 99) <= 0.5 * time * accuracy


def test_finer_steps_are_taken_where_other_steps_end_elsewhere():
    state = ex.constants_to_states(BODIES["uniform"], 0.1, -0.01, 0.01)
    found = ex.simulate(state, t_eval=[20.0], method="dopri5", accuracy=1e-3, observables=("chi",))
    true = ex.simulate(state, t_eval=[20.0], accuracy=1e-10, observables=("chi",))
    assert found.chi[-1] == pytest.approx(true.chi[0], abs=1e-2)


@pytest.mark.parametrize("method", ["auto", "dop853"])
def test_motions_without_an_answer_have_no_estimate_and_those_that_stand_have_little_to_make(method):
    states = ex.constants_to_states(BODIES["hoop"], 1.0, [1e-3, 0.0, np.nan], 1.0)
    got = ex.simulate(states, t_eval=[1.0, 2.0], observables=["phi"], method=method)
    assert np.isnan(got.error_estimate).tolist() == [False, True, True]
    stands = ex.simulate(states[0], t_eval=[0.0], method=method)
    assert stands.error_estimate <= (0.0 if method == "dop853" else 1e-11)
    flat = ex.Disk(I1=0.25, I3=0.0)
    free = ex.simulate(
        ex.phi_to_states(flat, 0.3, 1.0, 0.2, 0.1), t_eval=[1.0, 2.0], observables=["phi"], method=method
    )
    assert 1e-8 < free.error_estimate < 1e-4


def test_a_fast_spin_whose_error_no_second_run_could_tell_has_no_answer():
    """The second run takes finer steps; where those come to no end, nothing tells the error."""
    states = ex.phi_to_states(ex.Disk(I1=0.25, I3=1e-9), 0.03, -1000.0, [1.57, 0.5], -0.1)
    how = {"t_eval": [1.0], "method": "dop853", "accuracy": 1e-3}
    whole = trajectories(states, **how)
    assert whole.ok.all()
    for jobs in (1, 2):
        motion = trajectories(states, **how, max_steps=int(whole.steps.min()) // 4, jobs=jobs)
        assert (motion.status == ex.Status.STEP_LIMIT).all()
        assert np.isnan(motion.phi).all()


def test_only_bodies_and_rates_beyond_the_calibrated_ones_take_more_work():
    def work(disk, method, size=1.0):
        """Steps, as a multiple of those by the setting alone."""
        states = ex.phi_to_states(disk, 0.2, size, size, size)
        how = plan(("path",), 1e-6, method)
        times = np.array([2.0])
        alone = trajectories_by(states, replace(how, setting=how.control), times, ("path",))
        return trajectories_by(states, how, times, ("path",)).steps / alone.steps

    for method in METHODS:
        assert all(work(BODIES[name], method) == 1.0 for name in ("uniform", "hoop", "matching"))
        assert work(BODIES["uniform"], method, size=100.0) > 2.0


ANGLES = ("phi", "chi", "psi")
# Bodies without axial inertia, state, end: beside the vertical, at the vertical, and from nearly flat.
FREE = [
    (
        ex.Disk(I1=0.012638700854527906, I3=0.0),
        (0.0, -0.004915138562745038, -0.0003689045137871194, -6.588930906164315e-08),
        20.0,
    ),
    (ex.Disk(I1=0.25, I3=0.0), (0.0, 0.0, -0.05315567833161117, -0.09712317676271214), 20.0),
    (
        ex.Disk(I1=0.0013545161297431048, I3=0.0),
        (1.5179847602349271e-05, -22.106204111049877, 0.6429006146386025, -63.24666813778936),
        4.0,
    ),
]


@pytest.mark.parametrize("method", ["rk8", "dopri5"])
@pytest.mark.parametrize(("disk", "state", "end"), FREE)
def test_estimates_cover_motions_that_nothing_holds_whose_errors_grow(disk, state, end, method):
    states = ex.phi_to_states(disk, *state)
    true = scipy_angles(disk, state, end)
    answered = 0
    for accuracy in (1e-3, 1e-6, 1e-9):
        got = ex.simulate(states, t_eval=[end], accuracy=accuracy, method=method, observables=ANGLES)
        error = max(abs(getattr(got, name)[0] - angle) for name, angle in zip(ANGLES, true, strict=True))
        # SciPy's own error, amplified as theirs, is 1e-8 or so.
        assert not got.ok or error <= 10.0 * got.error_estimate + 1e-7
        answered += got.ok
    assert answered >= 2


def scipy_angles(disk, state, end):
    """phi, chi and psi at a time, eqs (2.14) with I3 = 0 and (2.31), (2.22), by SciPy."""
    body = disk.natural.body

    def rates(_t, y):
        q, z = np.cos(y[0]), np.sin(y[0])
        _dq, _dz, dp, drho, ds4 = compiled.field.reduced(compiled.field.State(q, z, *y[1:4], *(0.0,) * 5), body)
        turn = y[2] / q
        return [-y[1], dp / q, drho / q, ds4 / q, turn, z * turn - y[3]]

    rows = ex.phi_to_states(disk, *state).rows
    start = [state[0], rows.p[0], rows.rho[0], rows.sigma4[0], 0.0, 0.0]
    found = solve_ivp(rates, (0.0, end), start, method="DOP853", rtol=3e-14, atol=3e-14).y[:, -1]
    return found[0], found[4], found[5]


@pytest.mark.parametrize(("method", "accuracy"), [("dopri5", 1e-4), ("dopri5", 1e-6), ("dop853", 1e-6)])
@pytest.mark.parametrize("name", ["uniform", "hoop", "little"])
def test_estimates_cover_many_periods_of_fast_spins(name, method, accuracy):
    """True angles are whole periods, by quadrature."""
    disk, rng, n = BODIES.get(name, ex.Disk(I1=0.25, I3=0.05)), np.random.default_rng(9), 12
    phi, phidot, sigma3 = rng.uniform(0.1, 1.4, n), rng.normal(size=n), rng.normal(size=n)
    sigma4 = 30.0 * rng.normal(size=n)
    phi[0], phidot[0], sigma3[0], sigma4[0] = 0.80858, -0.021278, -0.806347, -99.416567
    states = ex.phi_to_states(disk, phi, phidot, sigma3 * np.cos(phi), sigma4)
    true, ratios = ex.periods(states, accuracy=1e-11), []
    for i in np.flatnonzero(true.ok):
        count = max(1.0, 10.0 // true.period[i])
        t = [count * true.period[i]]
        got = ex.simulate(states[int(i)], t_eval=t, accuracy=accuracy, method=method, observables=ANGLES)
        assert got.ok
        apart = abs(got.chi[0] - count * true.chi[i]), abs(got.psi[0] - count * true.psi[i])
        ratios.append(max(apart) / (got.error_estimate + count * true.error_estimate[i]))
    assert max(ratios) < 10.0
    assert len(ratios) > 9


@pytest.mark.parametrize("method", ["rk4", "rk8"])
@pytest.mark.parametrize("share", [0.003, 0.03])
def test_fixed_steps_meet_their_accuracy_in_fast_spins_of_little_inertia(method, share):
    disk, rng, n, time = ex.Disk(I1=0.25, I3=0.25 * share), np.random.default_rng(1), 100, 4.0
    spin = rng.uniform(2.0, 20.0, n) * rng.choice([-1.0, 1.0], n)
    states = ex.phi_to_states(disk, rng.uniform(-1.2, 1.2, n), *rng.uniform(-1.0, 1.0, (2, n)), spin)
    how = replace(plan(NAMES, 1e-11, "rk8"), accuracy=1.0, setting=0.03)
    true = trajectories_by(states, how, np.array([time]), NAMES)
    for accuracy in (1e-2, 1e-4) if method == "rk4" else (1e-2, 1e-4, 1e-8):
        got = trajectories(states, None, [time], observables=NAMES, method=method, accuracy=accuracy)
        assert got.ok.all()
        error = np.maximum(*errors(got, true))[:, 0]
        assert 0.01 * accuracy < np.percentile(error, 99) / (0.5 * time) < accuracy
        assert (error <= 10.0 * got.error_estimate).all()


def test_slow_spins_of_little_inertia_pay_no_more_by_order_four():
    """They met a hundredth of the accuracy, in six times the steps."""
    disk, rng, n = ex.Disk(I1=0.5, I3=0.005), np.random.default_rng(1), 100
    given = rng.uniform(-2.0, 2.0, n), 10.0 ** rng.uniform(-8.0, 0.0, n), rng.uniform(0.3, 2.0, n)
    states, time = ex.constants_to_states(disk, *given), 3.0
    true = trajectories(states, None, [time], observables=NAMES, method="rk8", accuracy=1e-10)
    got = trajectories(states, None, [time], observables=NAMES, method="rk4", accuracy=1e-3)
    far = (np.pi / 2 - abs(true.phi[:, 0]) > 0.1) & true.ok & got.ok
    error = np.maximum(*errors(got, true))[far, 0]
    assert 0.01e-3 < np.percentile(error, 99) / (0.5 * time) < 1e-3
