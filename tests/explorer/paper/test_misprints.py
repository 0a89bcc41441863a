"""Misprints: each is decided by numbers of a statement, and the numbers can decide otherwise."""

from dataclasses import replace

import pytest

from explorer.paper.pages import MISPRINTS
from explorer.paper.statement import FACTOR, STATEMENTS

# The statement that decides each.
DECIDED_BY = {
    "2.2, 2.4": 2,
    "(2.12), last term": 4,
    "(2.32) and end of 3.4": 7,
    "(2.35)": 8,
    "3.4, substitution": 15,
    "3.4, contact point": 15,
    "3.4, centre of mass": 15,
    "4, vector field C": 18,
    "Lemma 2, proof": 22,
    "Lemma 3, end of proof": 28,
    "(6.7)": 28,
    "(6.8)": 32,
    "Lemma 4, proof": 31,
    "Lemma 4, end": 32,
    "Proposition 1, proof": 36,
    "(7.6)": 40,
    "Lemma 5, proof": 40,
    "after Lemma 5, acceleration": 41,
    "after Lemma 5, period": 41,
    "Lemma 6, orders": 43,
    "Lemma 7, proof": 48,
    "7.3, angle of p − a": 53,
    "captions of Figs. 8 and 9": 58,
}


@pytest.fixture(scope="module")
def deciding(checked):
    """Findings that decide a misprint, with their statement."""
    rows = [checked(number) for number in sorted(set(DECIDED_BY.values()))]
    return [(row.statement, finding) for row in rows for finding in row.findings if finding.printed]


def test_all_23_misprints_are_there():
    assert list(MISPRINTS) == list(DECIDED_BY)
    assert len(MISPRINTS) == 23
    assert all(printed != right for printed, right in MISPRINTS.values())


@pytest.mark.parametrize("where", MISPRINTS)
def test_the_numbers_refute_the_printed_form_and_bear_the_right_one(where, deciding):
    rows = [(statement, finding) for statement, finding in deciding if where in finding.printed]
    assert {statement.number for statement, _ in rows} == {DECIDED_BY[where]}
    for _, finding in rows:
        assert finding.passed
        assert finding.printed[where] >= FACTOR * finding.tolerance


@pytest.mark.parametrize("where", MISPRINTS)
def test_a_row_fails_whose_printed_form_is_as_good_as_the_right_one(where, deciding):
    rows = [finding for _, finding in deciding if where in finding.printed]
    assert rows
    assert not any(replace(finding, printed={where: finding.error}).passed for finding in rows)


def test_no_finding_decides_a_misprint_that_is_not_listed(checked):
    assert {where for number in STATEMENTS for f in checked(number).findings for where in f.printed} == set(
        MISPRINTS
    )
