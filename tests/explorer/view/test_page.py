"""`ex.view` and the file it writes."""

import html
import json
import re

import pytest

import explorer as ex
from explorer.commands.main import main
from explorer.view.page import view


def begins_with(page):
    text = page.partition('<script type="application/json" id="start">')[2].partition("</script>")[0]
    return json.loads(text)


def test_the_page_is_far_below_a_megabyte(tmp_path):
    where = view().save(tmp_path / "page.html")
    assert 50_000 < where.stat().st_size < 200_000


def test_the_page_begins_with_the_motion_and_the_series_of_python():
    disk = ex.Disk(I1=0.3, I3=0.4, name="mine")
    data = begins_with(view(disk, 0.5, -1e-12, 2.0, -1).html)
    assert data["start"] == {
        "disk": "given",
        "sigma3_bar": 0.5,
        "eta_hat": -1e-12,
        "phidot": 2.0,
        "face": -1,
        "theta": pytest.approx(1.5707963267948966, rel=0.0),
    }
    given = data["bodies"][-1]
    assert (given["label"], given["inner"]) == ("mine", None)
    rows = [list(row) for row in disk.natural.series]
    assert given["series"] == {"rows": rows, "r0": disk.body.r0, "dr0": disk.body.dr0}


@pytest.mark.parametrize(
    ("words", "laboratory"),
    [([], False), (["--disk", "uniform"], True), (["--eta-hat", "1e-6"], True), (["--face", "1"], True)],
    ids=str,
)
def test_the_page_opens_at_the_laboratory_where_a_motion_is_named(words, laboratory, tmp_path):
    where = tmp_path / "page.html"
    assert main(["view", *words, "--out", str(where), "--quiet"]) == 0
    assert begins_with(where.read_text("utf-8"))["laboratory"] == laboratory
    assert not begins_with(view().html)["laboratory"]
    assert begins_with(view("uniform").html)["laboratory"]


@pytest.mark.parametrize(("disk", "name"), [("hoop", "hoop"), ("annulus:0", "uniform"), ("annulus:0.3", "given")])
def test_bodies_with_a_button_are_known_again(disk, name):
    data = begins_with(view(disk).html)
    assert data["start"]["disk"] == name
    assert [body["name"] for body in data["bodies"]][:3] == ["uniform", "hoop", "matching"]
    assert data["bodies"][-1]["inner"] == pytest.approx({"annulus:0.3": 0.3}.get(disk, 3.0**-0.5))


def test_units_of_the_disk_are_explained_where_they_are_not_natural():
    assert begins_with(view().html)["note"] == ""
    assert "28.47" in begins_with(view(ex.Disk.uniform(r=0.0121, g=9.81), phidot=20.0).html)["note"]


def test_a_notebook_gets_the_whole_page_in_a_frame():
    page = view(eta_hat=1e-6)
    (text,) = re.findall(r'<iframe srcdoc="([^"]*)"', page._repr_html_())
    assert html.unescape(text) == page.html


@pytest.mark.parametrize("name", ["page.txt", "page", "missing/page.html"])
def test_a_file_that_cannot_be_written_is_named(tmp_path, name):
    with pytest.raises(ex.InputError, match=re.escape(name)):
        view().save(tmp_path / name)
