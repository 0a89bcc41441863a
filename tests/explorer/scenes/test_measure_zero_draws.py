"""The two kinds of chunk of scene measure-zero: what they draw, keep and count."""

import json

import numpy as np
import pytest

from explorer.phase.constants import constants_of
from explorer.phase.states import COORDINATES, phi_to_states
from explorer.scenes.measure_zero_draws import PlainDraws, TubeDraws
from explorer.scenes.registry import build_scene


@pytest.fixture(scope="module")
def scene():
    return build_scene("measure-zero", samples=5000, tube=512, ladder="1e-6:1e-1", keep="all")


def test_plain_draws_come_last_so_that_a_longer_run_keeps_all_chunks(scene):
    longer = build_scene("measure-zero", samples=500_000, tube=512, ladder="1e-6:1e-1", keep="all")
    tubes = scene.chunks() - 1
    assert all(isinstance(scene.piece(index), TubeDraws) for index in range(tubes))
    assert isinstance(scene.piece(tubes), PlainDraws)
    for index in range(tubes):
        one, other = scene.piece(index), longer.piece(index)
        assert (one.rung, one.face, one.part, one.count) == (other.rung, other.face, other.part, other.count)


def test_both_kinds_have_the_same_columns_and_their_tallies_are_json(scene):
    plain, tube = scene.piece(scene.chunks() - 1), scene.piece(0)
    assert list(plain.compute()) == list(tube.compute())
    for piece in (plain, tube):
        tally = piece.tally(piece.compute())
        assert json.loads(json.dumps(tally, allow_nan=False)) == tally
        assert tally["draws"] == piece.count
        assert sum(tally["status"].values()) == piece.count


def test_a_plain_draw_that_is_not_followed_could_not_come_flatter_than_the_first_rung(scene):
    plain = scene.piece(scene.chunks() - 1)
    table = plain.compute()
    followed = phi_to_states(scene.disk, **{name: table[name] for name in COORDINATES})
    nearer = np.fmin(*(abs(getattr(constants_of(followed), name)) for name in ("eta_hat_plus", "eta_hat_minus")))
    np.testing.assert_allclose(nearer, abs(table["eta_hat"]), rtol=1e-9, atol=1e-14)
    tally = plain.tally(table)
    assert tally["status"]["not followed"] == plain.count - table["status"].size > 0
    assert sum(tally["hits"][0]) == plain.near(table).sum() > 0
    assert [sum(row) for row in tally["hits"]] == sorted((sum(row) for row in tally["hits"]), reverse=True)
    assert tally["race"]["wrong"] == 0 < tally["race"]["right"]


def test_the_sums_of_a_tube_are_those_of_its_hits(scene):
    tube = scene.piece(4)
    table = tube.compute()
    hit = table["weight"] * (table["theta_min"] < tube.delta)
    tally = tube.tally(table)
    assert tally["sum"] == hit.sum() > 0.0
    assert tally["hits"] == np.count_nonzero(hit)
    assert sum(tally["energy"]) == pytest.approx(tally["sum"])
    assert sum(tally["tilt_squares"]) == pytest.approx(tally["squares"])
    assert 0.0 < tally["sum_eta_positive"] < tally["sum"]
    assert tube.near(table).all() == (tube.part == 0)


def test_the_question_is_the_same_for_all_chunks_and_knows_where_the_law_holds(scene):
    assert scene.piece(0).question is scene.piece(1).question is scene.question
    assert scene.question.law_limit <= 1e-4
    np.testing.assert_array_equal(scene.question.tested, scene.deltas <= scene.question.law_limit)
