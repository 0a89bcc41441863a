"""The folder of a run: its record is enough to go on, and nothing else is touched."""

import json
import shutil
from pathlib import Path

import pytest
from small_runs import SMALL_RACES

import explorer as ex
from explorer import compiled
from explorer.commands.main import main
from explorer.motion import calibration
from explorer.runs import folder as folders
from explorer.runs.inspect import summary, verify
from explorer.runs.workers import Task, compute_chunk
from explorer.scenes.registry import build_scene

KINDS = ("rk8", "quadrature")
RACES = {**SMALL_RACES, "samples": 300, "figures": False}


def text(run):
    return (run.folder / "summary.json").read_text()


@pytest.mark.parametrize(
    ("scene", "options"),
    [
        ("race-angles", SMALL_RACES),
        ("falling-set", {"samples": 3000, "chunk_size": 900, "grid": 5, "box": "phi=0.1:0.4", "energy": ":3"}),
        ("falling-set", {"samples": 900, "grid": 5, "slices": ["phi=0:1,phidot=0.1,sigma3=0:1,sigma4=0.3"]}),
        ("one-sided", {"samples": 3, "disk": ["hoop", "m=1,r=1,g=1,I1=0.3,I3=0.5"]}),
    ],
)
def test_the_record_of_a_run_is_enough_to_continue_it(scene, options, tmp_path):
    run = ex.run(scene, out=tmp_path / "run", **options)
    again = folders.scene_of(run.folder)
    assert again.options() == run.scene.options()
    assert folders.identity(again) == folders.identity(run.scene)


def test_resume_refuses_other_options_and_other_kernels(finished):
    with pytest.raises(ex.InputError, match="seed = 5, now seed = 9"):
        ex.run("race-angles", out=finished.folder, **{**SMALL_RACES, "seed": 9})
    record = finished.folder / "run.json"
    content = json.loads(record.read_text())
    content["identity"]["kernels"] = "0" * 64
    record.write_text(json.dumps(content))
    with pytest.raises(ex.InputError, match="another version of the kernels"):
        ex.run("race-angles", out=finished.folder, **SMALL_RACES)


def test_a_folder_with_a_run_or_with_something_else_is_left_alone(finished, tmp_path):
    before = text(finished)
    with pytest.raises(ex.InputError, match='holds a run already; add exist="resume" or exist="replace"'):
        ex.run("race-angles", out=finished.folder, exist="error", **SMALL_RACES)
    assert text(finished) == before
    (tmp_path / "thesis").mkdir()
    (tmp_path / "thesis" / "chapter.tex").write_text("do not lose me")
    with pytest.raises(ex.InputError, match="is not empty"):
        ex.run("race-angles", out=tmp_path / "thesis", **SMALL_RACES)
    assert [p.name for p in (tmp_path / "thesis").iterdir()] == ["chapter.tex"]
    with pytest.raises(ex.InputError, match="is not empty"):
        ex.run("race-angles", out=tmp_path / "thesis", **SMALL_RACES)


