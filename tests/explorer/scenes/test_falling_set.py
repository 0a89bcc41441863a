"""Scene falling-set: shares, valleys on the exact curve, what is kept and what is counted."""

import pkgutil
from importlib import import_module

import numpy as np
import pytest
from conftest import BODIES, computed

import explorer as ex
from explorer import compiled
from explorer.measure.slices import Slice, slice_map
from explorer.scenes import falling_set
from explorer.scenes.falling_set import FallingSet


def summary_of(**options):
    scene = FallingSet(**options)
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
        found = slice_map(disk, Slice.read(text), points=101, method="dopri5")
        inside = 0
        for row, column in enumerate(np.argmin(found["theta_min"], axis=1)):
            if found["theta_min"][row, column] > 0.02 or not 2 < column < 98:
                continue
            around = found.falls.distance_plus[row, column - 2 : column + 3]
            assert around.min() < 0 < around.max()
            assert found.falls.could_fall_plus[row, column]
            inside += 1
        assert inside > 25


@pytest.mark.parametrize("theta_min", ["all", "near"])
def test_counts_are_complete_whatever_is_kept(theta_min):
    """Also where rows are followed near F only: what is kept are the rows near F of all."""
    scenes = {
        keep: FallingSet(samples=150_000, chunk_size=65_536, theta_min=theta_min, keep=keep)
        for keep in ("none", "near", "all")
    }
    summaries = {keep: scene.summarise(computed(scene)) for keep, scene in scenes.items()}
    for key in ("face_counts", "could_fall_fraction", "theta_min_quantiles", "status"):
        assert summaries["none"][key] == summaries["near"][key] == summaries["all"][key]
    distances = [list(found["distance_quantiles"].values()) for found in summaries.values()]
    for found in distances[1:]:
        np.testing.assert_allclose(found, distances[0], rtol=1e-9)
    for index in range(3):
        every = scenes["all"].chunk(index)[0]
        near = scenes["all"].near(every)
        assert 0 < near.sum() < near.size == scenes["all"].length(index)
        assert scenes["none"].chunk(index)[0]["status"].size == 0
        for name, values in scenes["near"].chunk(index)[0].items():
            np.testing.assert_array_equal(values, every[name][near])


def test_theta_min_may_be_computed_near_f_only_as_it_is_of_many_states():
    near, every = (FallingSet(samples=2000, theta_min=which, keep="all").chunk(0)[0] for which in ("near", "all"))
    known = np.isfinite(near["theta_min"])
    assert 0.0 < known.mean() < 0.1
    np.testing.assert_array_equal(near["theta_min"][known], every["theta_min"][known])
    few, many = FallingSet(samples=10_000_000), FallingSet(samples=10_000_001)
    assert (few.theta_min, few.chunk_size) == ("all", 1 << 16)
    assert (many.theta_min, many.chunk_size) == ("near", 1 << 20)


def test_the_nearer_face_decides_and_what_is_no_state_has_none():
    table = {"sigma3_bar": [0.5, 0.5, 0.0, np.nan], "eta_hat": [1e-3, -1e-3, 0.0, 1.0], "face": [1, -1, 1, 1]}
    scene = FallingSet(states=table | {"phi": [0.0] * 4, "phidot": [1.0, 1.0, 0.0, 1.0]}, keep="all")
    rows, tally = scene.chunk(0)
    assert {name: count for name, count in tally.faces.items() if count} == {
        "face_plus_eta_positive": 1,
        "face_minus_eta_negative": 1,
        "face_plus_eta_zero": 1,
    }
    assert rows["could_fall"].tolist() == [True, True, False, False]
    distance = tally.distance.row()
    assert (distance.total, distance.zeros) == (2, 0)
    assert distance.smallest == distance.largest == 1e-3


