from pathlib import Path

import pytest

import explorer as ex
from explorer.paper import pages as report
from explorer.paper.statement import Finding, Statement, chosen

RESULTS = Path(__file__).parents[3] / "results" / "paper"


def row(*findings, number=1, name="TEST"):
    return Statement(number, name, "A claim.", lambda: iter(findings))


GOOD = Finding("something", 1.0, 1.0, 1e-12, 1e-9, "rounding")
BAD = Finding("something else", 2.0, 1.0, 1.0, 1e-9, "rounding")
UNKNOWN = Finding("a limit", float("nan"), 1.0, float("nan"), 1e-9, "rounding")


@pytest.mark.parametrize(
    ("findings", "passed"),
    [((GOOD,), True), ((GOOD, BAD), False), ((UNKNOWN,), False), ((), False)],
)
def test_a_row_holds_if_all_its_findings_do_and_there_is_one(findings, passed):
    assert report.check_row(row(*findings)).passed is passed


def test_a_row_that_cannot_be_computed_fails_with_its_reason():
    def broken():
        yield GOOD
        raise ZeroDivisionError("of nothing")

    found = report.check_row(Statement(1, "TEST", "A claim.", broken))
    assert not found.passed
    assert "ZeroDivisionError: of nothing" in report.statements_page([found])


def test_the_page_names_what_fails_and_what_it_found():
    rows = [report.check_row(row(GOOD)), report.check_row(row(GOOD, BAD, number=2, name="WRONG"))]
    page = report.statements_page(rows)
    assert "1 of 2 hold. Failing: WRONG." in page
    assert "| something else | 2 | 1 | 1.0e+00 | 1.0e-09 | rounding | FAILS |" in page
    assert any("compared 1.0e+00" in line for line in report.headline(rows))


def test_a_hand_edit_breaks_the_seal(tmp_path):
    page = tmp_path / "page.md"
    report.write_sealed(page, "# A page\n\nwith a number: 1.0\n")
    assert report.is_sealed(page)
    page.write_text(page.read_text().replace("1.0", "1.1"))
    assert not report.is_sealed(page)
    page.write_text("no seal at all")
    assert not report.is_sealed(page)


def test_all_58_statements_are_there_and_can_be_asked_for():
    rows = report.all_statements()
    assert [one.number for one in rows] == list(range(1, 59))
    assert chosen("58")[0] is rows[-1]
    assert chosen(rows[4].name.lower())[0] is rows[4]
    with pytest.raises(ex.InputError, match="--only 'LEMMA-99' is no statement"):
        report.all_statements("LEMMA-99")


@pytest.mark.parametrize("name", ["statements.md", "misprints.md"])
def test_the_committed_pages_are_as_they_were_generated(name):
    assert report.is_sealed(RESULTS / name)


def test_the_committed_statements_are_those_of_the_code_and_all_hold():
    page = (RESULTS / "statements.md").read_text(encoding="utf-8")
    assert "58 of 58 hold." in page
    for one in report.all_statements():
        assert f"## {one.number}. {one.name}: holds" in page
        assert one.text in page


def test_the_committed_misprints_are_those_of_the_code():
    from explorer.paper.misprints import MISPRINTS

    page = (RESULTS / "misprints.md").read_text(encoding="utf-8")
    for misprint in MISPRINTS:
        assert misprint.where in page


def test_one_statement_is_checked_without_writing_anything(tmp_path):
    rows = report.paper(tmp_path / "none", only="16")
    assert [one.statement.number for one in rows] == [16]
    assert rows[0].passed
    assert not (tmp_path / "none").exists()


def test_bad_jobs_are_named(tmp_path):
    with pytest.raises(ex.InputError, match="--jobs 0"):
        report.paper(tmp_path, jobs=0)
