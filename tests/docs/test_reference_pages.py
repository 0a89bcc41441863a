"""What pages say of options, columns, statuses and names is what the code has."""

import re

import pytest
from tools.pages import PAGES
from tools.reference_pages import DOCS, STUB, pages_with_parts, parsers, renewed, stub

from explorer import compiled
from explorer.phase.columns import COLUMNS
from explorer.scenes.scene import NAMES

GLOSSARY = (DOCS / "reference" / "glossary.md").read_text("utf-8")
TEXT = {page: page.read_text("utf-8") for page in PAGES}
LINK = re.compile(r"\]\(([^)#\s]+)(?:#[\w-]*)?\)")


@pytest.mark.parametrize("page", pages_with_parts(), ids=lambda page: page.stem)
def test_made_parts_are_as_the_code_makes_them(page):
    text = page.read_text("utf-8")
    assert renewed(text) == text, "make them again: python tests/tools/reference_pages.py"


def test_keywords_that_editors_complete_are_those_that_scenes_declare():
    assert STUB.read_text("utf-8") == stub(), "make them again: python tests/tools/reference_pages.py"


def test_every_option_column_status_and_scene_is_in_the_glossary():
    flags = {flag for parser in parsers().values() for action in parser._actions for flag in action.option_strings}
    codes = {each.name.lower() for each in compiled.status.Status}
    words = flags - {"-h", "--help"} | COLUMNS.keys() | codes | {*NAMES}
    assert {word for word in words if f"`{word}`" not in GLOSSARY} == set()


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_links_of_a_page_lead_to_files(page):
    targets = [target for target in LINK.findall(TEXT[page]) if "://" not in target]
    assert [target for target in targets if not (page.parent / target).exists()] == []
