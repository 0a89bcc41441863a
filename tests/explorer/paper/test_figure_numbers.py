"""Statement 58: the numbers of the paper's figures, with digits that are not the code's own."""

import pytest

from explorer.paper import figure_numbers
from explorer.paper.statement import STATEMENTS


def test_statement_58_notices_a_wrong_digit(monkeypatch):
    key = ("hoop", -0.01)
    wrong = figure_numbers.TABLE[key].replace("1.61133", "1.61132")
    monkeypatch.setattr(figure_numbers, "TABLE", {key: wrong})
    assert [finding.passed for finding in STATEMENTS[58].check()].count(False) == 1


@pytest.mark.parametrize("name", figure_numbers.BODIES)
def test_both_ways_to_the_numbers_agree(name):
    disk = figure_numbers.BODIES[name]
    one, other = figure_numbers.by_quadrature(disk, 0.01), figure_numbers.by_integration(disk, 0.01)
    assert one == pytest.approx(other, rel=1e-8)
