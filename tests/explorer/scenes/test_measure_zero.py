"""Scene measure-zero: the law P(theta_min < delta) = C delta, its constant, and what is refused."""

import functools
import json
import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import computed
from scipy.stats import norm

import explorer as ex
from explorer.phase.constants import constants
from explorer.phase.states import COORDINATES, phi_to_states
from explorer.scenes import measure_zero
from explorer.scenes.measure_zero import MeasureZero
from explorer.scenes.scene import scene_of

pytestmark = pytest.mark.long
FEW = {"samples": 5000, "tube": 512, "ladder": "1e-6:1e-1", "keep": "all"}


def bell(mean, deviation, low=-2.0, high=2.0):
    """A normal law, cut off at the ends of a box."""
    return f"truncnorm:{(low - mean) / deviation}:{(high - mean) / deviation}:{mean}:{deviation}"


def summary_of(**options):
    scene = MeasureZero(**options)
    return scene.summarise(computed(scene))


@pytest.fixture(scope="module", autouse=True)
def computed_once():
    """Scenes share the constant, which depends on the disk and the density alone."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(measure_zero, "constant_of", functools.cache(measure_zero.constant_of))
        yield


@pytest.fixture(scope="module")
def uniform():
    return summary_of(samples=40_000, tube=2048)


@pytest.fixture(scope="module")
def few():
    return MeasureZero(**FEW)


@pytest.mark.parametrize(
    ("disk", "options"),
    [
        ("uniform", {}),
        ("hoop", {}),
        ("matching", {}),
        ("hoop", {"box": "phi=-1:1"}),
        ("uniform", {"box": "phi=-1.5:1.5", "energy": ":3"}),
        ("hoop", {"box": "phi=-0.5:1,sigma4=0.3"}),
        ("matching", {"box": f"phi=0.2,sigma3=norm:0:0.7,phidot={bell(0.5, 0.4)}"}),
    ],
)
def test_slope_and_constant_are_those_of_codimension_one(disk, options):
    """Every estimate within 4 standard errors, and errors as small as the draws allow."""
    found = summary_of(disk=disk, samples=4096, tube=2048, **options)
    assert found["falls"] == 0
    followed = sum(count for name, count in found["status"].items() if name != "not followed")
    assert found["status"]["ok"] == followed
    slope, constant = found["slope"], found["constant"]
    assert abs(slope["value"] - 1.0) < 4.0 * slope["error"] < 0.01
    assert abs(constant["value"] - found["constant_predicted"]) < 4.0 * constant["error"]
    assert constant["error"] < 0.01 * constant["value"]
    assert found["p_value"]["law"] > 1e-4
    assert found["p_value"]["dimension_two"] < 0.05
    assert found["p_value_tubes"]["plateau"] == 0.0
    assert found["p_value"]["plateau"] == found["p_value_counts"]["plateau"]
    assert found["p_value_counts_against_tubes"] > 1e-4


def test_plain_counts_and_tubes_agree_where_both_have_hits(uniform):
    """Independent of the law: delta = 0.1 and 0.01, where it is off by 10 % and 1 %."""
    for row in uniform["ladder"][:3]:
        low, high = row["plain"]["interval_95"]
        spread = 0.5 * (high - low)
        assert abs(row["plain"]["value"] - row["estimate"]) < 1.6 * spread
    assert uniform["ladder"][0]["estimate"] < 0.95 * uniform["ladder"][0]["predicted"]
    assert uniform["upper_bound_95"] == pytest.approx(1.0 - 0.05 ** (1.0 / 40_000), rel=1e-9)


def test_the_correction_to_the_law_shrinks_like_delta():
    """P/(C delta) - 1 at delta = 0.3 and 0.03 differ by about ten."""
    found = summary_of(samples=4096, tube=1 << 16, ladder="3e-7:3e-1")
    corrections = [row["estimate"] / row["predicted"] - 1.0 for row in found["ladder"]]
    assert corrections[0] < -0.1
    assert 0.08 < corrections[1] / corrections[0] < 0.16
    assert abs(corrections[2]) < 5e-3


def test_the_law_is_tested_where_its_next_term_is_small_and_where_that_is_does_not_depend_on_the_seed():
    found = [summary_of(samples=4096, tube=2048, box="sigma3=-1e-3:1e-3", seed=seed) for seed in (0, 1)]
    wide = summary_of(samples=4096, tube=2048)
    assert found[0]["law_limit"] == found[1]["law_limit"] < 0.1 * wide["law_limit"]
    for summary in (*found, wide):
        assert abs(summary["constant"]["value"] - summary["constant_predicted"]) < 4 * summary["constant"]["error"]


def test_a_ladder_above_the_law_is_counted_and_not_fitted_and_says_how_low_it_must_go():
    scene = MeasureZero(samples=2000, tube=1024, ladder="1e-4:1e-1")
    found = scene.summarise(computed(scene))
    assert found["slope"] is None is found["constant"]
    assert "the law holds at or below 1e-04" in scene.headline(found)[-1]


def test_plain_draws_come_last_so_that_a_longer_run_keeps_all_chunks(few):
    longer = replace(few, samples=500_000)
    tubes = few.chunks - 1
    assert few.deltas.tolist() == [0.1, 0.01, 1e-3, 1e-4, 1e-5, 1e-6]
    assert tubes == 12
    assert [few.length(index) for index in range(13)] == [512] * 12 + [5000]
    for index in (0, tubes - 1):
        for name, values in few.chunk(index)[0].items():
            np.testing.assert_array_equal(values, longer.chunk(index)[0][name])


def test_estimates_are_means_of_the_stored_weights(few):
    tables = [few.chunk(index)[0] for index in range(few.chunks)]
    assert all(tuple(table) == few.columns for table in tables)
    rung = [table for table in tables if table["delta"][0] == 1e-4]
    again = sum(float((table["weight"] * (table["theta_min"] < 1e-4)).mean()) for table in rung)
    row = next(row for row in few.summarise(computed(few))["ladder"] if row["delta"] == 1e-4)
    assert again == pytest.approx(row["estimate"], rel=1e-12)
    assert row["effective_sample_size"] > 300


def test_rows_that_are_kept_are_plain_draws_below_the_first_rung(few):
    near = replace(few, keep="near")
    assert near.chunk(0)[0]["status"].size == 0
    plain, tally = near.chunk(near.chunks - 1)
    assert plain["theta_min"].size == tally.below.counts[:-1].sum() > 0
    assert plain["theta_min"].max() < 0.1
    assert replace(near, keep="none").chunk(0)[0]["status"].size == 0


def test_a_plain_draw_that_is_not_followed_could_not_come_flatter_than_the_first_rung(few):
    table, tally = few.chunk(few.chunks - 1)
    followed = phi_to_states(few.disk, **{name: table[name] for name in COORDINATES})
    nearer = np.fmin(*(abs(getattr(constants(followed), name)) for name in ("eta_hat_plus", "eta_hat_minus")))
    np.testing.assert_allclose(nearer, abs(table["eta_hat"]), rtol=1e-9, atol=1e-14)
    assert tally.status["not followed"] == 5000 - table["status"].size > 0
    assert sum(tally.status.values()) == 5000


def test_runs_with_other_seeds_add_up(few):
    other = replace(few, seed=1, keep="none")
    found = ex.merge(*(ex.run(**each.options, progress=False) for each in (few, other))).summary
    assert found["samples"] == 10_000
    alone = [scene.summarise(computed(scene))["ladder"] for scene in (few, other)]
    for both, one, two in zip(found["ladder"], *alone, strict=True):
        assert both["count"] == one["count"] + two["count"]
        assert both["estimate"] == pytest.approx(0.5 * (one["estimate"] + two["estimate"]))


def test_too_few_hits_are_counted_and_not_fitted():
    scene = MeasureZero(samples=5000, tube=16, ladder="1e-6:1e-1")
    found = scene.summarise(computed(scene))
    assert found["slope"] is None is found["constant"]
    assert found["ladder"][0]["effective_sample_size"] < 100
    lines = scene.headline(found)
    assert lines[-1].startswith("C was not estimated: at one delta the effective sample size is ")
    assert lines[-1].endswith("Raise tube, or narrow box to where the density is.")


def test_a_box_that_misses_the_falling_set_says_so():
    scene = MeasureZero(samples=1000, tube=512, box="sigma3=1:2,sigma4=-0.1:0.1")
    found = scene.summarise(computed(scene))
    assert found["constant_predicted"] == 0.0
    assert found["constant"] is None is found["slope"]
    assert "misses the falling set: C = 0" in scene.headline(found)[-1]
    assert all(row["estimate"] == 0.0 for row in found["ladder"][2:])


def test_a_density_given_in_python_is_sampled_and_identified():
    def near_zero(phi, phidot, sigma3, sigma4):
        return np.exp(-(sigma3**2) - sigma4**2)

    options = {"samples": 20_000, "tube": 1024, "ladder": "1e-8:1e-1"}
    scene = MeasureZero(density=near_zero, **options)
    found = scene.summarise(computed(scene))
    plain, tube = (found["ladder"][0][key] for key in ("plain", "estimate"))
    assert plain["interval_95"][0] * 0.97 < tube < plain["interval_95"][1] * 1.03
    assert abs(found["constant"]["value"] - found["constant_predicted"]) < 4 * found["constant"]["error"]
    assert MeasureZero(density=near_zero, **options).options == scene.options
    assert MeasureZero(density=lambda phi, *_: 1.0 + phi**2, **options).options != scene.options
    with pytest.raises(ex.InputError, match="given in Python"):
        scene_of(json.loads(json.dumps(scene.options)))


def test_options_come_back_from_json():
    options = {"energy": "1.2:4", "box": {"phi": (-1, 1), "sigma3": norm(0.5, 1)}}
    scene = MeasureZero(samples=1000, tube=512, ladder="1e-7:1e-1", **options)
    assert scene_of(json.loads(json.dumps(scene.options))) == scene


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"ladder": "1e-3:2"}, "ladder"),
        ({"ladder": "1e-1:1e-15"}, "LOW:HIGH"),
        ({"box": "phidot=norm:1e9:1"}, "rates beyond"),
        ({"energy": ":0.5"}, "energy: only 0 of"),
        ({"box": "sigma3=1e300:2e300"}, "rates beyond"),
        ({"disk": "m=1,r=1,g=1,I1=1,I3=1e-6"}, "too steep"),
        ({"density": lambda phi, *_: np.random.default_rng().random(phi.size)}, "call to call"),
        ({"ladder": (-1.5, 0.3)}, "with 1e-100 <= LOW"),
        ({"tube": 1}, "tube"),
        ({"box": "sigma3=0,sigma4=0"}, "both fixed"),
        ({"box": f"phi=0:{0.5 * math.pi!r}"}, "delta ln"),
        ({"disk": "m=1,r=1,g=1,I1=0.5,I3=0"}, "I3"),
        ({"max_energy": 3}, "takes no such option"),
    ],
)
def test_bad_input_is_named(options, message):
    with pytest.raises(ex.InputError, match=message):
        _ = MeasureZero.of(options).options


@pytest.mark.parametrize("box", ["sigma3=0", "sigma4=0", "phi=0.5,sigma4=0", "phi=-1:1,sigma4=0"])
def test_states_beside_both_lines_count_once(box):
    """Where sigma3_bar = 0 on both lines a state near one is near the other; plain draws know no lines."""
    found = summary_of(box=box, samples=100_000, tube=4096, ladder="1e-6:1e-1")
    assert found["p_value_counts_against_tubes"] > 1e-3
    constant = found["constant"]
    assert abs(constant["value"] - found["constant_predicted"]) < 4 * constant["error"]
    low, high = found["ladder"][1]["plain"]["interval_95"]
    assert 0.97 * low < found["constant_predicted"] * 0.01 < 1.05 * high


@pytest.mark.parametrize(
    "options",
    [
        {"box": "phidot=norm:0.5:1e-5"},
        {"box": "sigma3=norm:0.5:0.02,sigma4=norm:0.364:0.02,phidot=norm:0.5:0.02"},
        {"box": "phi=-1.2:1.2,sigma3=0.79:0.81,sigma4=1.19:1.21"},
        {"box": "phidot=-1:1,sigma3=-1e-3:1e-3,sigma4=-2:2"},
        {"box": "phi=-1:1,sigma4=1e-4"},
        {"box": f"sigma3={bell(6.1, 0.5, -1)}"},
        {"box": f"sigma3={bell(10, 0.5, -1)},sigma4={bell(-30, 3)}"},
    ],
    ids=["fast", "bells", "narrow", "thin", "beside both", "tail", "tails"],
)
def test_narrow_densities_are_drawn_where_they_are(options):
    found = summary_of(samples=4096, tube=4096, ladder="1e-12:1e-2", **options)
    constant = found["constant"]
    assert min(row["effective_sample_size"] for row in found["ladder"]) > 100
    assert abs(constant["value"] - found["constant_predicted"]) < 4 * constant["error"]
    assert abs(found["slope"]["value"] - 1.0) < 4 * found["slope"]["error"]
