"""The pages of the paper: what they say, and that the committed ones are those of the code."""

import shutil
from pathlib import Path

import pytest

from explorer.commands.pages import escaped
from explorer.commands.paper import figures_page
from explorer.paper import pages
from explorer.paper.figures import FIGURES
from explorer.paper.statement import ETA_HAT, STATEMENTS, Finding, Statement

RESULTS = Path(__file__).parents[3] / "results" / "paper"


def row(*findings, number=1, name="TEST"):
    return Statement(number, name, "A claim.", lambda: iter(findings))


GOOD = Finding("something", 1.0, 1.0, 1e-12, 1e-9, "rounding")
BAD = Finding("something else", 2.0, 1.0, 1.0, 1e-9, "rounding")
UNKNOWN = Finding("a limit", float("nan"), 1.0, float("nan"), 1e-9, "rounding")
UNDECIDED = Finding("a misprint", 1.0, 1.0, 1e-12, 1e-9, "rounding", {"(1)": 1e-10})


@pytest.mark.parametrize(
    ("findings", "passed"),
    [((GOOD,), True), ((GOOD, BAD), False), ((UNKNOWN,), False), ((UNDECIDED,), False), ((), False)],
)
def test_a_row_holds_if_all_its_findings_do_and_there_is_one(findings, passed):
    assert pages.check_row(row(*findings)).passed is passed


def test_a_row_that_cannot_be_computed_fails_with_its_reason():
    def broken():
        yield GOOD
        raise ZeroDivisionError("of nothing")

    checked = pages.check_row(Statement(1, "TEST", "A claim.", broken))
    assert not checked.passed
    assert "ZeroDivisionError: of nothing" in pages.statements_page([checked])


def test_the_page_names_what_fails_and_what_it_measured():
    rows = [pages.check_row(row(GOOD)), pages.check_row(row(GOOD, BAD, number=2, name="WRONG"))]
    page = pages.statements_page(rows)
    assert "1 of 2 hold. Failing: WRONG." in page
    assert "| something else | 2 | 1 | 1.0e+00 | 1.0e-09 | rounding | FAILS |" in page
    assert any("compared 1.0e+00" in line for line in pages.headline(rows))


def cells(line):
    return line.replace("\\|", "¦").removeprefix("| ").removesuffix(" |").split(" | ")


def numbers(text):
    """The numbers of a cell, or nothing where it has words."""
    try:
        return [float(part) for part in text.split(", ")]
    except ValueError:
        return None


def alike(made, kept, apart):
    """Two cells with the same words, or with numbers that differ by little."""
    ours, theirs = numbers(made), numbers(kept)
    if ours is None or theirs is None:
        return made == kept
    return ours == pytest.approx(theirs, rel=1e-3, abs=apart)


@pytest.mark.long
def test_the_committed_statements_are_what_the_code_finds(checked):
    """Words to the letter; numbers to what each comparison allows, since rounding differs between machines."""
    made = pages.statements_page([checked(number) for number in sorted(STATEMENTS)]).splitlines()
    kept = (RESULTS / "statements.md").read_text(encoding="utf-8").splitlines()
    assert "58 of 58 hold." in kept
    assert len(made) == len(kept)
    for one, other in zip(made, kept, strict=True):
        if not one.startswith("| ") or one.startswith("| computed"):
            assert one == other
            continue
        ours, theirs = cells(one), cells(other)
        assert [ours[i] for i in (0, 4, 5, 6)] == [theirs[i] for i in (0, 4, 5, 6)]
        allowed = 2.0 * float(ours[4])
        assert alike(ours[1], theirs[1], allowed), (one, other)
        assert alike(ours[2], theirs[2], allowed), (one, other)
        assert float(theirs[3]) <= float(theirs[4]), other


@pytest.mark.long
def test_the_committed_misprints_are_what_the_code_finds(checked):
    made = pages.misprints_page(checked(number) for number in sorted(STATEMENTS)).splitlines()
    kept = (RESULTS / "misprints.md").read_text(encoding="utf-8").splitlines()
    assert len(made) == len(kept)
    for one, other in zip(made, kept, strict=True):
        ours, theirs = cells(one), cells(other)
        assert ours[:5] == theirs[:5]
        assert all(
            mine == pytest.approx(its, rel=0.1) for mine, its in zip(*map(decided, (ours, theirs)), strict=True)
        )


def decided(row):
    """The two numbers of a row, as far as they are shown."""
    return [float(cell) for cell in row[5:] if numbers(cell) is not None]


def test_the_committed_page_of_figures_is_that_of_the_code(tmp_path):
    shutil.copytree(RESULTS / "figures", tmp_path / "figures")
    figures_page(tmp_path)
    page = (tmp_path / "README.md").read_text(encoding="utf-8")
    assert page == (RESULTS / "README.md").read_text(encoding="utf-8")
    for number, plan in FIGURES.items():
        assert escaped(plan.caption(number, plan.disk, ETA_HAT)) in page
