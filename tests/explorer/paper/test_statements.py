"""All statements of the paper hold, and a row of each section fails once something it rests on is damaged."""

import pytest

from explorer.paper import (
    closed_forms,
    four_dimensions,
    pages,
    section_2,
    section_3_4,
    section_5,
    section_6_1,
    section_6_2,
    section_7_1,
)
from explorer.paper import eight_dimensions as plain
from explorer.paper.statement import STATEMENTS


@pytest.mark.parametrize("number", STATEMENTS)
def test_the_statement_holds(number, checked):
    row = checked(number)
    assert row.trouble is None
    assert row.findings
    assert [(f.computed, f.error, f.tolerance, f.printed) for f in row.findings if not f.passed] == []
    assert all(f.reason and f.computed for f in row.findings)


@pytest.fixture
def fresh():
    """No row remembers a motion from before the damage, or a damaged one."""

    def forget():
        for module in (*pages.SECTIONS, four_dimensions, plain):
            for value in vars(module).values():
                if hasattr(value, "cache_clear"):
                    value.cache_clear()

    forget()
    yield
    forget()


@pytest.mark.usefixtures("fresh")
@pytest.mark.parametrize(
    ("number", "home", "name"),
    [
        (1, section_2, "inertia_tensor"),
        (11, section_3_4, "amended"),
        (20, section_5, "at_vertical"),
        (32, section_6_1, "potential"),
        (34, section_6_2, "well"),
        (36, plain, "angular_acceleration"),
        (41, section_7_1, "potential"),
        (53, closed_forms, "at_vertical"),
    ],
)
def test_a_row_of_each_section_notices_damage(number, home, name, monkeypatch):
    """What a function returns is too large by a fiftieth, every part of it."""
    original = getattr(home, name)

    def damaged(*arguments, **named):
        value = original(*arguments, **named)
        parts = [1.02 * part for part in value] if isinstance(value, tuple) else 1.02 * value
        return type(value)(*parts) if hasattr(value, "_fields") else parts

    monkeypatch.setattr(home, name, damaged)
    assert not all(finding.passed for finding in STATEMENTS[number].check())
