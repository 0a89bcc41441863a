"""Scene falling-set: shares, valleys on the exact curve, what is kept and what is counted."""

import numpy as np
import pytest
from conftest import BODIES, computed

import explorer as ex
from explorer.measure.sampling import chunk_stream
from explorer.phase.constants import constants_of
from explorer.phase.states import phi_to_states
from explorer.portrait.slices import Slice, slice_map
from explorer.scenes import falling_set
from explorer.scenes.registry import build_scene


def summary_of(**options):
    scene = build_scene("falling-set", **options)
    return scene, scene.summarise(computed(scene))


def test_the_falling_set_summary_adds_up():
    _, found = summary_of(samples=20_000, box="phi=-1:1")
    assert sum(found["face_counts"].values()) == found["samples"] == 20_000
    assert sum(found["status"].values()) == 20_000
    low, high = found["could_fall_interval_95"]
    assert 0 < low < found["could_fall_fraction"] < high < 1
    assert found["falls"] == 0
    assert found["status"]["ok"] > 19_900


def test_the_share_of_nearly_flat_motions_is_proportional_to_the_tilt():
    """P(theta_min < delta) = C delta with C = 1.46927 for this box (mathematics, section 4)."""
    _, found = summary_of(samples=300_000)
    assert found["theta_min_quantiles"]["0.01"] == pytest.approx(0.01 / 1.46927, rel=0.05)


def test_the_integrated_valley_lies_on_the_exact_curve():
    """On a slice at the vertical and on a curved one: theta_min is smallest where eta changes sign."""
    disk = BODIES["uniform"]
    for text in ("phi=0,phidot=1,sigma3=0.2:2,sigma4=0:1.6", "phi=0.2:0.9,phidot=0.3,sigma3=0.4,sigma4=0.1:1.2"):
        found = slice_map(disk, Slice.of(text), points=201, method="dopri5")
        inside = 0
        for row, column in enumerate(np.argmin(found["theta_min"], axis=1)):
            if found["theta_min"][row, column] > 0.02 or not 2 < column < 198:
                continue
            around = found.falls.distance_plus[row, column - 2 : column + 3]
            assert around.min() < 0 < around.max()
            assert found.falls.could_fall_plus[row, column]
            inside += 1
        assert inside > 50


@pytest.mark.parametrize("keep", ["none", "near", "all"])
def test_counts_are_complete_whatever_is_kept(keep, tmp_path):
    options = {"samples": 4000, "grid": 5, "chunk_size": 1500}
    every = ex.run("falling-set", out=tmp_path / "all", keep="all", **options)
    run = ex.run("falling-set", out=tmp_path / "run", keep=keep, **options)
    for key in ("face_counts", "theta_min_quantiles", "distance_quantiles", "status"):
        assert run.summary[key] == every.summary[key]
    rows = sum(len(table["status"]) for table in run.tables())
    near = sum(int(run.scene.near(0, table).sum()) for table in every.tables())
    assert rows == {"none": 0, "near": near, "all": 4000}[keep]
    assert near > 0


def test_beyond_ten_million_states_theta_min_is_computed_near_f_only(tmp_path, monkeypatch):
    options = {"samples": 4000, "grid": 5, "keep": "all"}
    every = ex.run("falling-set", out=tmp_path / "all", **options)
    monkeypatch.setattr(falling_set, "MOST_THETA_MIN", 100)
    run = ex.run("falling-set", out=tmp_path / "run", **options)
    for whole, part in zip(every.tables(), run.tables(), strict=True):
        near = run.scene.near(0, whole)
        np.testing.assert_array_equal(part["theta_min"][near], whole["theta_min"][near])
        assert np.isnan(part["theta_min"][~near]).all()
        assert near.any()
    assert run.summary["face_counts"] == every.summary["face_counts"]
    sifted = ex.run("falling-set", out=tmp_path / "near", **{**options, "keep": "near"})
    for key in ("face_counts", "could_fall_fraction", "distance_quantiles", "theta_min_quantiles", "status"):
        assert sifted.summary[key] == run.summary[key]
    for part, table in zip(sifted.tables(), run.tables(), strict=True):
        near = run.scene.near(0, table)
        for name, values in part.items():
            np.testing.assert_array_equal(values, table[name][near])


def test_an_energy_cut_changes_which_states_are_drawn_and_nothing_else():
    """The kept states are the first of the box's own draws that lie below the energy."""
    scene = build_scene("falling-set", samples=3000, box="phi=-1:1", energy=":2", keep="all", seed=3)
    table = scene.compute(0)
    assert (table["energy"] <= 2.0).all()
    drawn = scene.box.draw(chunk_stream(3, 0), 8192)
    energy = constants_of(phi_to_states(scene.disk, **drawn)).energy
    np.testing.assert_array_equal(table["phi"][:100], drawn["phi"][energy <= 2.0][:100])
    assert (energy > 2.0).any()


def test_which_theta_min_is_computed_may_be_asked_for(tmp_path):
    near = build_scene("falling-set", samples=2000, theta_min="near", keep="all").compute(0)
    every = build_scene("falling-set", samples=2000, keep="all").compute(0)
    assert np.isnan(near["theta_min"]).mean() > 0.9
    known = np.isfinite(near["theta_min"])
    np.testing.assert_array_equal(near["theta_min"][known], every["theta_min"][known])
    many = build_scene("falling-set", samples=20_000_000)
    assert (many.theta_min, many.chunk_size) == ("near", 1 << 20)


def test_the_headline_is_in_sentences_a_user_can_read():
    scene, found = summary_of(samples=2000)
    share = scene.headline(found)[1]
    assert share.startswith(
        f"would fall if eta were exactly 0: {100 * found['could_fall_fraction']:.1f} % (95 % interval "
    )


@pytest.mark.parametrize(
    ("which", "says"),
    [("all", "of the 2,000 states: median"), ("near", "states with |eta_hat| <= 0.001, the only")],
)
def test_a_median_says_of_which_states(which, says):
    scene, found = summary_of(samples=2000, theta_min=which)
    assert says in scene.headline(found)[-1]
