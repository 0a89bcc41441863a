"""Scene portrait: its summary, its options, its figures and its run."""

import json
import math

import numpy as np
import pytest
from conftest import BODIES, computed

import explorer as ex
from explorer.plot.style import figure_of
from explorer.portrait.potential import CENTRE, SADDLE
from explorer.scenes.portrait import Portrait

UNIFORM = BODIES["uniform"]


def scene_of(**options):
    return Portrait(disks=(options.pop("disk", UNIFORM),), **options)


def test_the_summary_has_levels_equilibria_separatrices_and_thresholds():
    scene = scene_of()
    found = json.loads(json.dumps({**scene.options(), **scene.summarise(computed(scene))}, allow_nan=False))
    assert [place["name"] for place in found["places"]] == ["on", "plus", "minus"]
    assert [place["reaches_flat"] for place in found["places"]] == [[1], [], []]
    assert all(place["largest_energy_error"] < 1e-12 for place in found["places"])
    assert len(found["levels"]) == found["samples"] == 27 == found["status"]["ok"]
    assert {at["kind"] for at in found["equilibria"]} == {CENTRE, SADDLE}
    assert [len(each["branches"]) for each in found["separatrices"]] == [2, 2, 2]
    falling = [piece["falls"] for level in found["levels"] for piece in level["pieces"] if level["place"] == "on"]
    assert True in falling
    assert False in falling
    for name in ("straight_rolling", "spinning_upright", "circular_rolling"):
        pair = found["thresholds"][name]
        assert pair["measured"] == pytest.approx(pair["closed_form"], rel=1e-9)
    well_ = found["well_on_the_line"]
    assert well_["bottom"] < well_["rim"] == found["separatrices"][0]["energy"]
    assert len(scene.headline(found)) == 6


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"well": True, "sigma3_bar": 1.0}, "no well beside the falling motions"),
        ({"energy": (2.0, 1.0)}, "empty range"),
        ({"energy": (1.0, 1.0)}, "empty range"),
        ({"energy": (-2.0, -1.0)}, "no motion has an energy below"),
        ({"energy": (0.0, math.inf)}, "empty range"),
        ({"sigma4_bar": 0.1, "eta_hat": 0.1}, "leave out one"),
        ({"well": True, "sigma4_bar": 0.1}, "leave it out"),
        ({"sigma3_bar": math.nan}, "must be a finite number"),
        ({"disk": ex.Disk(I1=0.25, I3=0.0)}, "I3 = 0"),
    ],
)
def test_bad_input_gets_a_sentence(options, words):
    with pytest.raises(ex.InputError, match=words):
        scene_of(**options)


def test_every_figure_of_the_scene_is_drawn(tmp_path):
    scene = scene_of(disk=BODIES["thick"], eta_hat=0.02)
    total = computed(scene)
    names = []
    for name, picture in scene.figures(scene.summarise(total), total):
        names.append(name)
        for ax in figure_of(picture).axes:
            assert ax.get_xlabel()
            assert ax.get_ylabel()
    assert names[:2] == ["portrait-on", "portrait-beside"]
    assert len(names) == len(set(names)) == scene.figure_count == scene_of().figure_count == 9
    assert scene_of(eta_hat=0.0).figure_count == 8


def test_a_run_stores_its_levels_and_goes_on(tmp_path):
    run = ex.run("portrait", out=tmp_path / "run", disk="uniform", eta_hat="0.02", energy="0.5:2", well=True)
    assert run.summary["eta_hat"] == 0.02
    tables = list(run.tables())
    assert len(tables) == 2
    assert [np.unique(table["energy"]).size for table in tables] == [9, 9]
    assert (tmp_path / "run" / "figures" / "steady-plane.svg").exists()
    with pytest.raises(ex.InputError, match="resume"):
        ex.run("portrait", out=tmp_path / "run", disk="uniform", eta_hat=0.02)
    again = ex.run("portrait", out=tmp_path / "run", disk="uniform", eta_hat=0.02, energy=(0.5, 2.0), well=True)
    assert again.summary == run.summary
    for name, value in (("energy", "far"), ("well", "yes"), ("sigma3_bar", "far"), ("eta_hat", "1:2")):
        with pytest.raises(ex.InputError, match=name):
            ex.run("portrait", out=tmp_path / "none", **{name: value})
    assert not (tmp_path / "none").exists()
