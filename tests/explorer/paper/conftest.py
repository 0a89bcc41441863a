"""Rows of the paper, each checked once for all tests that read it, whichever process they run in."""

import pytest

from explorer.paper import pages
from explorer.paper.statement import STATEMENTS


@pytest.fixture(scope="session")
def checked(made_once):
    """The checked row of a number."""
    return lambda number: made_once(f"statement-{number}", lambda: pages.check_row(STATEMENTS[number]))
