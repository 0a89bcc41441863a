"""The same samples by an integrator and by the exact layer."""

import pytest

from explorer.runs.side_by_side import in_words, side_by_side
from explorer.scenes.scene import scene_class


@pytest.mark.parametrize(("name", "column"), [("falling-set", "theta_min"), ("race-angles", "race_angle")])
def test_what_is_integrated_differs_from_the_exact_layer_by_less_than_the_accuracy_asked(name, column):
    both = side_by_side(scene_class(name).of({"samples": 2000, "method": "rk8", "accuracy": 1e-3}), column, jobs=1)
    assert (both["method"], both["exact_method"]) == ("rk8", "quadrature")
    assert both["compared"] > 1900
    assert 1e-9 < both["percentile_99"] < 1e-3  # nothing compares quadrature with itself
    assert both["percentile_99"] <= both["largest"]
    assert both["seconds"] > 0 < both["exact_seconds"]
    first, second = in_words(both)
    assert first.startswith("2,000 samples integrated with rk8 to 0.001: ")
    assert "; by quadrature: " in first
    assert f"of {column} over {both['compared']:,} samples" in second
