"""The digits of the method of order eight; `test_tableaux` has its order conditions."""

import math

import pytest

from kernels.steps.coefficients853 import FIFTH, THIRD, A, B


def test_every_stage_uses_only_stages_before_it():
    assert [len(row) for row in A] == list(range(12))
    assert len(B) == len(FIFTH) == len(THIRD) == 12


@pytest.mark.parametrize(
    ("stage", "node"), [(1, 0.0526001519587677), (6, 0.25), (8, 0.6512820512820513), (11, 1.0)]
)
def test_the_rows_sum_to_the_published_nodes(stage, node):
    """Hairer, Norsett & Wanner, table of DOP853: c_2, c_7, c_9, c_12."""
    assert math.fsum(A[stage]) == pytest.approx(node, abs=1e-15)


def test_the_errors_of_both_orders_vanish_on_a_constant_field():
    assert math.fsum(B) == pytest.approx(1.0, abs=1e-15)
    assert math.fsum(FIFTH) == pytest.approx(0.0, abs=1e-15)
    assert math.fsum(THIRD) == pytest.approx(0.0, abs=1e-15)
