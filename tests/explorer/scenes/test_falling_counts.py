"""Counts of scene falling-set add up over blocks as over all states at once."""

import json

import numpy as np

from explorer.scenes.base import joined
from explorer.scenes.falling_counts import NO_CODE, FallingCounts, count_faces, nearer, no_cells
from explorer.scenes.registry import build_scene


def test_counts_of_two_blocks_are_those_of_both_together():
    scene = build_scene("falling-set", samples=4000, keep="all", chunk_size=4000)
    table = scene.compute(0)
    halves = [
        {name: values[part] for name, values in table.items()} for part in (slice(0, 1500), slice(1500, None))
    ]
    total = FallingCounts()
    for half in halves:
        total.add(FallingCounts.of(json.loads(json.dumps(scene.tally(0, half)))))
    assert total.tally() == scene.tally(0, table)
    for name, values in joined(halves).items():
        np.testing.assert_array_equal(values, table[name])


def test_nan_is_on_neither_face():
    eta = np.array([1.0, -1.0, 0.0, np.nan])
    counts = count_faces(np.array([True, False, True, True]), eta)
    assert sum(counts.values()) == 3
    assert (
        counts["face_plus_eta_positive"] == counts["face_minus_eta_negative"] == counts["face_plus_eta_zero"] == 1
    )


def test_the_nearer_face_decides_the_distance():
    table = {"eta_hat_plus": np.array([-1e-3, 2.0]), "eta_hat_minus": np.array([5.0, -1.0])}
    np.testing.assert_array_equal(nearer(table), [1e-3, 1.0])


def test_an_empty_map_has_no_code():
    assert (no_cells() == NO_CODE).all()
