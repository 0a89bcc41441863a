"""Scene race-angles: the race angle tends to +-kappa pi, and nothing guesses where it does not know."""

import itertools

import numpy as np
import pytest
from conftest import BODIES, computed

import explorer as ex
from explorer.runs import store
from explorer.runs.run import add_up
from explorer.scenes.registry import build_scene


def summary_of(name, **options):
    scene = build_scene(name, **options)
    return scene, scene.summarise(computed(scene))


@pytest.mark.parametrize("disk", ["uniform", "hoop", "matching"])
def test_race_angles_pile_up_at_kappa_pi(disk):
    """Prop. 2 at |eta_hat| about 1e-6: the mean within 1e-3 of +-kappa pi, and no race the wrong way."""
    _, found = summary_of("race-angles", disk=disk, samples=4000, eta_hat="1e-6:1.1e-6")
    limit = BODIES[disk].race_limit
    assert found["limit"] == limit
    for name, sign in (("plus", 1), ("minus", -1)):
        assert abs(found[f"mean_{name}"] - sign * limit) < 1e-3
        assert abs(found[f"median_{name}"] - sign * limit) < 1e-4
        assert found[f"width_{name}"] < 1e-4
    assert found["wrong_way"] == 0
    assert found["failures"] == {}


def test_a_hundred_thousand_races_over_eight_decades_go_no_wrong_way():
    """Every one is right or says that it does not know."""
    scene, found = summary_of("race-angles", samples=100_000, eta_hat="1e-10:1e-2", accuracy=1e-3)
    assert found["wrong_way"] == 0
    assert found["status"]["ok"] + found["failures"].get("unresolved_side", 0) == 100_000
    assert found["status"]["ok"] > 95_000
    counts = found["histogram"]
    assert sum(counts["counts_plus"]) + counts["outside_plus"] == pytest.approx(50_000, rel=0.05)
    deviations = [row["median_deviation"] for row in found["by_decade"]]
    assert all(a < b for a, b in itertools.pairwise(deviations[3:]))
    assert found["energy_range"][1] > 3 * found["energy_range"][0]
    assert scene.headline(found)[-1].startswith("wrong way: 0")


@pytest.mark.parametrize("method", ["rk4", "dopri5"])
def test_no_method_guesses_below_its_resolution(method):
    _, found = summary_of("race-angles", samples=3000, eta_hat="1e-15:1e-5", accuracy=1e-2, method=method, seed=4)
    assert found["wrong_way"] == 0
    assert found["failures"]["unresolved_side"] > 100
    assert found["status"]["ok"] > 100


def test_races_that_nothing_resolves_are_an_error_in_words():
    scene = build_scene("race-angles", samples=100, eta_hat="1e-20:1e-19", method="dopri5")
    with pytest.raises(ex.RunError, match="none of 100 passages was resolved"):
        scene.summarise(computed(scene))


def test_the_race_angle_follows_its_law():
    """Delta chi - fall angle - kappa pi = 2 m g r eta ln(1/|eta|) / (I1 M A^3) + O(eta)."""
    disk = BODIES["hoop"]
    scene = build_scene(
        "race-angles", disk="hoop", samples=2000, box="phidot=1,sigma3=1", eta_hat="1e-6:1e-4", accuracy=1e-9
    )
    table = scene.compute(0)
    eta = table["eta_hat"] * disk.body.I3 * disk.body.r0
    A = table["impact_speed"]
    rest = table["race_angle"] - np.sign(eta) * disk.race_limit
    law = 2.0 * eta * np.log(1 / abs(eta)) / (disk.body.I1 * disk.body.M * A**3)
    coefficient, constant = np.linalg.lstsq(np.column_stack([law, eta]), rest, rcond=None)[0]
    assert coefficient == pytest.approx(1.0, abs=0.02)
    assert abs(constant) < 20


def test_every_chunk_footer_is_read_once_for_summary_and_pictures(tmp_path, monkeypatch):
    run = ex.run("race-angles", out=tmp_path / "run", samples=5000, chunk_size=700)
    read, read_note = [], store.read_note

    def counted(path):
        read.append(path)
        return read_note(path)

    monkeypatch.setattr(store, "read_note", counted)
    total, digest = add_up(run.folder, run.scene)
    summary = run.scene.summarise(total)
    assert len(list(run.scene.figures(summary, total))) == 2
    assert sorted(read) == sorted(store.found_chunks(run.folder).values())
    assert digest == run.summary["digest"]
    assert summary["histogram"] == run.summary["histogram"]
