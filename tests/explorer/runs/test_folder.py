"""The folder of a run: its record is enough to go on, and nothing else is touched."""

import contextlib
import errno
import json
import os
import shutil
import stat
import sys
from pathlib import Path

import filelock
import pytest
from coins import SMALL, Coins
from told import said

import explorer as ex
from explorer import compiled
from explorer.runs import store
from explorer.runs.folder import FORMAT, opened, read_record
from explorer.scenes import falling_set
from explorer.scenes import scene as scenes

RACES = {"samples": 300, "seed": 5, "eta_hat": "1e-4:1e-2", "chunk_size": 128, "figures": False}


def rewritten(run, **changes):
    """The run after something in its run.json was changed by whoever leaves out the digest of what it asks."""
    path = run.folder / "run.json"
    record = {**json.loads(path.read_text()), **changes}
    record.pop("check", None)
    path.write_text(json.dumps(record))
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
    with pytest.raises(ex.InputError, match=r"coins\.py:Coins: its code is run only if .* you trust it"):
        ex.open(finished.folder).resume()
    again = ex.open(finished.folder, trust=True)
    assert type(again.scene) is not Coins
    assert again.resume(progress=False).summary == finished.summary
    rewritten(again, **{"from": str(finished.folder / "gone.py:Coins")})
    with pytest.raises(ex.InputError, match="the file is gone"):
        ex.open(finished.folder).resume()


def test_a_stored_run_of_scene_portrait_says_what_to_use_instead(finished):
    record = read_record(finished.folder)
    options = {**record["options"], "scene": "portrait"}
    old = ex.open(rewritten(finished, options=options, **{"from": None, "code": None}).folder)
    for ask in (lambda: old.summary, lambda: old.resume(progress=False)):
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
    for given, stays in (({}, ("all", 1 << 16)), ({"theta_min": "none", "chunk_size": 512}, ("none", 512))):
        folder = tmp_path / stays[0]
        ex.run("falling-set", out=folder, **few, **given)
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


def test_only_pictures_that_the_run_has_drawn_are_deleted(tmp_path):
    """Also where samples are added, and by another scene."""
    folder = tmp_path / "paper"
    ex.run(Coins, out=folder, format="svg", **SMALL)
    (folder / "figures" / "fig1.png").write_text("mine")
    for how in ({"samples": 4000}, {"exist": "replace"}):
        ex.run(Coins, out=folder, format="svg", **{**SMALL, **how})
        assert {path.name for path in (folder / "figures").iterdir()} == {"fig1.png", "bars.svg"}
    ex.run("race-angles", samples=100, out=folder, exist="replace", figures=False)
    assert [path.name for path in (folder / "figures").iterdir()] == ["fig1.png"]


def test_a_picture_of_a_user_with_the_name_of_one_of_ours_stays(tmp_path):
    folder = tmp_path / "run"
    ex.run(Coins, out=folder, figures=False, **SMALL)
    mine = folder / "figures" / "bars.svg"
    mine.parent.mkdir()
    mine.write_text("mine")
    ex.open(folder).resume(format="svg", progress=False)
    ex.run(Coins, out=folder, format="svg", **{**SMALL, "samples": 4000})
    ex.run(Coins, out=folder, exist="replace", figures=False, **SMALL)
    assert mine.read_text() == "mine"


def test_chunks_of_another_run_stay_where_the_new_one_is_not_begun(tmp_path):
    folder = tmp_path / "run"
    ex.run(Coins, out=folder, figures=False, **SMALL)
    chunks = {path.name for path in (folder / "chunks").iterdir()}
    for name in ("run.json", "summary.json"):
        (folder / name).unlink()
    with pytest.raises(ex.InputError, match="free"):
        ex.run(Coins, out=folder, samples=10**12, chunk_size=1 << 20, keep="all")
    assert {path.name for path in (folder / "chunks").iterdir()} == chunks


@pytest.mark.parametrize("name", ["figures/fig1.png", "chunks/mine.parquet", ".notes.tmp", "chunks/.swap.17.tmp"])
@pytest.mark.parametrize("exist", ["resume", "replace", "error"])
def test_files_that_no_run_has_made_stay_where_no_run_was(name, exist, tmp_path):
    (tmp_path / "paper" / "chunks").mkdir(parents=True)
    (tmp_path / "paper" / "figures").mkdir()
    (tmp_path / "paper" / name).write_text("mine")
    with pytest.raises(ex.InputError, match="not empty") if name == ".notes.tmp" else contextlib.nullcontext():
        ex.run(Coins, out=tmp_path / "paper", exist=exist, **SMALL)
    assert (tmp_path / "paper" / name).read_text() == "mine"


