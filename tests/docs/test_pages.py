"""Every block of the pages runs and prints what stands there."""

import re

import numpy as np
import pytest
from tools.pages import IMAGES, PAGES, ROOT, pictures, run, stored_digest

import explorer as ex

NAMES = [str(page.relative_to(ROOT)) for page in PAGES]
TUTORIAL = ROOT / "docs" / "tutorials" / "1-the-disk-that-nearly-falls.md"
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_the_blocks_of_a_page_run_and_print_what_stands_there(page, tmp_path):
    run(page, tmp_path)


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_pictures_of_a_page_were_made_by_the_code_that_stands_there(page):
    for name, digest in pictures(page).items():
        assert stored_digest(name) == digest, (
            f"{name}.png is older than its code; make it again: tests/tools/pages.py"
        )
        assert f"images/{name}.png" in page.read_text("utf-8")


def test_the_first_figure_is_told_in_the_turns_that_it_shows():
    """Its axis counts in π, half a turn."""
    (told,) = re.findall(r"turns by ([\d.]+) turns, ([\d.]+) of\s+them", TUTORIAL.read_text("utf-8"))
    disk = ex.Disk.uniform()
    passage = ex.passages(disk, sigma3_bar=1.0, eta_hat=0.01, phidot=1.0)
    turns = [passage.delta_chi.item(), passage.race_angle.item()]
    assert [float(word) for word in told] == [round(angle / (2.0 * np.pi), 1) for angle in turns]


def test_there_is_no_picture_without_a_page():
    saved = {f"{name}.png" for page in PAGES for name in pictures(page)}
    shown = {target.rsplit("/")[-1] for page in PAGES for target in LINK.findall(page.read_text("utf-8"))}
    assert {path.name for path in IMAGES.iterdir()} <= saved | shown
