"""Forces at the contact over a period."""

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.portrait.contact_forces import contact_forces

COIN = BODIES["coin"]


@pytest.mark.parametrize("disk", [BODIES["hoop"], COIN], ids=["hoop", "coin"])
def test_the_least_force_is_that_of_the_integrals_over_the_passage(disk):
    """`passage_forces` looks at the same motion by quadrature, with formulas of its own."""
    unit = disk.rate_unit
    given = 0.9 * unit, np.array([0.2, -0.01]) * unit, 0.8 * unit
    wanted = ex.passage_forces(disk, *given)
    found = contact_forces(disk, given[1], given[0], given[2])
    for each, least in zip(found, wanted.min_normal_force, strict=True):
        assert each.normal.min() == pytest.approx(least, abs=2e-3)


def test_the_friction_needed_is_that_of_the_integrals_over_the_passage():
    """Where the disk never lifts off, so that there is a largest one."""
    wanted = ex.passage_forces(BODIES["uniform"], 0.2, -0.3, 0.3)
    (found,) = contact_forces(BODIES["uniform"], [-0.3], 0.2, 0.3)
    assert found.friction.max() == pytest.approx(wanted.max_friction[0], abs=1e-4)


def test_the_forces_are_what_the_centre_s_path_needs():
    """Second differences of its path: upwards the normal force less the weight, along the table the friction."""
    (found,) = contact_forces(BODIES["uniform"], [-0.3], 0.2, 0.3)
    start, step = ex.constants_to_states(BODIES["uniform"], 0.2, -0.3, 0.3), 1e-3
    for each in np.linspace(0.1, 0.9, 9) * found.t.size:
        t = found.t[int(each)] + step * np.array([-1.0, 0.0, 1.0])
        path = ex.simulate(start, t_eval=t, observables=("path",), accuracy=1e-11).path[0]
        pull = (path[0] - 2.0 * path[1] + path[2]) / step**2 + [0.0, 0.0, 1.0]
        normal, friction = found.normal[int(each)], found.friction[int(each)]
        assert (normal, friction) == pytest.approx((pull[2], np.hypot(*pull[:2]) / pull[2]), abs=2e-4)


def test_the_table_carries_the_weight_on_average():
    """Over a period the centre gains no upward speed, so the normal force averages to the weight."""
    (each,) = contact_forces(COIN, [0.3 * COIN.rate_unit], 20.0, 25.0)
    assert np.trapezoid(each.normal, each.t) / each.t[-1] == pytest.approx(1.0, abs=2e-3)
    assert np.isnan(each.friction[each.normal <= 0.0]).all()
    assert 0.0 < each.airborne < 1.0


def test_a_fall_has_no_period():
    with pytest.raises(ex.InputError, match="falls; give numbers other than 0"):
        contact_forces(COIN, [0.0], 20.0, 25.0)
