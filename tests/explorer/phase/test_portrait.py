"""What phase portraits are drawn of: places, levels, equilibria, separatrices and thresholds, in numbers."""

import json
import math

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.phase.portrait import Portrait
from explorer.phase.potential import CENTRE, SADDLE, TURNING

UNIFORM = BODIES["uniform"]


def described(disk=UNIFORM, **asked):
    """What is said of a portrait, as JSON gives it back."""
    return json.loads(json.dumps(Portrait(disk, **asked).describe(), allow_nan=False))


def rows_of(found, name, place):
    return [row for row in found[name] if row["place"] == place]


def test_flat_is_reached_on_the_line_and_from_neither_side_of_it():
    found = described()
    assert [place["name"] for place in found["places"]] == ["on", "plus", "minus"]
    assert [place["reaches_flat"] for place in found["places"]] == [[1], [], []]
    falls = {
        place: {piece["falls"] for level in rows_of(found, "levels", place) for piece in level["pieces"]}
        for place in ("on", "plus", "minus")
    }
    assert falls == {"on": {True, False}, "plus": {False}, "minus": {False}}


def test_beside_the_line_there_is_one_well_more_than_on_it():
    found = described()
    kinds = [[at["kind"] for at in rows_of(found, "equilibria", place)] for place in ("on", "plus", "minus")]
    assert kinds == [[CENTRE, SADDLE], [CENTRE, SADDLE, CENTRE], [CENTRE, SADDLE, CENTRE]]


def test_separatrices_have_two_branches_at_the_energy_of_each_saddle(body):
    found = described(body)
    saddles = [(at["place"], at["phi"], at["energy"]) for at in found["equilibria"] if at["kind"] == SADDLE]
    lines = found["separatrices"]
    assert saddles
    assert [(line["place"], line["phi"], line["energy"]) for line in lines] == saddles
    for line in lines:
        left, right = line["branches"]
        assert left["high"] == line["phi"] == right["low"]


def test_each_place_has_nine_levels_whose_pieces_end_where_v_is_their_energy(body):
    found, ends = described(body), 0
    for place in found["places"]:
        V = ex.potential(body, place["sigma3_bar"], sigma4_bar=place["sigma4_bar"]).V
        levels = rows_of(found, "levels", place["name"])
        assert len(levels) == 9
        for level in levels:
            for piece in level["pieces"]:
                for edge, end in zip((piece["low"], piece["high"]), piece["ends"], strict=True):
                    if end == TURNING and abs(edge) < 1.2:
                        assert float(V(edge)) == pytest.approx(level["energy"], rel=1e-10)
                        ends += 1
    assert ends > 9


def test_the_thresholds_of_the_uniform_disk_are_those_of_its_moments_of_inertia():
    """I1 = 1/4, I3 = 1/2 and J = 3/2; on the circle the disk leans by pi/4 at two radii."""
    found = described()["thresholds"]
    assert found["straight_rolling"]["closed_form"] == pytest.approx(math.sqrt(1.0 / 3.0), rel=1e-14)
    assert found["spinning_upright"]["closed_form"] == pytest.approx(math.sqrt(0.8), rel=1e-14)
    turn = 1.0 / math.sqrt(3.0 - 1.25 * math.sqrt(0.5))
    assert found["circular_rolling"]["closed_form"] == pytest.approx(turn, rel=1e-14)


@pytest.mark.parametrize(
    ("asked", "names"),
    [
        ({}, ["on", "plus", "minus"]),
        ({"eta_hat": 0.02}, ["on", "beside"]),
        ({"eta_hat": 0.0}, ["on"]),
        ({"sigma4_bar": 0.3}, ["given"]),
    ],
)
def test_the_places_are_those_of_the_constants_that_are_asked(asked, names):
    places = described(sigma3_bar=-0.2, **asked)["places"]
    assert [place["name"] for place in places] == names
    assert all(place["sigma3_bar"] == -0.2 for place in places)
    for name, value in asked.items():
        assert places[-1][name] == pytest.approx(value, rel=1e-14)


def test_without_sigma3_bar_the_line_has_a_well_beside_which_sides_differ_in_sign_only(body):
    found = described(body)
    assert [at["kind"] for at in rows_of(found, "equilibria", "on")] == [CENTRE, SADDLE]
    on, plus, minus = (place["eta_hat"] for place in found["places"])
    assert plus > on == 0.0
    assert minus == -plus


def test_levels_lie_in_the_range_of_energies_that_is_asked():
    found = described(eta_hat=0.02, energy=(0.5, 2.0))
    for place in ("on", "beside"):
        energies = [level["energy"] for level in rows_of(found, "levels", place)]
        assert np.all(np.diff(energies) > 0.0)
        assert energies[0] >= 0.5
        assert energies[-1] == 2.0
