"""The folder of a run: its record is enough to go on, and nothing else is touched."""

import json
import shutil
import sys
from pathlib import Path

import pytest
from coins import SMALL, Coins

import explorer as ex
from explorer import compiled
from explorer.runs.folder import FORMAT, opened, read_record
from explorer.scenes import falling_set
from explorer.scenes import scene as scenes

RACES = {"samples": 300, "seed": 5, "eta_hat": "1e-4:1e-2", "chunk_size": 128, "figures": False}


def rewritten(run, **changes):
    """The run after something in its run.json was changed."""
    path = run.folder / "run.json"
    path.write_text(json.dumps({**json.loads(path.read_text()), **changes}))
    return run


def contents(folder):
    """Every file below a folder with its bytes."""
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_run_json_says_what_was_asked_what_computed_it_and_on_what(finished):
    record = read_record(finished.folder)
    assert record["format"] == FORMAT == 3
    assert ex.run(Coins, **{key: value for key, value in record["options"].items() if key != "scene"}).summary == (
        finished.summary
    )
    assert record["kernels"] == compiled.source_digest()
    assert record["from"] == f"{Path(sys.modules['coins'].__file__).resolve()}:Coins"
    assert len(record["code"]) == 16
    assert (record["backend"], record["chunks_computed"]) == ("threads", 5)
    assert record["started"] < record["finished"]
    assert {"python", "numpy", "nearflat"} < {*record["versions"]}


def test_a_folder_remembers_the_file_of_a_user_s_scene(finished, monkeypatch):
    monkeypatch.setattr(scenes, "_own", {})
    monkeypatch.delitem(sys.modules, "coins")
    finished.chunks[2].content.unlink()
    again = ex.open(finished.folder)
    assert type(again.scene) is not Coins
    assert again.resume(progress=False).summary == finished.summary
    rewritten(again, **{"from": str(finished.folder / "gone.py:Coins")})
    with pytest.raises(ex.InputError, match="the file is gone"):
        ex.open(finished.folder).resume()


def test_a_stored_run_of_scene_portrait_says_what_to_use_instead(finished):
    record = read_record(finished.folder)
    options = {**record["options"], "scene": "portrait"}
    old = ex.open(rewritten(finished, options=options, **{"from": None, "code": None}).folder)
    for ask in (lambda: old.summary, old.frame, lambda: old.resume(progress=False)):
        with pytest.raises(ex.InputError, match="nearflat portrait --only phase"):
            ask()


@pytest.mark.parametrize(
    ("record", "options", "message"),
    [
        ({}, {"seed": 9}, "run with seed = 5, now seed = 9"),
        ({}, {"bias": 0.25}, "run with bias = 0.5, now bias = 0.25"),
        ({}, {"samples": 2000}, "run with samples = 2500, now samples = 2000"),
        ({"kernels": "0" * 64}, {}, "the kernels of nearflat were changed since"),
        ({"code": "1" * 16}, {}, r"coins\.py:Coins was changed since; put that file back"),
    ],
)
def test_a_run_is_not_continued_by_what_would_compute_other_numbers(record, options, message, finished):
    rewritten(finished, **record)
    before = contents(finished.folder)
    with pytest.raises(ex.InputError, match=f"{message}.*replace the run"):
        ex.run(Coins, out=finished.folder, **{**SMALL, **options})
    assert contents(finished.folder) == before
    (what,) = record or [None]
    assert finished.verify() == (
        [f"run.json: {finished.changed()[0]}"]
        + [f"{each.name}: it belongs to another run" for each in finished.chunks]
        if what
        else []
    )


