"""Findings, and the list of all statements."""

import math

import pytest

import explorer as ex
from explorer.paper.statement import STATEMENTS, Finding, chosen


@pytest.mark.parametrize(
    ("error", "tolerance", "printed", "passed"),
    [
        (1e-9, 1e-3, 1.0, True),
        (1e-3, 1e-3, 1.0, True),
        (2e-3, 1e-3, 1.0, False),
        (1e-9, 1e-3, 0.05, False),
        (1e-9, 1e-3, math.nan, False),
        (math.nan, 1e-3, 1.0, False),
        (0.0, 0.0, 0.0, False),
    ],
)
def test_evidence_that_does_not_tell_the_forms_apart_fails(error, tolerance, printed, passed):
    assert Finding("a number", 1.0, 1.0, error, tolerance, "a reason", {"(1)": printed}).passed is passed


def test_all_58_statements_are_there_by_number_with_names_and_texts_of_their_own():
    assert sorted(STATEMENTS) == list(range(1, 59))
    rows = list(STATEMENTS.values())
    assert len({row.name for row in rows}) == len({row.text for row in rows}) == 58


def test_statements_can_be_asked_for_by_number_or_name():
    assert [row.number for row in chosen(None)] == list(range(1, 59))
    assert chosen("58")[0] is STATEMENTS[58]
    assert chosen(" lemma-5 ")[0] is STATEMENTS[40]
    with pytest.raises(ex.InputError, match=r"only 'LEMMA-99' is no statement; did you mean 'LEMMA-\d'\?"):
        chosen("LEMMA-99")
