"""Rows of the paper that are checked, and ways to damage what they rest on."""

from dataclasses import replace

import numpy as np
import pytest

from explorer.paper import eight_dimensions, four_dimensions, pages
from explorer.paper.statement import STATEMENTS


def findings(number):
    return list(STATEMENTS[number].check())


def fails(number):
    """Whether a row has a finding that fails. What comes after it is not computed."""
    return not all(finding.passed for finding in STATEMENTS[number].check())


def assert_holds(row):
    """A checked row without trouble, with findings that all pass and give their reasons."""
    assert row.trouble is None
    assert row.findings
    assert [(f.computed, f.error, f.tolerance, f.printed) for f in row.findings if not f.passed] == []
    assert all(f.reason and f.computed for f in row.findings)


class Statements:
    """What holds of every section of the paper, by the NUMBERS and DAMAGES of the file that derives from this."""

    def test_the_statement_holds(self, number, checked):
        assert_holds(checked(number))

    def test_every_statement_has_a_damage(self, request):
        assert [row[0] for row in request.module.DAMAGES] == list(request.module.NUMBERS)

    @pytest.mark.usefixtures("fresh")
    def test_the_row_notices_damage(self, monkeypatch, damaged):
        number, home, name, damage = damaged
        monkeypatch.setattr(home, name, damage(getattr(home, name)))
        assert fails(number)


def forget():
    """Drop what the rows remember of motions, so that nothing is carried from or to a damaged row."""
    for module in (*pages.SECTIONS, four_dimensions, eight_dimensions):
        for value in vars(module).values():
            if hasattr(value, "cache_clear"):
                value.cache_clear()


def scaled(factor):
    """A damage: what a function returns is too large, every part of it."""

    def damage(original):
        def wrong(*arguments, **named):
            value = original(*arguments, **named)
            if not isinstance(value, tuple):
                return factor * value
            parts = [factor * part for part in value]
            return type(value)(*parts) if hasattr(value, "_fields") else tuple(parts)

        return wrong

    return damage


def first(factor):
    """A damage: the first of several results is too large."""

    def damage(original):
        def wrong(*arguments, **named):
            one, *others = original(*arguments, **named)
            return (factor * one, *others)

        return wrong

    return damage


def second(factor):
    """A damage: the second of two results is too large."""

    def damage(original):
        def wrong(*arguments):
            pair = original(*arguments)
            changed = (pair[0], factor * pair[1])
            return type(pair)(*changed) if hasattr(pair, "_fields") else changed

        return wrong

    return damage


def field(name, factor):
    """A damage: one field of a result is too large."""

    def damage(original):
        def wrong(*arguments, **named):
            value = original(*arguments, **named)
            return replace(value, **{name: getattr(value, name) * factor})

        return wrong

    return damage


def without_one(_original):
    """A damage of the race number: sqrt(m r^2/I1) instead of sqrt(1 + m r^2/I1)."""
    return property(lambda disk: float(np.sqrt(disk.m * disk.r**2 / disk.I1)))


class Lifted:
    """A disk on which gravity pulls up, as eq. (2.12) has it in print."""

    def __init__(self, disk):
        self.m, self.r, self.g, self.I1, self.I3 = disk.m, disk.r, -disk.g, disk.I1, disk.I3


def upwards(original):
    """A damage of the angular acceleration: eq. (2.12) as printed."""
    return lambda disk, u, omega: original(Lifted(disk), u, omega)