@pytest.mark.parametrize(("chunk_size", "kept"), [(1 << 14, 8), (1 << 16, 2), (1 << 17, 1), (1 << 20, 0)])
def test_samples_may_be_added_and_what_was_drawn_for_fewer_is_computed_anew(chunk_size, kept, tmp_path, capsys):
    """Of 150,000 samples two random streams are used up, and chunks of these stay."""
    how = {"chunk_size": chunk_size, "out": tmp_path / "run", "figures": False}
    before = {chunk.name for chunk in ex.run(Coins, samples=150_000, **how).chunks}
    longer = ex.run(Coins, samples=200_000, **how)
    assert longer.summary == ex.run(Coins, samples=200_000, chunk_size=chunk_size).summary
    assert len(before & {chunk.name for chunk in longer.chunks}) == kept
    assert capsys.readouterr().err.count("of a run of fewer samples; it is computed anew") == len(before) - kept
    assert not (tmp_path / "run" / "bad").exists()
    assert longer.verify() == []


def test_a_run_goes_on_with_the_size_of_chunks_and_the_theta_min_that_it_began_with(tmp_path, monkeypatch):
    monkeypatch.setattr(scenes, "MANY", 3000)
    monkeypatch.setattr(falling_set, "MANY", 3000)
    few, many = {"samples": 2000, "grid": 3, "figures": False}, {"samples": 4000, "grid": 3, "figures": False}
    usual = ex.run("falling-set", **many).scene
    assert (usual.theta_min, usual.chunk_size) == ("near", 1 << 20)
    for said, stays in (({}, ("all", 1 << 16)), ({"theta_min": "none", "chunk_size": 512}, ("none", 512))):
        folder = tmp_path / stays[0]
        ex.run("falling-set", out=folder, **few, **said)
        scene = ex.run("falling-set", out=folder, **many).scene
        assert (scene.samples, scene.theta_min, scene.chunk_size) == (4000, *stays)
        with pytest.raises(ex.InputError, match="chunk_size"):
            ex.run("falling-set", out=folder, chunk_size=1024, **many)


def test_what_becomes_of_a_run_that_is_there_is_said_by_exist(finished):
    before = contents(finished.folder)
    with pytest.raises(ex.InputError, match="holds a run already; resume it, replace it, or give another folder"):
        ex.run(Coins, out=finished.folder, exist="error", **SMALL)
    assert contents(finished.folder) == before
    assert ex.run(Coins, out=finished.folder, **SMALL).summary == finished.summary
    after = contents(finished.folder)
    assert {path for path in before if after[path] != before[path]} <= {Path("run.json")}
    other = ex.run(Coins, out=finished.folder, exist="replace", **{**SMALL, "seed": 8, "samples": 700})
    assert other.verify() == []
    assert other.summary == ex.run(Coins, **{**SMALL, "seed": 8, "samples": 700}).summary


def test_replace_removes_the_run_and_what_stands_beside_it_stays(finished):
    folder = finished.folder
    (folder / "bad").mkdir()
    shutil.copy(finished.chunks[0].content, folder / "bad")
    (folder / "mine.txt").write_text("do not lose me")
    ex.run(Coins, out=folder, exist="replace", samples=10, figures=False)
    left = {path for path in contents(folder) if path.suffix not in (".parquet", ".json")}
    assert left == {Path("mine.txt"), Path(".lock")}
    assert len([*folder.rglob("*.parquet")]) == 1


def test_a_folder_with_something_else_is_left_alone(tmp_path):
    (tmp_path / "chapter.tex").write_text("do not lose me")
    (tmp_path / "file").write_text("")
    for out, message in (("", "is not empty and holds no run"), ("file/run", "cannot be written")):
        with pytest.raises(ex.InputError, match=message):
            ex.run(Coins, out=tmp_path / out, **SMALL)
    assert {path.name for path in tmp_path.iterdir()} == {"chapter.tex", "file"}


def test_a_folder_in_which_a_run_was_stopped_at_once_can_be_used(tmp_path, finished):
    (tmp_path / "new" / "chunks").mkdir(parents=True)
    for name in (".lock", ".run.json.17.tmp", "chunks/.chunk-000001-0.parquet.17.tmp"):
        (tmp_path / "new" / name).touch()
    (tmp_path / "new" / "chunks/.chunk-000001-0.parquet.17.tmp").unlink()
    assert ex.run(Coins, out=tmp_path / "new", **SMALL).summary == finished.summary
    assert not [*(tmp_path / "new").rglob("*.tmp")]


