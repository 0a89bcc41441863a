"""Closed forms and series give the known numbers and solve the equations they stand for."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from explorer.paper import closed_forms
from explorer.paper.checks import BODIES, HOOP, MATCHING, UNIFORM, WITH_UNITS
from explorer.phase.disk import Disk


@pytest.mark.parametrize(
    ("disk", "r0", "dr0", "ratio"),
    [
        (UNIFORM, 1.4690645964539924, 2.1406983534237100, 0.7285923160189477),
        (HOOP, 1.3399836124079462, 1.8121040956130957, 0.6761665138414456),
        (MATCHING, 1.4164294327681471, 2.0055031816314819, 0.7079432039590211),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_the_known_numbers_at_the_vertical(disk, r0, dr0, ratio):
    assert closed_forms.recessive_at_vertical(disk) == pytest.approx((r0, dr0), rel=1e-14)
    assert closed_forms.recessive(closed_forms.parameters(disk).c, 0.0) == pytest.approx((r0, dr0), rel=1e-14)
    assert closed_forms.line_ratio(disk) == pytest.approx(ratio, rel=1e-14)
    assert closed_forms.eta_per_eta_hat(disk) == pytest.approx(disk.I3 * r0, rel=1e-14)


def test_the_known_potential_and_speed_at_flat():
    assert closed_forms.flat_potential(UNIFORM) == pytest.approx(0.08687994, abs=1e-8)
    assert closed_forms.flat_potential(HOOP, 2.0) == pytest.approx(4.0 * 0.13923263, abs=4e-8)
    assert closed_forms.impact_speed(UNIFORM, 2.1372811875) == pytest.approx(1.81125426, abs=5e-9)


@pytest.mark.parametrize("disk", [*WITH_UNITS, Disk(I1=0.5, I3=0.1)], ids=lambda disk: f"{disk.name}-{disk.I3}")
def test_the_series_solve_chaplygins_equation(disk):
    """Eq. (4.4), also past where the series about the vertical converges slowly."""
    c, X, Y, z = closed_forms.parameters(disk).c, 0.7, -0.3, 0.95
    run = solve_ivp(
        lambda at, x: (x[1], c * x[0] / (1.0 - at * at)), (0.0, z), (X, Y), "DOP853", rtol=1e-13, atol=1e-14
    )
    x, y, _ = closed_forms.scaled(c, 1.0, X, Y, z)
    assert run.y[:, -1] == pytest.approx([float(x), float(y)], rel=1e-11)


@pytest.mark.parametrize("disk", WITH_UNITS, ids=lambda disk: disk.name)
def test_bars_invert_chaplygins_solution_and_v_is_the_scaled_potential(disk):
    """Eqs (3.3), (3.5); (3.8) against (4.6), (4.9)."""
    bar3, bar4, z = 0.4, -0.7, 0.35
    assert closed_forms.bars(disk, z, *closed_forms.chaplygin(disk, bar3, bar4, z)) == pytest.approx((bar3, bar4))
    c, d, b = closed_forms.parameters(disk)
    W = closed_forms.scaled(c, d, -disk.I1 * bar3 / (disk.I3 * b), bar4 / b, z)[2]
    assert disk.energy_unit * W == pytest.approx(closed_forms.amended(disk, bar3, bar4, z), rel=1e-13)


@pytest.mark.parametrize("disk", BODIES, ids=lambda disk: disk.name)
def test_the_recessive_solution_is_a_combination_of_the_even_and_the_odd_one(disk):
    c, z = closed_forms.parameters(disk).c, np.linspace(-0.9, 0.3, 7)
    r0, dr0 = closed_forms.recessive_at_vertical(disk)
    assert closed_forms.recessive(c, z)[0] == pytest.approx(closed_forms.scaled(c, 0.0, r0, dr0, z)[0], rel=1e-12)
