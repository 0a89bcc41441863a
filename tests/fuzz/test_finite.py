"""Numbers that are missing are found, and those that are missing for a reason are not."""

from dataclasses import replace

import numpy as np
import pytest

import explorer as ex
from fuzz.finite import not_finite

COIN, NEEDLE = ex.Disk.uniform(), ex.Disk(I1=0.3, I3=0.0, name="needle")
BESIDE = ex.constants_to_states(COIN, 0.7, [0.05, 1e-3, 0.0], 1.0)
LOW = ex.phi_to_states(COIN, 0.962, -0.106, -2.32, -2.53)  # E < V_0: it could not come flat
PLANE = "phi=0,phidot=1,sigma3=-2:2,sigma4=-2:2"


def within(found, field):
    """An array of a result, to plant in: its own, or that of an observable."""
    return getattr(found, field) if hasattr(found, field) else found[field]


@pytest.mark.parametrize(
    ("make", "field", "at"),
    [
        (lambda: ex.passages(COIN, 1.0, [1e-3, 0.0], 1.0), "race_angle", 0),
        (lambda: ex.passages(COIN, 1.0, [1e-3, 0.0], 1.0), "fall_time", 1),
        (lambda: ex.passages(COIN, 1.0, [1e-3, 0.0], 1.0), "impact_speed", 1),
        (lambda: ex.bounces(BESIDE, 2), "race_angle", (0, 1)),
        (lambda: ex.bounces(BESIDE), "fall_angle", (1, 0)),
        (lambda: ex.bounces(LOW), "theta_min", (0, 0)),
        (lambda: ex.periods(BESIDE), "chi", 0),
        (lambda: ex.falls(BESIDE), "theta_min_estimate", 0),
        (lambda: ex.falls(BESIDE), "distance", 2),
        (lambda: ex.constants(BESIDE), "eta_hat_plus", 2),
        (lambda: ex.constants(ex.phi_to_states(NEEDLE, 0.2, 0.0, 1.0, 0.1)), "sigma3_bar", 0),
        (lambda: ex.passage_forces(COIN, 1.0, [0.01, 2.0], 1.0), "max_friction", 0),
        (lambda: ex.passage_forces(COIN, 1.0, [0.01, 2.0], 1.0), "min_normal_force", 1),
        (lambda: ex.flow_stretch(BESIDE, steps=2), "matrix", (0, 3, 3)),
        (lambda: ex.simulate(BESIDE, t_eval=[0.0, 0.1]), "phi", (0, 1)),
        (lambda: ex.simulate(BESIDE, t_eval=[0.0, 0.1]), "constants_error", (2, 1)),
        (lambda: ex.steady_motions(COIN, 0.3, 1.0), "radius", 0),
        (lambda: ex.scan(BESIDE[:2], ["theta_min", "race_angle"]), "race_angle", 1),
        (lambda: ex.slice_map(COIN, PLANE, points=3), "theta_min", (0, 1)),
        (lambda: ex.limit_motion(BESIDE[2])([0.0, 1.0]), "chi", 1),
        (lambda: ex.portrait.wander(BESIDE[:1]), "radius", 0),
        (lambda: ex.portrait.rotation_map(COIN, 2.0, points=4), "turns", (1, 1)),
    ],
)
def test_a_missing_number_is_found_in_every_kind_of_result(make, field, at):
    found = make()
    assert not_finite(found) == []
    within(found, field)[at] = np.nan
    assert any(field in told for told in not_finite(found))


def test_numbers_are_sought_in_what_a_result_holds_and_in_several_of_them():
    film = ex.portrait.film(COIN, frames=2)
    assert not_finite([film, {"one": film}]) == []
    film.chi[-1][0] = np.inf
    assert not_finite([film]) == ["[0]Film.chi[-1]"]
    C = ex.falling_constant(COIN, "phi=0,phidot=0.5:1,sigma3=0.5:1")
    assert not_finite(C) == []
    assert not_finite(replace(C, value=np.nan)) == ["FallingConstant.value"]
    assert not_finite(replace(C, value=np.inf)) == []


def test_what_does_not_exist_may_be_missing():
    none = ex.bounces(LOW)
    assert none.ok.all()
    assert np.isnan(none.race_angle).all()
    assert not_finite(none) == []
    needle = ex.constants(ex.phi_to_states(NEEDLE, 0.2, 0.0, 1.0, 0.1))
    assert np.isnan(needle.sigma4_bar).all()
    assert not_finite(needle) == []