def contents(folder):
    """Every file below a folder with its bytes."""
    return {path: path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def test_replace_deletes_the_run_and_no_file_of_the_user(finished):
    folder, chunk = finished.folder, next((finished.folder / "chunks").iterdir())
    (folder / "bad").mkdir()
    shutil.copy(chunk, folder / "bad" / chunk.name)
    mine = [folder / name for name in ("figures/mine.png", "figures/notes.txt", "bad/mine.parquet", "mine.txt")]
    for path in mine:
        path.write_text("do not lose me")
    folders.clear(folder)
    assert sorted(contents(folder)) == sorted([*mine, folder / ".lock"])


def test_pictures_of_all_formats_of_a_run_are_deleted_with_it_also_half_drawn_ones(finished, monkeypatch):
    folder, files = finished.folder, {"histogram.png", "histogram.svg", "deviation.png", "deviation.svg"}
    assert set(folders.read_record(folder)["pictures"]) == files
    rewritten(finished, lambda content: content.pop("pictures"))  # as before they were listed
    assert set(folders.begun(folder, None)["pictures"]) == files
    monkeypatch.setattr("explorer.runs.pictures.save_all", lambda *_: [][0])
    with pytest.raises(IndexError):
        ex.run("race-angles", out=folder, format="pdf", **SMALL_RACES)
    assert set(folders.read_record(folder)["pictures"]) == files | {"histogram.pdf", "deviation.pdf"}
    folders.clear(folder)
    assert not [*(folder / "figures").iterdir()]


def test_a_record_deletes_no_file_outside_the_figures(finished):
    thesis = finished.folder / "thesis.png"
    thesis.write_text("do not lose me")
    folders.clear(rewritten(finished, lambda content: content.update(pictures=["../thesis.png"])))
    assert thesis.exists()


def test_to_resume_a_run_that_is_not_there_starts_it(finished, tmp_path):
    """So that a job script needs one line, whichever time it runs."""
    started = ex.run("race-angles", out=tmp_path / "nowhere", **SMALL_RACES)
    assert text(started) == text(finished)


def test_a_folder_that_cannot_be_made_is_named(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(ex.InputError, match="cannot be written"):
        ex.run("race-angles", out=tmp_path / "file" / "run", **SMALL_RACES)


DAMAGED = ("[]", '{"identity": 3}', "{", "", '{"identity": {"kernels": "x"}}', "\ufeff{}")


@pytest.mark.parametrize("content", DAMAGED)
def test_a_damaged_record_is_named(content, tmp_path):
    (tmp_path / "run.json").write_text(content, encoding="utf-8")
    with pytest.raises(ex.InputError, match=r"run\.json: is damaged .*start the run anew in another folder"):
        folders.scene_of(tmp_path)


@pytest.mark.parametrize("name", ["pictures", "figures", "formats", "arithmetic"])
@pytest.mark.parametrize("command", ["status", "resume"])
def test_a_record_whose_lists_are_none_is_named(name, command, finished, capsys):
    folder = rewritten(finished, lambda content: content.update({name: 5}))
    assert main([command, str(folder)]) == 2
    assert f"run.json: is damaged ({name} is no list)" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["run.json", "summary.json"])
@pytest.mark.parametrize("command", ["status", "verify", "summary", "resume"])
def test_a_folder_in_the_place_of_a_file_ends_every_command_with_a_sentence(name, command, finished, capsys):
    (finished.folder / name).unlink()
    (finished.folder / name).mkdir()
    code = main([command, str(finished.folder)])
    said = capsys.readouterr()
    assert code in ((2,) if name == "run.json" else (0, 1))
    assert name == "run.json" or command == "status" or f"{name}: cannot be" in said.out + said.err


def rewritten(run, change):
    record = run.folder / "run.json"
    content = json.loads(record.read_text())
    change(content)
    record.write_text(json.dumps(content))
    return run.folder


def test_a_record_of_a_later_format_is_refused_and_one_of_none_is_read(finished):
    folder = rewritten(finished, lambda content: content.update(format=folders.FORMAT + 1))
    with pytest.raises(ex.InputError, match=f"nearflat reads up to {folders.FORMAT}; use the version"):
        folders.scene_of(folder)
    folder = rewritten(finished, lambda content: content.pop("format"))
    assert folders.scene_of(folder).options() == finished.scene.options()


def test_an_early_record_with_options_of_its_own_is_refused_in_words(finished):
    def early(content):
        content.pop("format")
        content["identity"]["options"]["max_energy"] = 3.0

    with pytest.raises(ex.InputError, match=r"an earlier version of nearflat wrote it.*max_energy"):
        folders.scene_of(rewritten(finished, early))


def test_the_first_command_line_is_kept_when_a_run_goes_on(finished):
    folder = rewritten(finished, lambda content: content.update(command="nearflat run race-angles"))
    ex.run("race-angles", out=folder, **SMALL_RACES)
    assert folders.read_record(folder)["command"] == "nearflat run race-angles"


def measure(path, error, nanoseconds=500.0):
    """Make a calibration of this machine's own, with errors so many times those of the shipped one."""
    shipped = (Path(calibration.__file__).parent / "calibration.json").read_text(encoding="utf-8")
    table = json.loads(shipped) | {"kernels": compiled.source_digest(), "quadrature": nanoseconds}
    table["methods"]["rk8"] = [[row[0], error * row[1], *row[2:]] for row in table["methods"]["rk8"]]
    path.write_text(json.dumps(table), encoding="utf-8")
    calibration.current.cache_clear()


def test_a_run_by_steps_of_another_calibration_is_not_continued(private, tmp_path):
    """Its chunks would be of two kinds. Quadrature takes no steps."""
    measure(private, 1.0)
    runs = {method: ex.run("race-angles", out=tmp_path / method, method=method, **RACES) for method in KINDS}
    assert folders.read_record(runs["rk8"].folder)["identity"]["calibration"]
    assert "calibration" not in folders.read_record(runs["quadrature"].folder)["identity"]
    task = Task(runs["rk8"].scene, "", None, compiled.source_digest(), folders.own_calibration(runs["rk8"].scene))
    measure(private, 1.5)
    ex.run("race-angles", out=runs["quadrature"].folder, method="quadrature", exist="resume", **RACES)
    with pytest.raises(ex.InputError, match=r"steps of another calibration; put it back, name it by"):
        ex.run("race-angles", out=runs["rk8"].folder, method="rk8", exist="resume", **RACES)
    assert verify(runs["rk8"].folder) == [
        "run.json: other calibration than these computed the run; it cannot be resumed with them"
    ]
    assert summary(runs["rk8"].folder) == runs["rk8"].summary
    with pytest.raises(ex.RunError, match="the worker has another calibration than this run"):
        compute_chunk(task, 0)
    measure(private, 1.0, nanoseconds=501.0)  # which sets no step
    assert verify(runs["rk8"].folder) == []


def test_what_a_calibration_sets_is_asked_of_every_plan_of_a_scene(private):
    scenes = build_scene("measure-zero"), build_scene("race-angles"), build_scene("one-sided", accuracy=1e-4)
    assert [folders.own_calibration(scene) for scene in scenes] == [None] * 3
    measure(private, 1.0)
    before = [folders.own_calibration(scene) for scene in scenes]
    assert [bool(digest) for digest in before] == [True, False, True]
    assert folders.own_calibration(build_scene("one-sided", accuracy=1e-5)) != before[2]