def test_the_headline_is_in_sentences_a_user_can_read(tmp_path):
    scene, found = summary_of(samples=2000)
    share = "would fall if eta, their distance from the falling set, were exactly 0: "
    share += f"{found['could_fall_fraction']:.1%} (95 % interval "
    assert scene.headline(found)[1].startswith(share)
    assert "of all samples, each at its flattest moment: median" in scene.headline(found)[2]
    scene, found = summary_of(samples=2000, theta_min="near")
    assert "of samples with |eta_hat| <= 0.001, each at its flattest moment: median" in scene.headline(found)[2]
    (tmp_path / "states.csv").write_text("phi,phidot,sigma3,sigma4\n0.1,1,1,0.5\n,1,1,2\n0.2,1,1,1\n")
    run = ex.run("falling-set", states=tmp_path / "states.csv")
    for text in ("were exactly 0: 100.0%", "2 of 3 samples are states", "2 ok", "1 bad_input"):
        assert text in repr(run)
    assert run.figure("theta-min").axes[0].lines[0].get_ydata()[-1] == 1.0


def test_figures_are_of_all_samples_and_of_every_slice():
    cuts = ["phi=0,phidot=1,sigma3=-2:2,sigma4=-2:2"] * 3
    scene = FallingSet(samples=500, slice=cuts, grid=5)
    tally = computed(scene)
    names = [name for name, _ in scene.figures(scene.summarise(tally), tally)]
    assert names == ["constants-plane", "slice-1", "slice-2", "slice-3", "theta-min"]
    assert np.nanmin(scene.plane(tally.plane).smallest) == pytest.approx(tally.theta_min.quantile(0.0), rel=1e-3)


def test_each_cell_of_the_plane_of_constants_has_its_flattest_motion():
    """One state at a time, also of given states; tilts by integration, where the plane has them by quadrature."""
    states = ex.phi_to_states(BODIES["uniform"], 0.0, *np.random.default_rng(4).uniform(-1.0, 1.0, (3, 60)))
    scene = FallingSet(states=states)
    plane = scene.plane(computed(scene).plane)
    wanted = np.full(plane.smallest.shape, np.inf)
    found = ex.constants(states)
    columns = np.searchsorted(plane.sigma3_edges, found.sigma3_bar) - 1
    rows = np.searchsorted(plane.sigma4_edges, found.sigma4_bar) - 1
    for i, j, tilt in zip(rows, columns, ex.periods(states, method="rk8").theta_min, strict=True):
        if 0 <= i < wanted.shape[0] and 0 <= j < wanted.shape[1]:
            wanted[i, j] = min(wanted[i, j], tilt)
    assert np.isfinite(wanted).sum() > 30
    np.testing.assert_allclose(plane.smallest, np.where(np.isinf(wanted), np.nan, wanted), rtol=1e-3)


def test_without_theta_min_no_motion_is_followed(monkeypatch):
    """No integrator and no quadrature is called, and all that does not need them is counted the same."""

    def forbidden(*_):
        raise AssertionError("a motion was followed")

    _, some = summary_of(samples=3000, theta_min="near")
    monkeypatch.setattr(falling_set, "smallest_tilt", forbidden)
    for room in ("steps", "near_flat", "arcs"):
        for module in pkgutil.iter_modules(import_module(f"kernels.{room}").__path__):
            monkeypatch.setattr(compiled, module.name, None, raising=False)
    scene, found = summary_of(samples=3000, theta_min="none")
    assert (found["theta_min_of"], found["theta_min_known"]) == ("no samples", 0)
    for key in ("face_counts", "could_fall_fraction", "distance_quantiles", "valid_states"):
        assert found[key] == some[key]
    assert not [name for name in scene.kernels if name.startswith(("batch.", "turning_points."))]
    assert FallingSet(samples=500, theta_min="none", keep="all").chunk(0)[0]["phi"].size == 500


def test_a_run_of_states_in_degrees_is_the_same_when_it_is_read_again(tmp_path):
    (tmp_path / "states.csv").write_text("tilt,tilt_rate,precession,spin\n10,-30,100,60\n70,10,50,30\n")
    about = {"states": tmp_path / "states.csv", "degrees": True, "slice": "tilt=10:80,precession=-90:90,spin=30"}
    run = ex.run("falling-set", out=tmp_path / "run", grid=5, figures=False, progress=False, **about)
    assert run.scene.slice[0].coordinates["tilt"].ends == pytest.approx(np.radians([10.0, 80.0]).tolist())
    assert run.options["slices"][0]["tilt"] == [10.0, 80.0]
    again = ex.open(run.folder)
    assert again.options == run.options
    assert again.verify() == []
    assert ex.run(**run.options, progress=False).summary == run.summary == again.resume(progress=False).summary
