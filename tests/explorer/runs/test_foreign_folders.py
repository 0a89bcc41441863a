"""A folder that somebody sent: what it may do to who looks at it."""

import importlib.util
import json
import marshal
import shlex
import shutil
import sys
from pathlib import Path

import coins
import pytest
from coins import SMALL
from told import said

import explorer as ex
from explorer.commands.gallery import gallery
from explorer.scenes import scene as scenes


@pytest.fixture
def sent(tmp_path, monkeypatch):
    """A finished run of a scene whose file says when it is run, and is not loaded; folder, file and log."""
    file, log = tmp_path / "sent_scene.py", tmp_path / "log"
    file.write_text(
        f"{Path(coins.__file__).read_text()}\n\nwith open({str(log)!r}, 'a') as log:\n    log.write('run ')\n"
    )
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.setattr(scenes, "_own", {})
    run = ex.run(f"{file}:Coins", out=tmp_path / "run", **SMALL)
    rows, summary = run.arrow(), run.summary
    scenes._own.clear()
    del sys.modules["sent_scene"]
    assert log.read_text() == "run "
    yield run.folder, file, log, rows, summary
    sys.modules.pop("sent_scene", None)


def rewritten(folder, **changes):
    """As whoever forges a record would write it: without the digest of what it asks."""
    path = folder / "run.json"
    record = {**json.loads(path.read_text()), **changes}
    record.pop("check", None)
    path.write_text(json.dumps(record))


def test_to_look_at_a_folder_runs_nothing_and_shows_its_rows_and_its_counts(sent, capsys):
    folder, _, log, rows, summary = sent
    run = ex.open(folder)
    assert run.arrow().equals(rows)
    assert run.arrow().schema.field("height").metadata[b"unit"] == b"length"
    assert len(run.frame()) == 2500
    assert (run.status.chunks_done, run.status.status, run.verify()) == (5, summary["status"], [])
    assert "only if you say that you trust it" in repr(run)
    assert "only if you say that you trust it" in run._repr_html_()
    gallery(folder.parent)
    for words in (["status"], ["verify"]):
        assert said(capsys, *words, folder)[0] == 0
    for words in (["resume"], ["summary"], ["merge", folder]):
        status, _, err = said(capsys, *words, folder)
        assert (status, "its code is run only if you say that you trust it" in err) == (2, True)
    for ask in (lambda: run.summary, lambda: run.figure("bars")):
        with pytest.raises(ex.InputError, match="only if you say that you trust it"):
            ask()
    assert log.read_text() == "run "


def test_a_scene_that_is_trusted_is_run_and_its_run_goes_on(sent, capsys):
    folder, _, log, _, summary = sent
    next((folder / "chunks").iterdir()).unlink()
    assert said(capsys, "resume", folder, "--trust")[0] == 0
    assert log.read_text() == "run run "
    assert ex.open(folder, trust=True).summary == summary
    assert ex.open(folder, trust=True).figure("bars").axes
    with pytest.raises(ex.InputError, match="trust = yes must be true or false"):
        ex.open(folder, trust="yes")


def test_what_lies_compiled_beside_a_trusted_file_is_not_run(sent):
    folder, file, log, _, summary = sent
    other = compile("raise SystemError('compiled code was run')", str(file), "exec")
    beside = Path(importlib.util.cache_from_source(str(file)))
    beside.parent.mkdir(exist_ok=True)
    digest = importlib.util.source_hash(file.read_bytes())
    beside.write_bytes(importlib.util.MAGIC_NUMBER + b"\x01\0\0\0" + digest + marshal.dumps(other))
    assert ex.open(folder, trust=True).summary == summary
    assert log.read_text() == "run run "


