"""The page is one file made of modules that can be read."""

import json
import re

from explorer.pictures import style
from explorer.view.assembly import FOLDER, assemble, program

MODULES = sorted(FOLDER.glob("*.js"))
START = {"bodies": [], "start": {}, "note": ""}


def test_every_module_is_in_the_program_after_those_that_it_needs():
    order = re.findall(r'^modules\["(\w+)"\] = ', program(), flags=re.MULTILINE)
    assert sorted(order) == [path.stem for path in MODULES]
    for path in MODULES:
        for needed in re.findall(r'from "\./(\w+)\.js"', path.read_text("utf-8")):
            assert order.index(needed) < order.index(path.stem)


def test_every_import_names_what_the_other_module_exports():
    exported = re.compile(r"^export (?:async )?(?:const|function|class) (\w+)", re.MULTILINE)
    imported = re.compile(r'^import \{ ([^}]+) \} from "\./(\w+)\.js";$', re.MULTILINE)
    exports = {path.stem: set(exported.findall(path.read_text("utf-8"))) for path in MODULES}
    for path in MODULES:
        for names, needed in imported.findall(path.read_text("utf-8")):
            assert set(names.split(", ")) <= exports[needed], path.name


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