TABLE = {"tilt": [20.0, 30.0], "tilt_rate": [0.0, 1.0], "precession": [50.0, 60.0], "spin": [5.0, 5.0]}


@pytest.mark.filterwarnings("ignore:tilt. all tilts lie beyond upright")
@pytest.mark.parametrize("scene", ["falling-set", "race-angles"])
def test_a_run_without_one_good_sample_leaves_no_folder(scene, tmp_path):
    """So the same command can be given again, with degrees that were forgotten; what was there before stays."""
    mine = tmp_path / "mine" / "figures" / "own.png"
    mine.parent.mkdir(parents=True)
    mine.touch()
    for folder in (tmp_path / "new", tmp_path / "mine"):
        there = folder.exists()
        how = {"states": TABLE, "out": folder, "exist": "error", "figures": False, "progress": False}
        with pytest.raises(ex.RunError, match="none of 2 samples is a state"):
            ex.run(scene, **how)
        assert folder.exists() == there
        assert ex.run(scene, **how, degrees=True).verify() == []
    assert mine.exists()


def test_a_run_that_the_disk_has_no_room_for_is_refused_with_both_sizes(tmp_path, monkeypatch):
    usage = shutil.disk_usage(tmp_path)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: usage._replace(free=2_000_000))
    how = {"samples": 500_000, "keep": "all", "out": tmp_path / "run", "figures": False, "progress": False}
    with pytest.raises(ex.InputError, match=r"needs [\d.]+MB, and 2.00MB are free; .* or set overfill"):
        ex.run(Coins, **how)
    assert not (tmp_path / "run").exists()
    assert ex.plan(Coins, **how).estimate.disk > 2_000_000
    assert ex.run(Coins, **{**how, "keep": "none"}).verify() == []
    assert ex.run(Coins, **{**how, "exist": "replace", "overfill": True}).verify() == []
    assert ex.run(Coins, **how).verify() == []  # nothing is missing that would take room


def test_only_one_run_at_a_time_is_in_a_folder(finished):
    before = contents(finished.folder)
    with (
        opened(finished.folder, finished.scene, "resume"),
        pytest.raises(ex.InputError, match="another run is at work there"),
    ):
        ex.run(Coins, out=finished.folder, exist="replace", samples=10)
    assert contents(finished.folder) == before


DAMAGED = ("[]", '{"format": 3}', "{", "", '{"format": 3, "options": 5}', "\ufeff{}")


@pytest.mark.parametrize("content", DAMAGED)
def test_a_damaged_record_is_named(content, tmp_path):
    (tmp_path / "run.json").write_text(content, encoding="utf-8")
    with pytest.raises(ex.InputError, match=r"run\.json: .*start the run anew in another folder"):
        ex.open(tmp_path)


@pytest.mark.parametrize(
    "changes",
    [{"formats": True}, {"formats": "png"}, {"formats": ["bmp"]}, {"arithmetic": None}, {"chunks": "five"}],
)
def test_a_record_that_says_nothing_of_use_is_damaged(changes, finished):
    rewritten(finished, **changes)
    for ask in (lambda: ex.open(finished.folder), lambda: ex.run(Coins, out=finished.folder, **SMALL)):
        with pytest.raises(ex.InputError, match=rf"run\.json: is damaged \({next(iter(changes))}"):
            ask()


@pytest.mark.parametrize("number", [2, 4])
def test_a_folder_of_another_format_is_refused_in_words(number, finished):
    rewritten(finished, format=number)
    message = rf"another version of nearflat wrote it \(format {number}, not 3\)"
    for ask in (lambda: ex.open(finished.folder), lambda: ex.run(Coins, out=finished.folder, **SMALL)):
        with pytest.raises(ex.InputError, match=message):
            ask()
