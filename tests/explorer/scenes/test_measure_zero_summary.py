"""What scene measure-zero makes of its sums."""

import numpy as np
import pytest
from conftest import computed

from explorer.scenes.measure_zero_summary import Counted, Tubes
from explorer.scenes.registry import build_scene


@pytest.fixture(scope="module")
def scene():
    return build_scene("measure-zero", samples=5000, tube=40_000, ladder="1e-6:1e-1")


@pytest.fixture(scope="module")
def total(scene):
    return computed(scene)


def test_sums_are_arrays_over_rungs_faces_and_batches_and_of_all_draws(scene, total):
    assert isinstance(total, Counted)
    assert total.tubes.sum.shape == (scene.deltas.size, 2, 3)
    assert total.tubes.draws.sum() == 2 * scene.deltas.size * 40_000
    assert total.below.shape == (scene.deltas.size, 4)
    assert total.tubes.first(1).sum.shape == (scene.deltas.size, 2, 1)


def test_the_error_of_equal_batches_is_that_of_their_spread_or_of_the_draws():
    columns = {name: np.ones((1, 2, 4)) for name in Tubes.__annotations__ if name != "by_batches"}
    columns["draws"] = np.full((1, 2, 4), 100.0)
    columns["sum"] = np.array([[[1.0, 2.0, 3.0, 4.0]] * 2])
    columns["squares"] = columns["sum"]
    independent, scrambled = (Tubes(by_batches, **columns).estimate(0, 0) for by_batches in (False, True))
    assert independent.value == scrambled.value == pytest.approx(0.025)
    assert independent.error == pytest.approx(np.sqrt((0.025 - 0.025**2) / 399))
    assert scrambled.error == pytest.approx(np.std([0.01, 0.02, 0.03, 0.04], ddof=1) / 2)
    assert (independent.dof, scrambled.dof) == (399, 3)


def test_too_few_hits_are_counted_and_not_fitted(scene):
    few = build_scene("measure-zero", samples=5000, tube=16, ladder="1e-6:1e-1")
    found = few.summarise(computed(few))
    assert found["slope"] is None is found["constant"]
    assert found["ladder"][0]["effective_sample_size"] < 50
    lines = few.headline(found)
    assert lines[-1].startswith("C was not estimated: one rung has an effective sample size of ")
    assert lines[-1].endswith("Raise --tube, or narrow --box to where the density is.")
