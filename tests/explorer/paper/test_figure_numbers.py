"""Statement 58: the numbers of the paper's figures, with digits that are not the code's own."""

import pytest
from paper_rows import assert_holds, findings

from explorer.paper import figure_numbers
from explorer.paper.figures import ETA_HAT


def test_statement_58_holds(checked):
    row = checked(58)
    assert_holds(row)
    assert len(row.findings) == 57


def test_statement_58_notices_a_wrong_digit(monkeypatch):
    key = ("hoop", -0.01)
    wrong = figure_numbers.TABLE[key].replace("1.61133", "1.61132")
    monkeypatch.setattr(figure_numbers, "TABLE", {key: wrong})
    assert [finding.passed for finding in findings(58)].count(False) == 1


def test_statement_58_notices_the_printed_sign_of_the_second_start(monkeypatch):
    """The captions of Figs. 8 and 9 have +0.01 where the text's start has -0.01."""
    monkeypatch.setattr(figure_numbers, "TABLE", {})
    monkeypatch.setattr(figure_numbers, "ETA_HAT", -ETA_HAT)
    (finding,) = findings(58)
    assert finding.passed
    monkeypatch.setattr(figure_numbers, "line_ratio", lambda disk: 0.0)
    (finding,) = findings(58)
    assert not finding.passed


@pytest.mark.parametrize("name", figure_numbers.BODIES)
def test_both_ways_to_the_numbers_agree(name):
    disk = figure_numbers.BODIES[name]
    one, other = figure_numbers.by_quadrature(disk, 0.01), figure_numbers.by_integration(disk, 0.01)
    assert one == pytest.approx(other, rel=1e-8)
