"""Scene portrait: its summary, its options and its pictures."""

import json

import numpy as np
import pytest
from conftest import BODIES, computed

import explorer as ex
from explorer.phase.potential import CENTRE, SADDLE
from explorer.pictures.calls import portraits_of
from explorer.scenes.portrait import Portrait


def test_the_summary_has_levels_equilibria_separatrices_and_thresholds():
    scene = Portrait()
    found = json.loads(json.dumps({**scene.options, **scene.summarise(computed(scene))}, allow_nan=False))
    assert [place["name"] for place in found["places"]] == ["on", "plus", "minus"]
    assert [place["reaches_flat"] for place in found["places"]] == [[1], [], []]
    assert all(place["largest_energy_error"] < 1e-12 for place in found["places"])
    assert len(found["levels"]) == found["samples"] == 27 == found["status"]["ok"]
    assert {at["kind"] for at in found["equilibria"]} == {CENTRE, SADDLE}
    assert [len(each["branches"]) for each in found["separatrices"]] == [2, 2, 2]
    on = {piece["falls"] for level in found["levels"] for piece in level["pieces"] if level["place"] == "on"}
    assert on == {True, False}
    for name in ("straight_rolling", "spinning_upright", "circular_rolling"):
        assert found["thresholds"][name]["closed_form"] > 0.0
    assert len(scene.headline(found)) == 6


def test_a_chunk_holds_the_points_of_nine_levels_within_the_energies_that_are_asked():
    scene = Portrait.of({"disk": "uniform", "eta_hat": "0.02", "energy": "0.5:2"})
    assert scene == Portrait.of({"disk": "uniform", "eta_hat": 0.02, "energy": (0.5, 2.0)})
    assert scene.chunks == 2
    for index in range(2):
        table, tally = scene.chunk(index)
        energies = np.unique(table["energy"])
        assert energies.size == tally.status["ok"] == scene.length(index) == 9
        assert energies.max() == 2.0


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"energy": (2.0, 1.0)}, "empty"),
        ({"energy": (1.0, 1.0)}, "empty"),
        ({"energy": (-2.0, -1.0)}, "no motion has an energy below"),
        ({"energy": "far"}, "energy"),
        ({"sigma4_bar": 0.1, "eta_hat": 0.1}, "leave one out"),
        ({"sigma3_bar": "far"}, "sigma3_bar"),
        ({"sigma3_bar": "nan"}, "sigma3_bar"),
        ({"eta_hat": "1:2"}, "eta_hat"),
        ({"disk": ex.Disk(I1=0.25, I3=0.0)}, "I3 = 0"),
        ({"samples": 3}, "portrait takes no such option"),
    ],
)
def test_bad_input_gets_a_sentence(options, words):
    with pytest.raises(ex.InputError, match=words):
        Portrait.of(options)


def test_pictures_need_no_run_and_follow_the_places_that_are_asked():
    def names(**asked):
        return {name for name, _ in portraits_of("phase", Portrait(**asked))}

    usual = {"potential", "potential-near-flat", "steady-map", "steady-plane"}
    usual |= {f"steady-{path}" for path in ("line", "rolling", "spinning")}
    assert names() == {"portrait-on", "portrait-sides", *usual}
    assert names(disk=BODIES["thick"], eta_hat=0.02) == {"portrait-on", "portrait-beside", *usual}
    assert names(eta_hat=0.0) == {"portrait-on", *usual}
    assert names(sigma4_bar=0.3) == {"portrait-given", *usual}
