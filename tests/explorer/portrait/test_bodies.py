"""Race numbers and gaps of bodies, in closed form and measured."""

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.portrait.bodies import flat_body, measured_gaps, race_numbers

UNIFORM, HOOP = BODIES["uniform"], BODIES["hoop"]


def test_gaps_are_those_of_the_disks_and_of_the_paper():
    numbers = race_numbers(16.0, 17)
    np.testing.assert_array_equal(numbers.matching, [0.0, 3.0, 8.0, 15.0])
    np.testing.assert_array_equal(numbers.gap[np.isin(numbers.ratio, numbers.matching)], 0.0)
    assert numbers.gap[numbers.ratio == 4.0][0] == pytest.approx(1.483259, abs=1e-6)
    assert numbers.gap[numbers.ratio == 2.0][0] == pytest.approx(4.599611, abs=1e-6)
    for ratio, kappa, gap in zip(numbers.ratio[1:], numbers.kappa[1:], numbers.gap[1:], strict=True):
        assert (kappa, gap) == pytest.approx(
            (flat_body(float(ratio)).kappa, flat_body(float(ratio)).gap), abs=1e-12
        )


def test_passages_beside_f_measure_kappa_and_the_gap():
    """Race angles by quadrature, on both sides; the law eta ln(1/eta) leaves 1e-10 at 1e-12."""
    disks = [HOOP, UNIFORM, flat_body(3.0), flat_body(8.0), BODIES["thick"], BODIES["coin"]]
    found = measured_gaps(disks)
    np.testing.assert_allclose(found.kappa, [disk.kappa for disk in disks], rtol=0.0, atol=1e-9)
    slow = measured_gaps([ex.Disk.uniform(r=4.0), ex.Disk.uniform(g=1e-16)])  # units of rates: a half and 1e-8
    np.testing.assert_allclose(slow.kappa, ex.Disk.uniform().kappa, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(found.ratio, [disk.m * disk.r**2 / disk.I1 for disk in disks])
    np.testing.assert_allclose(found.kappa, np.sqrt(1.0 + found.ratio), rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(found.gap, [disk.gap for disk in disks], rtol=0.0, atol=1e-8)


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: race_numbers(-1.0), "most = -1.0"),
        (lambda: race_numbers(16.0, 1), "points = 1"),
        (lambda: flat_body(0.0), "ratio = 0.0"),
        (lambda: measured_gaps([]), "disks: none"),
    ],
)
def test_bad_input_gets_a_sentence(call, says):
    with pytest.raises(ex.InputError) as caught:
        call()
    assert says in str(caught.value)
