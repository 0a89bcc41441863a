"""Rows of the paper, each checked once for all tests that read it."""

import pytest
from paper_rows import forget

from explorer.paper import pages
from explorer.paper.statement import STATEMENTS


@pytest.fixture(scope="session")
def checked():
    """The checked row of a number."""
    rows = {}

    def row(number):
        if number not in rows:
            rows[number] = pages.check_row(STATEMENTS[number])
        return rows[number]

    return row


@pytest.fixture
def fresh():
    """Nothing is remembered from undamaged runs, nor from damaged ones."""
    forget()
    yield
    forget()