def test_files_of_others_in_the_folder_of_a_run_stay(finished):
    """A pipe with the name of a chunk is not waited for."""
    names = ["bad/x.txt", "chunks/mine.parquet", ".notes.tmp", "chunks/.swap.17.tmp", "figures/.b.png.tmp"]
    (finished.folder / "bad").mkdir()
    for name in names:
        (finished.folder / name).write_text("mine")
    os.mkfifo(finished.folder / "chunks" / f"chunk-000002-{'0' * 16}.parquet")
    assert finished.verify() == []
    assert ex.open(finished.folder).status.chunks_done == 5
    finished.resume(progress=False)
    ex.run(Coins, out=finished.folder, exist="replace", samples=10, figures=False)
    assert [(finished.folder / name).read_text() for name in names] == ["mine"] * len(names)


def test_a_picture_that_a_record_names_elsewhere_is_not_deleted(finished):
    (finished.folder / "mine.svg").touch()
    rewritten(finished, pictures=["../mine.svg", "bars.svg"])
    ex.run(Coins, out=finished.folder, exist="replace", samples=10, figures=False)
    assert (finished.folder / "mine.svg").exists()


def test_an_empty_folder_is_empty_where_nothing_came_of_a_run(tmp_path):
    (tmp_path / "mine").mkdir()
    with pytest.raises(ex.InputError, match="free"):
        ex.run(Coins, out=tmp_path / "mine", samples=10**12, chunk_size=1 << 20, keep="all")
    assert list((tmp_path / "mine").iterdir()) == []


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
        with pytest.raises(ex.InputError, match="none of 2 samples is a state"):
            ex.run(scene, **how)
        assert folder.exists() == there
        assert ex.run(scene, **how, degrees=True).verify() == []
    assert mine.exists()


@pytest.mark.filterwarnings("ignore:tilt. all tilts lie beyond upright")
def test_a_run_is_replaced_only_by_one_of_states(tmp_path):
    how = {"out": tmp_path / "run", "figures": False, "progress": False}
    before = ex.run("race-angles", **how, states=TABLE, degrees=True)
    (before.folder / "notes.txt").touch()
    with pytest.raises(ex.InputError, match="none of 2 samples is a state"):
        ex.run("race-angles", **how, states=TABLE, exist="replace")
    assert ex.open(before.folder).verify() == []
    assert ex.run("race-angles", **how, states=TABLE, degrees=True, exist="replace").verify() == []


def test_a_run_whose_samples_cannot_be_computed_leaves_no_folder(tmp_path):
    how = {"samples": 100, "out": tmp_path / "run", "figures": False, "progress": False}
    with pytest.raises(ex.InputError):
        ex.run("one-sided", box="phidot=0,sigma3=1e80:1e81", **how)
    assert not how["out"].exists()
    assert ex.run("one-sided", **how).verify() == []


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
        pytest.raises(ex.InputError, match=f"work there .*process {os.getpid()} on .*end that process.*delete"),
    ):
        ex.run(Coins, out=finished.folder, exist="replace", samples=10)
    assert {**contents(finished.folder), Path(".lock"): b""} == {**before, Path(".lock"): b""}


def failing(call, number, fails=lambda *_: True):
    """The call, or this error of the system where it fails."""

    def instead(*given, **options):
        if fails(*given):
            raise OSError(number, os.strerror(number))
        return call(*given, **options)

    return instead


def is_folder(handle):
    return stat.S_ISDIR(os.fstat(handle).st_mode)


@pytest.mark.skipif(os.name == "nt", reason="folders are not synced there")
@pytest.mark.parametrize("number", [errno.EINVAL, errno.EOPNOTSUPP, errno.EBADF, errno.ENOTSUP])
def test_where_folders_cannot_be_synced_a_run_is_stored_and_says_so_once(number, finished, tmp_path, monkeypatch):
    monkeypatch.setattr(os, "fsync", failing(os.fsync, number, is_folder))
    with pytest.warns(UserWarning, match="its file system syncs no folders") as told:
        run = ex.run(Coins, out=tmp_path / "new", **SMALL)
    assert len(told) == 1
    assert (run.summary, run.verify()) == (finished.summary, [])


