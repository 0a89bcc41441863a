"""Scene measure-zero: the law P(theta_min < delta) = C delta, its constant, and what is refused."""

import functools
import itertools
import math

import numpy as np
import pytest
from conftest import computed

import explorer as ex
from explorer.errors import Interrupted
from explorer.scenes import measure_zero_draws, measure_zero_summary
from explorer.scenes.registry import build_scene

pytestmark = pytest.mark.long
SMALL = {"samples": 40_000, "tube": 2048}


def summary_of(**options):
    scene = build_scene("measure-zero", **options)
    return scene, scene.summarise(computed(scene))


@pytest.fixture(scope="module", autouse=True)
def computed_once():
    """Scenes share what does not depend on their draws.

    States pushed forward depend on the disk and the seed alone, the constant on the disk and the density.
    """
    with pytest.MonkeyPatch.context() as patch:
        for home, name in ((measure_zero_summary, "push_forward"), (measure_zero_summary, "weight_on_f"),
                           (measure_zero_draws, "constant_of")):  # fmt: skip
            patch.setattr(home, name, functools.cache(getattr(home, name)))
        yield


@pytest.fixture(scope="module")
def uniform():
    return summary_of(**SMALL)


@pytest.mark.parametrize("disk", ["uniform", "hoop", "matching"])
@pytest.mark.parametrize(
    "options",
    [
        {},
        {"box": "phi=-1:1"},
        {"box": "phi=-1.5:1.5", "energy": ":3"},
        {"box": "phi=-0.5:1,sigma4=0.3"},
        {"box": "phi=0.2", "gaussian": "sigma3=0:0.7,phidot=0.5:0.4"},
        {"sampling": "sobol"},
    ],
    ids=["vertical", "tilted", "energy", "fixed", "gaussian", "sobol"],
)
def test_slope_and_constant_are_those_of_codimension_one(disk, options):
    """Every estimate within 4 standard errors, and errors as small as the draws allow."""
    _, found = summary_of(disk=disk, samples=4096, tube=2048, **options)
    assert found["falls"] == 0
    followed = sum(count for name, count in found["status"].items() if name != "not followed")
    assert found["status"]["ok"] == followed
    slope, constant = found["slope"], found["constant"]
    assert abs(slope["value"] - 1.0) < 4.0 * slope["error"] < 0.01
    assert abs(constant["value"] - found["constant_predicted"]) < 4.0 * constant["error"]
    assert constant["error"] < 0.01 * constant["value"]
    assert found["p_value"]["law"] > 1e-4
    rungs = sum(row["delta"] <= found["law_limit"] for row in found["ladder"])
    for name in ("dimension_two", "constant_off"):
        if 2 * 2048 * rungs > 2 * found["power"][name]["tube_draws"]:
            assert found["p_value"][name] < 0.05
    assert found["p_value_tubes"]["plateau"] == 0.0
    assert found["p_value"]["plateau"] == found["p_value_counts"]["plateau"]
    assert found["p_value_counts_against_tubes"] > 1e-4
    assert found["race"]["wrong"] == 0 < found["race"]["right"]


def test_plain_counts_and_tubes_agree_where_both_have_hits(uniform):
    """Independent of the law: delta = 0.1 and 0.01, where it is off by 10 % and 1 %."""
    _, found = uniform
    for row in found["ladder"][:3]:
        low, high = row["plain"]["interval_95"]
        spread = 0.5 * (high - low)
        assert abs(row["plain"]["value"] - row["estimate"]) < 1.6 * spread
    assert found["ladder"][0]["estimate"] < 0.95 * found["ladder"][0]["predicted"]


def test_no_falls_are_bounded_exactly(uniform):
    _, found = uniform
    assert found["falls"] == 0
    assert found["upper_bound_95"] == pytest.approx(1.0 - 0.05 ** (1.0 / 40_000), rel=1e-9)


def test_probability_splits_as_predicted(uniform):
    _, found = uniform
    face = found["splits"]["face_plus"]
    assert abs(face["value"] - face["predicted"]) < 4.0 * face["error"]
    shares = found["splits"]["energy"]
    assert sum(row["share"] for row in shares) == pytest.approx(1.0)
    assert sum(row["predicted"] for row in shares) == pytest.approx(1.0)
    for row in shares:
        assert abs(row["share"] - row["predicted"]) < 4.5 * row["error"]
    assert found["splits"]["tilt"]["p_value"] > 1e-3
    for row in found["splits"]["eta_positive"][3:]:
        assert abs(row["asymmetry"]) < 0.2


