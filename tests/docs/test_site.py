"""The site is built without a warning and works from files."""

import re
import subprocess
import sys

import pytest
from browser import chromium
from tools.pages import ROOT

pytestmark = pytest.mark.long

PAGES = [page.relative_to(ROOT / "docs").with_suffix(".html") for page in sorted((ROOT / "docs").rglob("*.md"))]
# Code and formulas that are wider than their place.
CUT = """[...document.querySelectorAll(
    '.bd-article pre, .bd-article .formula, .bd-article .sig, .bd-article-container')].filter(
    each => each.scrollWidth > each.clientWidth + 1).map(each => each.textContent.slice(0, 60))"""
# How far down what one should see at once reaches.
LOWEST = """Math.max(...[...document.querySelectorAll('.landing img, .landing pre, .doors a')]
    .map(each => each.getBoundingClientRect().bottom))"""
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


def test_no_formula_and_no_code_is_cut(site, browser):
    for page in PAGES:
        browser.open(site / page)
        for width in (1280, 375):
            browser.size(width, 800, mobile=width < 500)
            cut, wide = browser.evaluate(f"[{CUT}, document.documentElement.scrollWidth]")
            assert (page, cut, wide) == (page, [], width)


def test_the_landing_page_shows_picture_line_and_doors_without_scrolling(site, browser):
    browser.size(1280, 800)
    browser.open(site / "index.html")
    browser.evaluate("Promise.all([...document.images].map(each => each.decode()))")
    assert browser.evaluate(LOWEST) <= 800


def test_the_picture_of_the_landing_page_leads_to_the_article(site, browser):
    browser.open(site / "index.html")
    browser.open(site / browser.evaluate("document.querySelector('.landing a').getAttribute('href')"))
    assert browser.evaluate("nearflat.article.figures.length") == 8
    assert browser.problems() == []


def test_every_page_is_in_the_site_and_all_its_pictures_too(site, browser):
    assert {page for page in PAGES if not (site / page).is_file()} == set()
    for page in (*PAGES, "article.html"):
        text = (site / page).read_text("utf-8")
        shown = re.findall(r'<(?:img|iframe)[^>]* src="([^":]+)"', text)
        assert [name for name in shown if not (site / page).parent.joinpath(name).is_file()] == []