@pytest.mark.parametrize("number", [errno.ENOSYS, errno.ENOLCK, errno.EOPNOTSUPP])
def test_where_there_are_no_locks_a_run_is_stored_and_says_so_once(number, finished, tmp_path, monkeypatch):
    acquire = filelock.FileLock.acquire
    monkeypatch.setattr(filelock.FileLock, "acquire", failing(acquire, number))
    with pytest.warns(UserWarning, match="its file system has no locks; start no second run") as told:
        run = ex.run(Coins, out=tmp_path / "new", **SMALL)
    assert len(told) == 1
    assert (run.summary, run.verify()) == (finished.summary, [])


@pytest.mark.skipif(os.name == "nt", reason="there are other locks")
def test_without_flock_no_file_is_left_that_would_keep_the_next_run_out(finished, monkeypatch):
    import fcntl

    with monkeypatch.context() as patch:
        patch.setattr(fcntl, "flock", failing(fcntl.flock, errno.ENOSYS))
        with (
            pytest.warns(UserWarning, match="no locks"),
            opened(finished.folder, finished.scene, "resume"),
            pytest.warns(UserWarning, match="no locks"),
        ):
            assert finished.resume().verify() == []
    assert finished.resume().verify() == []


@pytest.mark.skipif(os.name == "nt", reason="folders are not synced there")
def test_other_faults_of_syncing_and_locking_end_the_run(tmp_path, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", failing(os.fsync, errno.EIO, is_folder))
        with pytest.raises(ex.RunError, match=os.strerror(errno.EIO)):
            ex.run(Coins, out=tmp_path / "new", **SMALL)
    monkeypatch.setattr(filelock.FileLock, "acquire", failing(filelock.FileLock.acquire, errno.EIO))
    with pytest.raises(ex.RunError, match=r"\.lock"):
        ex.run(Coins, out=tmp_path / "new", **SMALL)


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


@pytest.mark.parametrize("key", ["seed", "samples", "chunk_size", "bias", "keep"])
def test_another_number_among_the_options_is_told_and_makes_no_good_chunk_a_bad_one(key, finished):
    path = finished.folder / "run.json"
    record = json.loads(path.read_text())
    record["options"][key] = "near" if key == "keep" else 2 * record["options"][key]
    path.write_text(json.dumps(record))
    before = contents(finished.folder)
    for ask in (ex.open, lambda folder: ex.run(Coins, out=folder, **SMALL)):
        with pytest.raises(ex.InputError, match=r"run\.json: is damaged .other options"):
            ask(finished.folder)
    assert contents(finished.folder) == before


@pytest.mark.parametrize("signed", [False, True])
@pytest.mark.parametrize("command", ["status", "verify", "summary", "resume", "merge", "gallery"])
def test_whatever_a_record_says_is_answered_in_words(command, signed, finished, capsys):
    """Also where somebody has made the checksum of the options fit."""
    path = finished.folder / "run.json"
    right = path.read_text()
    options = json.loads(right)["options"]
    edits = [("options", {"a": 1}), ("chunks", 1e308), ("chunks", "1e6"), ("chunks", 0), ("started", float("inf"))]
    edits += [("options", {**options, "samples": value}) for value in ("1e6", -1, [], None, 300)]
    edits += [("options", {"scene": value}) for value in (3, None, "../x.py:E", "race-angles")]
    edits += [(key, value) for key in ("from", "formats", "pictures", "arithmetic") for value in (3, "x", [3], {})]
    for key, value in edits:
        record = {**json.loads(right), key: value}
        if signed:
            record["check"] = store.sha256(json.dumps([record["options"], record["chunks"]], sort_keys=True))[:16]
        path.write_text(json.dumps(record))
        status, out, err = said(capsys, command, finished.folder, *[finished.folder] * (command == "merge"))
        assert status in (0, 1, 2), (key, value)
        assert out or err, (key, value)
    for content in ("[" * 200_000, '{"a":' * 100_000):
        path.write_text(content)
        assert said(capsys, command, finished.folder)[0] == (0 if command == "gallery" else 2)


@pytest.mark.parametrize("number", [2, 4])
def test_a_folder_of_another_format_is_refused_in_words(number, finished):
    rewritten(finished, format=number)
    message = rf"another version of nearflat wrote it \(format {number}, not 3\)"
    for ask in (lambda: ex.open(finished.folder), lambda: ex.run(Coins, out=finished.folder, **SMALL)):
        with pytest.raises(ex.InputError, match=message):
            ask()