def test_the_correction_to_the_law_shrinks_like_delta():
    """P/(C delta) - 1 at delta = 0.1 and 0.01 differ by about ten; Sobol points see it."""
    _, found = summary_of(samples=4096, tube=1 << 14, sampling="sobol", ladder="1e-6:1e-1")
    corrections = [row["correction"] for row in found["splits"]["eta_positive"]]
    assert corrections[0] < -0.05
    assert 0.04 < corrections[1] / corrections[0] < 0.2
    assert abs(corrections[3]) < 1e-3
    assert found["sobol_gain"] > 3.0


def test_numbers_do_not_depend_on_jobs(tmp_path):
    options = {"samples": 20_000, "tube": 2048, "ladder": "1e-5:1e-1", "figures": False}
    found = [ex.run("measure-zero", out=tmp_path / str(jobs), jobs=jobs, **options) for jobs in (1, 3)]
    assert found[0].summary == found[1].summary
    tables = [list(run.tables()) for run in found]
    for one, other in zip(*tables, strict=True):
        for name in one:
            np.testing.assert_array_equal(one[name], other[name])


@pytest.mark.rendered
def test_weights_are_stored_with_the_samples(tmp_path):
    run = ex.run("measure-zero", out=tmp_path / "all", samples=1000, tube=512, keep="all")
    rows = list(run.tables())
    tube = [table for table in rows if table["delta"].size and np.isfinite(table["delta"][0])]
    at = [table for table in tube if table["delta"][0] == 1e-9]
    again = sum(float((t["weight"] * (t["theta_min"] < 1e-9)).mean()) for t in at)
    row = next(row for row in run.summary["ladder"] if row["delta"] == 1e-9)
    assert again == pytest.approx(row["estimate"], rel=1e-12)
    assert row["effective_sample_size"] > 300
    assert {path.stem for path in (run.folder / "figures").glob("*.png")} == {"ladder", "convergence", "tilt"}


def test_a_box_that_misses_the_falling_set_says_so(tmp_path):
    run = ex.run("measure-zero", out=tmp_path / "none", samples=1000, tube=512, box="sigma3=1:2,sigma4=-0.1:0.1")
    assert run.summary["constant_predicted"] == 0.0
    assert run.summary["constant"] is None is run.summary["slope"]
    assert "misses the falling set: C = 0" in run.scene.headline(run.summary)[-1]
    assert all(row["estimate"] == 0.0 for row in run.summary["ladder"][2:])


def test_a_density_given_in_python_is_sampled_and_identified(tmp_path):
    def near_zero(phi, phidot, sigma3, sigma4):
        return np.exp(-(sigma3**2) - sigma4**2)

    options = {"samples": 20_000, "tube": 1024, "ladder": "1e-8:1e-1", "out": tmp_path / "mine", "figures": False}
    run = ex.run("measure-zero", density=near_zero, **options)
    plain, tube = (run.summary["ladder"][0][key] for key in ("plain", "estimate"))
    assert plain["interval_95"][0] * 0.97 < tube < plain["interval_95"][1] * 1.03
    assert (
        abs(run.summary["constant"]["value"] - run.summary["constant_predicted"])
        < 4 * run.summary["constant"]["error"]
    )
    again = ex.run("measure-zero", density=near_zero, **options)
    assert again.summary == run.summary
    with pytest.raises(ex.InputError):
        ex.run("measure-zero", density=lambda phi, *_: 1.0 + phi**2, **options)
    from explorer.runs.folder import scene_of

    with pytest.raises(ex.InputError, match="given in Python"):
        scene_of(tmp_path / "mine")


