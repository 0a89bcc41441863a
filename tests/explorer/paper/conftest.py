"""Rows of the paper, each checked once for all tests that read it, whichever process they run in."""

import pytest
from paper_rows import forget

from explorer.paper import pages
from explorer.paper.statement import STATEMENTS


def pytest_generate_tests(metafunc):
    """Each statement of a section, and each of its damages."""
    if "number" in metafunc.fixturenames and hasattr(metafunc.module, "NUMBERS"):
        metafunc.parametrize("number", metafunc.module.NUMBERS)
    if "damaged" in metafunc.fixturenames:
        rows = metafunc.module.DAMAGES
        metafunc.parametrize("damaged", rows, ids=[str(row[0]) for row in rows])


@pytest.fixture(scope="session")
def checked(made_once):
    """The checked row of a number."""
    return lambda number: made_once(f"statement-{number}", lambda: pages.check_row(STATEMENTS[number]))


@pytest.fixture
def fresh():
    """Nothing is remembered from undamaged runs, nor from damaged ones."""
    forget()
    yield
    forget()
