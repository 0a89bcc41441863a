"""Passages from awkward starts: at rest, far from F, beside rounding, and input that is none."""

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.phase.states import constants_to_states, phi_to_states

METHODS = [
    ("dopri5", 1e-1),
    ("dopri5", 1e-6),
    ("dop853", 1e-1),
    ("dop853", 1e-3),
    ("dop853", 1e-6),
    ("rk4", 1e-1),
    ("rk4", 1e-6),
    ("rk8", 1e-6),
]


@pytest.mark.parametrize(("method", "accuracy"), METHODS)
@pytest.mark.parametrize("name", ["uniform", "hoop"])
def test_estimates_hold_for_any_start_at_the_vertical(name, method, accuracy):
    """Also where |eta_hat| is near 1 and no race is left, and where the start is almost at rest."""
    rng = np.random.default_rng(77)
    n = 10_000
    start = (
        rng.uniform(-2, 2, n),
        10 ** rng.uniform(-4, 0, n) * rng.choice([-1, 1], n),
        rng.uniform(0, 3, n) * rng.choice([0, 1], n, p=[0.05, 0.95]),
    )
    exact = ex.passages(BODIES[name], *start, accuracy=1e-9)
    other = ex.passages(BODIES[name], *start, method=method, accuracy=accuracy)
    ok = (exact.status == 0) & (other.status == 0)
    assert ok.mean() > 0.93
    apart = np.fmax(abs(exact.delta_chi - other.delta_chi), abs(exact.delta_psi - other.delta_psi))
    apart = np.fmax(apart, abs(exact.duration / other.duration - 1))
    apart = np.fmax(apart, abs(exact.theta_min / other.theta_min - 1))
    assert (apart[ok] <= (exact.error_estimate + other.error_estimate)[ok]).all()
    assert np.isfinite(other.error_estimate[ok]).all()
    assert not other.wrong_way.any()


@pytest.mark.parametrize("sigma3_bar", [5.0, 20.0])
def test_a_start_that_is_almost_at_rest_says_how_little_it_knows(sigma3_bar):
    """Two orders of rules and the integrator, each with its own rounding, within both estimates."""
    disk = BODIES["uniform"]
    loose = ex.passages(disk, sigma3_bar, 1e-8, 5e-4, accuracy=1e-2)
    tight = ex.passages(disk, sigma3_bar, 1e-8, 5e-4, accuracy=1e-8)
    assert tight.status[0] == loose.status[0] == ex.Status.OK
    assert abs(loose.delta_chi - tight.delta_chi) <= loose.error_estimate + tight.error_estimate
    assert tight.error_estimate > 1e-11


def test_falls_carry_an_error_estimate():
    disk = BODIES["uniform"]
    got = ex.passages(disk, 1.0, 0.0, [1.0, 1e-3])
    assert (got.status == ex.Status.FALLS).all()
    assert (got.error_estimate < 1e-9).all()
    quick = ex.limit_motion(disk, constants_to_states(disk, 1.0, 0.0, 1.0))
    assert got.fall_time[0] == pytest.approx(quick.impacts(quick.period)[0], abs=1e-10)


def test_a_fall_from_rest_whose_time_is_lost_in_rounding_is_not_given():
    """From (sigma3_bar, phidot) = (0, 0) it never leaves; a hair beside, rounding decides when."""
    got = ex.passages(BODIES["uniform"], [0.0, 0.0], 0.0, [0.0, 1e-12])
    assert (got.status == ex.Status.STEP_LIMIT).all()
    assert np.isnan(got.fall_time).all()


@pytest.mark.parametrize("state", [(0.0, 0.0, 1e-4, 0.7285923160189477e-4), (1.5707963267948, 0.0, 0.0, 0.0)])
@pytest.mark.filterwarnings("error")
def test_limit_motions_that_rounding_decides_are_refused(state):
    with pytest.raises(ex.InputError, match="rest"):
        ex.limit_motion(BODIES["uniform"], state)


def test_a_passage_that_turns_before_flat_is_refused_by_all_methods():
    """It never reaches the flat state that it was sent to."""
    for method in ("quadrature", "rk4", "dop853"):
        got = ex.passages(BODIES["uniform"], 0.2, 0.45, 0.0, method=method)
        assert got.status[0] == ex.Status.BAD_INPUT
        assert not got.wrong_way[0]


@pytest.mark.filterwarnings("error")
def test_input_beyond_all_scales_is_bad_input_and_a_vanishing_eta_has_no_side():
    disk = BODIES["uniform"]
    for method in ("quadrature", "dop853"):
        got = ex.passages(disk, [1e308, 1.0, np.nan, 1.0], 1e-3, [1.0, 1e200, 1.0, np.inf], method=method)
        assert (got.status == ex.Status.BAD_INPUT).all()
    got = ex.passages(disk, 1.0, [1e-300, 5e-324], 1.0)
    assert got.status.tolist() == [ex.Status.OK, ex.Status.UNRESOLVED_SIDE]
    forces = ex.passage_forces(disk, 1.0, [1e-3, 1e-3, 5e-324], [1.0, -1.0, 1.0])
    assert np.isnan(forces.max_friction).tolist() == [False, True, True]


def test_periods_on_f_fall_and_beside_it_need_the_eta_they_were_given():
    disk = BODIES["uniform"]
    on_f = ex.periods(constants_to_states(disk, 1.0, 0.0, 1.0))
    assert on_f.status[0] == ex.Status.FALLS
    found = ex.periods(constants_to_states(disk, 1.0, [1e-200, -1e-200], 1.0))
    assert (found.status == ex.Status.OK).all()
    assert found.chi[0] - found.chi[1] == pytest.approx(2 * disk.race_limit, abs=1e-9)
    rows = phi_to_states(disk, 0.0, 1.0, 1.0, 0.7285923160189477)
    assert ex.periods(rows).status[0] in (ex.Status.FALLS, ex.Status.UNRESOLVED_SIDE)


@pytest.mark.parametrize(
    ("call", "named"),
    [
        (lambda disk: ex.passages("uniform", 1.0, 1e-3, 1.0), "disk = 'uniform'"),
        (lambda disk: ex.passages(disk, "x", 1e-3, 1.0), "sigma3_bar = 'x'"),
        (lambda disk: ex.passages(disk, [1.0, 2.0], [1e-3] * 3, 1.0), "shapes"),
        (lambda disk: ex.passages(disk, 1.0, 1e-3, 1.0, jobs="two"), "jobs = 'two'"),
        (lambda disk: ex.passages(disk, 1.0, 1e-3, 1.0, window="x"), "window = 'x'"),
        (lambda disk: ex.simulate(disk, (0, 1, 1, 0.7), t_end="x"), "t_end = 'x'"),
        (lambda disk: ex.limit_motion(disk, constants_to_states(disk, 1, 0, 1))("x"), "t = 'x'"),
        (lambda disk: ex.limit_motion(disk, constants_to_states(disk, 1, 0, 1)).impacts(np.inf), "t_end = inf"),
    ],
)
def test_wrong_arguments_are_named(call, named):
    with pytest.raises(ex.InputError, match=named.replace("[", r"\[")):
        call(BODIES["uniform"])
