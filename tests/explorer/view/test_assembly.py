"""The page is one file made of modules that can be read."""

import json
import re

from explorer.pictures import style
from explorer.view.assembly import FOLDER, assemble

MODULES = sorted(FOLDER.glob("*.js"))
START = {"bodies": [], "start": {}, "note": ""}


def test_the_page_names_no_address_of_the_network():
    page = assemble(START)
    assert not re.search(r"https?:|//\w+\.\w|@import|url\(|<link|src=", page)
    assert "/*STYLE*/" not in page
    assert "/*PROGRAM*/" not in page


def test_what_the_page_starts_with_cannot_end_its_script():
    page = assemble(START | {"note": "</script><b>"})
    text = page.partition('<script type="application/json" id="start">')[2].partition("</script>")[0]
    assert json.loads(text)["note"] == "</script><b>"


def test_blue_and_vermilion_are_those_of_the_pictures_and_only_the_sides():
    css = (FOLDER / "style.css").read_text("utf-8").lower()
    assert css.count(style.PLUS.lower()) == 1
    assert css.count(style.MINUS.lower()) == 1
    assert f"--plus: {style.PLUS.lower()}" in css
    assert f"--minus: {style.MINUS.lower()}" in css
    for path in MODULES:
        assert not re.search(r"0072b2|d55e00", path.read_text("utf-8"), re.IGNORECASE)
