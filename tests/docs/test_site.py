"""The site is built without a warning and works from files."""

import subprocess
import sys

import pytest
from browser import chromium
from docs.pages import ROOT

pytestmark = pytest.mark.long

# A promise that is kept when the search shows a page; the browser gives up after 20 s.
FOUND = """new Promise(done => {
    const look = () => document.querySelector('ul.search li') ? done() : setTimeout(look, 50);
    look();
})"""


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The site as a folder of files; a warning fails."""
    folder = tmp_path_factory.mktemp("site")
    build = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", str(ROOT / "docs"), str(folder)]
    made = subprocess.run(build, capture_output=True, text=True, check=False)
    assert made.returncode == 0, made.stderr
    return folder


@pytest.fixture(scope="module")
def browser():
    with chromium.started() as browser:
        yield browser


def test_formulas_are_drawn_without_a_script(site, browser):
    browser.open(site / "explanation" / "mechanics.html")
    size = browser.evaluate("(() => { const box = document.querySelector('.formula math').getBoundingClientRect();"
                            " return [box.width, box.height]; })()")  # fmt: skip
    assert size[0] > 100
    assert size[1] > 20
    assert browser.evaluate("document.querySelectorAll('.MathJax, .math.notranslate').length") == 0


def test_search_finds_a_phrase_from_files_and_nothing_leaves(site, browser):
    browser.open(site / "search.html", "?q=wrong+way")
    browser.evaluate(FOUND)
    assert "wrong-ways.html" in browser.evaluate("document.querySelector('#search-results').innerHTML")
    assert [address for address in browser.requests() if not address.startswith(("file:", "data:"))] == []


def test_every_page_is_in_the_site(site):
    pages = {page.relative_to(ROOT / "docs").with_suffix(".html") for page in (ROOT / "docs").rglob("*.md")}
    assert {page for page in pages if not (site / page).is_file()} == set()