def test_a_run_can_be_resumed_from_its_folder(tmp_path, monkeypatch):
    """Also where it was stopped before its first chunk."""
    from explorer.runs import workers
    from explorer.runs.folder import scene_of

    def stopped(*_):
        raise KeyboardInterrupt

    options = {"energy": "1.2:4", "gaussian": "sigma3=0.5:1", "box": "phi=-1:1", "sampling": "sobol"}
    small = {"samples": 1000, "tube": 512, "ladder": "1e-7:1e-1"}
    monkeypatch.setattr(workers, "compute_chunk", stopped)
    with pytest.raises(Interrupted):
        ex.run("measure-zero", out=tmp_path / "run", **small, **options)
    assert scene_of(tmp_path / "run").options() == build_scene("measure-zero", **small, **options).options()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"ladder": "1e-300:1e-1"}, "ladder"),
        ({"ladder": "1e-3:2"}, "ladder"),
        ({"ladder": "1e-1:1e-15"}, "LOW:HIGH"),
        ({"ladder": "1e-4:1e-1"}, "two rungs at or below"),
        ({"ladder": "1e-6:1e-1", "box": "sigma3=-1e-3:1e-3"}, "two rungs at or below 8"),
        ({"gaussian": "sigma3=0:1e-300"}, "is a point"),
        ({"gaussian": ""}, "gaussian"),
        ({"gaussian": "phidot=1e9:1"}, "more than 37 deviations"),
        ({"energy": ":0.5"}, "energy: only 0 of"),
        ({"energy": "nan:3"}, "is not a range"),
        ({"box": "sigma3=1e300:2e300"}, "rates beyond"),
        ({"disk": "m=1,r=1,g=1,I1=1,I3=1e-6"}, "too steep"),
        ({"density": lambda *_: 1.0 + 1.0j}, "real numbers"),
        ({"density": lambda *_: "3"}, "density"),
        ({"density": lambda phi, *_: np.random.default_rng().random(phi.size)}, "call to call"),
        ({"ladder": "nan:1"}, "ladder"),
        ({"ladder": (-1.5, 0.3)}, "within 1e-100:1"),
        ({"tube": 1}, "tube"),
        ({"tube": 20, "sampling": "sobol"}, "16 scrambles"),
        ({"sampling": "halton"}, "sampling"),
        ({"box": "sigma4=2:1"}, "is empty"),
        ({"box": "sigma3=0,sigma4=0"}, "both fixed"),
        ({"box": f"phi=0:{0.5 * math.pi!r}"}, "delta ln"),
        ({"energy": "3:2"}, "is empty"),
        ({"energy": "much"}, "energy"),
        ({"gaussian": "sigma3=0"}, "MEAN:DEVIATION"),
        ({"density": lambda *_: -1.0}, "not negative"),
        ({"density": lambda *_: np.nan}, "is nan"),
        ({"disk": "m=1,r=1,g=1,I1=0.5,I3=0"}, "I3"),
        ({"max_energy": 3}, "takes no such option"),
    ],
)
def test_bad_input_is_named(options, message):
    with pytest.raises(ex.InputError, match=message):
        build_scene("measure-zero", **options).options()


def test_a_longer_run_takes_over_the_chunks_of_a_shorter_one(tmp_path):
    options = {"tube": 2048, "ladder": "1e-5:1e-1", "seed": 3, "figures": False}
    ex.run("measure-zero", out=tmp_path / "run", samples=70_000, **options)
    longer = ex.run("measure-zero", out=tmp_path / "run", samples=200_000, **options)
    fresh = ex.run("measure-zero", out=tmp_path / "fresh", samples=200_000, **options)
    assert longer.summary == fresh.summary


@pytest.mark.parametrize("box", ["sigma3=0", "sigma4=0", "phi=0.5,sigma4=0", "phi=-1:1,sigma4=0"])
def test_states_beside_both_lines_count_once(box):
    """Where sigma3_bar = 0 on both lines a state near one is near the other; plain draws know no lines."""
    _, found = summary_of(box=box, samples=100_000, tube=4096, ladder="1e-6:1e-1")
    assert found["p_value_counts_against_tubes"] > 1e-3
    constant = found["constant"]
    assert abs(constant["value"] - found["constant_predicted"]) < 4 * constant["error"]
    low, high = found["ladder"][1]["plain"]["interval_95"]
    assert 0.97 * low < found["constant_predicted"] * 0.01 < 1.05 * high


@pytest.mark.parametrize(
    "options",
    [
        {"gaussian": "phidot=0.5:1e-5"},
        {"gaussian": "sigma3=0.5:0.02,sigma4=0.364:0.02,phidot=0.5:0.02"},
        {"box": "phi=-1.2:1.2,sigma3=0.79:0.81,sigma4=1.19:1.21"},
        {"box": "phidot=-1:1,sigma3=-1e-3:1e-3,sigma4=-2:2"},
        {"box": "phi=-1:1,sigma4=1e-4"},
        {"box": "sigma3=-1:2", "gaussian": "sigma3=6.1:0.5"},
        {"box": "sigma3=-1:2", "gaussian": "sigma3=10:0.5,sigma4=-30:3"},
    ],
    ids=["fast", "bells", "narrow", "thin", "beside both", "tail", "tails"],
)
def test_narrow_densities_are_drawn_where_they_are(options):
    _, found = summary_of(samples=4096, tube=4096, ladder="1e-12:1e-2", **options)
    constant = found["constant"]
    assert min(row["effective_sample_size"] for row in found["ladder"]) > 100
    assert abs(constant["value"] - found["constant_predicted"]) < 4 * constant["error"]
    assert abs(found["slope"]["value"] - 1.0) < 4 * found["slope"]["error"]


def test_rungs_are_decades(uniform):
    scene, _ = uniform
    assert scene.deltas[0] == 0.1
    assert scene.deltas[-1] == 1e-15
    assert all(a == pytest.approx(10 * b) for a, b in itertools.pairwise(scene.deltas))