@pytest.mark.parametrize("where", ["x" * 5000 + ".py:Coins", "sent_scene.py:Coins", "~/sent_scene.py:Coins"])
def test_a_file_that_a_folder_names_in_no_usable_way_is_told_and_not_looked_for(where, sent, monkeypatch, capsys):
    folder, file, log, _, _ = sent
    monkeypatch.chdir(file.parent)
    monkeypatch.setenv("HOME", str(file.parent))
    rewritten(folder, **{"from": where})
    assert "the file is gone" in repr(ex.open(folder, trust=True))
    assert said(capsys, "verify", folder, "--trust")[0] == 0
    status, _, err = said(capsys, "summary", folder, "--trust")
    assert (status, "the file is gone" in err, len(err) < 500) == (2, True, True)
    assert log.read_text() == "run "


def test_code_that_is_not_as_it_was_or_lies_in_the_folder_is_never_run(sent, capsys):
    folder, file, log, _, _ = sent
    inside = shutil.copy(file, folder / "sent_scene.py")
    cases = {f"{inside}:Coins": "code in the folder of a run is not run"}
    file.write_text(file.read_text() + "\n")
    cases[f"{file}:Coins"] = "was changed since"
    for where, message in cases.items():
        rewritten(folder, **{"from": where})
        for command in ("resume", "summary"):
            status, _, err = said(capsys, command, folder, "--trust")
            assert (status, message in err) == (2, True), err
    assert log.read_text() == "run "


@pytest.mark.parametrize("relative", [False, True])
def test_a_run_of_our_scenes_runs_no_file_whatever_its_record_says(relative, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    ex.run("race-angles", samples=300, out="run", figures=False)
    code = Path("run" if relative else tmp_path, "sent_code.py")
    code.write_text("raise SystemExit('code was run')")
    for changes in ({"from": f"{code}:E"}, {"options": {"scene": f"{code}:E"}}, {"options": {"scene": str(code)}}):
        shutil.copytree("run", "edited")
        rewritten(Path("edited"), **changes)
        for command in ("status", "verify", "summary", "resume"):
            assert said(capsys, command, "edited")[0] in ((0,) if "from" in changes else (0, 1, 2))
        shutil.rmtree("edited")


def test_what_a_folder_says_moves_no_cursor_of_a_terminal(tmp_path, capsys):
    run = ex.run("race-angles", samples=100, out=tmp_path / "run", figures=False)
    rewritten(run.folder, finished="\x1b[2J\u202egone")
    status, out, _ = said(capsys, "status", run.folder)
    assert status == 0
    assert "\\x1b[2J\\u202egone" in out
    (tmp_path / "\x1b[31mnone").mkdir()
    status, _, err = said(capsys, "status", tmp_path / "\x1b[31mnone")
    assert (status, "\x1b" in err) == (2, False)


def test_a_page_takes_names_and_commands_as_text(tmp_path):
    folder = tmp_path / 'x" onerror="alert(1)'
    folder.mkdir()
    (folder / 'y" onerror="alert(2).png').touch()
    run = ex.run("race-angles", samples=100, out=folder / "run", figures=False)
    shutil.copy(run.folder / "run.json", folder)
    rewritten(folder, command="`</code><script>alert(3)</script> | [a](javascript:alert(4))\n# b")
    page = gallery(tmp_path)
    assert 'onerror="' not in page
    assert "<script>" not in page
    assert "[a]" not in page
    assert "\n# b" not in page


@pytest.mark.parametrize("name", ["with space", "$HOME`id`", "-dash", "quote's"])
def test_the_command_that_continues_can_be_pasted(name, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run = ex.run("race-angles", samples=100, out=name, figures=False)
    run.chunks[0].content.unlink()
    told = [said(capsys, "status", "--", name)[1]]
    with pytest.raises(ex.RunError) as refused:
        run.frame()
    for text in (*told, str(refused.value)):
        onward = text.strip().rpartition("continue with: nearflat ")[2]
        assert said(capsys, *shlex.split(onward), "--no-figures")[0] == 0
        assert run.status.chunks_done == 1
        run.chunks[0].content.unlink()
