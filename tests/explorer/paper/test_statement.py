"""Findings, and the list of all statements."""

import math

import pytest

import explorer as ex
from explorer.paper import pages
from explorer.paper.statement import STATEMENTS, Finding, chosen, shown, statement


def test_a_finding_passes_within_its_tolerance_and_nan_does_not():
    assert Finding("a number", 1.0, 1.0, 1e-9, 1e-9, "a reason").passed
    assert not Finding("a number", 1.0, 1.0, 2e-9, 1e-9, "a reason").passed
    assert not Finding("a number", 1.0, 1.0, math.nan, 1e-9, "a reason").passed


@pytest.mark.parametrize(
    ("error", "tolerance", "printed", "passed"),
    [
        (1e-9, 1e-3, 1.0, True),
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
    assert all(row.name == row.name.upper() for row in rows)
    assert all(row.text.endswith(".") and "  " not in row.text and "\n" not in row.text for row in rows)


def test_the_statements_of_each_section_stand_in_its_file():
    homes = {number: row.check.__module__.rpartition(".")[2] for number, row in STATEMENTS.items()}
    assert len(pages.SECTIONS) == len(set(homes.values()))
    assert [homes[number] for number in (8, 9, 18, 19, 26, 27, 32, 33, 36, 40, 47, 48, 57, 58)] == [
        "section_2",
        *["section_3_4"] * 2,
        *["section_5"] * 2,
        *["section_6_1"] * 2,
        "section_6_2",
        "section_6_3",
        *["section_7_1"] * 2,
        *["section_7_3"] * 2,
        "figure_numbers",
    ]


def test_a_number_or_a_name_cannot_be_taken_twice():
    for number, name in ((1, "NEW"), (99, "LEMMA-5")):
        with pytest.raises(ValueError, match="is there already"):
            statement(number, name)(lambda: iter(()))
    assert 99 not in STATEMENTS


def test_statements_can_be_asked_for_by_number_or_name():
    assert [row.number for row in chosen(None)] == list(range(1, 59))
    assert chosen("58")[0] is STATEMENTS[58]
    assert chosen(" lemma-5 ")[0] is STATEMENTS[40]
    with pytest.raises(ex.InputError, match=r"only 'LEMMA-99' is no statement; did you mean 'LEMMA-\d'\?"):
        chosen("LEMMA-99")


def test_values_are_shown_to_ten_digits():
    assert shown(1.0 / 3.0) == "0.3333333333"
    assert shown((1, 2.5)) == "1, 2.5"
    assert shown("words") == "words"
