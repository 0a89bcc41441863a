"""The command line as a whole: statuses, errors in two lines, scene files, interrupts."""

import json
import os
import re
import subprocess
import sys
import warnings
import webbrowser
from importlib import metadata
from pathlib import Path

import pytest
from told import said

import explorer as ex
from explorer.commands import demo as demo_module
from explorer.commands import portrait
from explorer.commands.main import main


def contents(folder):
    """Every file below a folder with its bytes."""
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


BAD = [  # one for each reader
    (["run", "falling-set", "--disk", "m=1,r=1,g=1,I1=0.25,I3=0.6"], "I3 = 0.6"),
    (["run", "falling-set", "--samples", "0"], "samples = 0"),
    (["run", "falling-set", "--samples=-5"], "samples = -5"),
    (["run", "faling-set"], "did you mean 'falling-set'"),
    (["run", "race-angles", "--method", "euler"], "method 'euler'"),
    (["run", "race-angles", "--scheduler", "tcp://127.0.0.1:1"], "scheduler tcp"),
    (["run", "race-angles", "--chunk-size", "0"], "chunk_size = 0"),
    (["run", "race-angle", "--samples", "10"], "did you mean 'race-angles'"),
    (["run", "falling-set", "--disk", "hoop", "--disk", "uniform"], "disk: is given twice"),
    (["verify", "nowhere"], "there is no such folder"),
    (["run", "missing.toml"], "cannot be read"),
    (["run"], "SCENE"),
    (["dmeo"], "did you mean 'demo'"),
    (["race-angles"], "nearflat run race-angles"),
]


@pytest.mark.parametrize(("arguments", "message"), BAD, ids=lambda x: " ".join(x) if isinstance(x, list) else "")
def test_bad_input_gets_two_lines_at_most_and_status_2_and_writes_nothing(
    arguments, message, capsys, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    status, out, err = said(capsys, *arguments)
    assert status == 2
    assert out == ""
    assert 1 <= len(err.strip().splitlines()) <= 2
    assert message in err
    assert "Traceback" not in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("encoding", ["cp1252", "ascii", "utf-8"])
def test_a_path_that_the_output_cannot_encode_is_printed_in_other_letters(encoding, tmp_path):
    (tmp_path / "δ").mkdir()
    environment = {**os.environ, "PYTHONIOENCODING": encoding, "PYTHONUTF8": "0"}
    for more in ((), ("--json",)):
        words = [sys.executable, "-m", "explorer", "gallery", "δ", *more]
        done = subprocess.run(words, cwd=tmp_path, env=environment, capture_output=True, check=True)
        printed = done.stdout.decode(encoding)
        page = json.loads(printed)["page"] if more else printed.removeprefix("wrote ").rstrip()
        assert Path(page) == Path("δ/README.md" if more or encoding == "utf-8" else "\\u03b4/README.md")
    done = subprocess.run([*words[:3], "verify", "δ"], cwd=tmp_path, env=environment, capture_output=True)
    assert (done.returncode, b"Traceback" in done.stderr) == (2, False)


def test_an_unwritable_out_is_named(capsys, tmp_path):
    (tmp_path / "file").write_text("")
    status, _, err = said(capsys, "run", "race-angles", "--samples", 10, "--out", tmp_path / "file" / "x")
    assert status == 2
    assert "cannot be written" in err


def test_an_existing_run_is_refused_with_both_remedies(capsys, tmp_path):
    command = ("run", "race-angles", "--samples", 200, "--out", tmp_path / "run", "--quiet")
    assert said(capsys, *command)[0] == 0
    status, _, err = said(capsys, *command)
    assert status == 2
    assert "resume it" in err
    assert "another folder" in err
    assert said(capsys, *command, "--resume")[0] == 0


def test_json_prints_one_object_and_nothing_else(capsys, tmp_path):
    status, out, _ = said(capsys, "run", "race-angles", "--samples", 300, "--out", tmp_path / "r", "--json")
    assert status == 0
    assert json.loads(out) == json.loads((tmp_path / "r" / "summary.json").read_text())


def test_a_scene_file_sets_options_and_the_command_line_wins(capsys, tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text('scene = "race-angles"\ndisk = "hoop"\nsamples = 900\neta-hat = "1e-4:1e-3"\n')
    status, out, _ = said(capsys, "run", scene, "--samples", "400", "--out", tmp_path / "r", "--json", "--quiet")
    assert status == 0
    found = json.loads(out)
    assert found["samples"] == 400
    assert found["disks"][0]["name"] == "hoop"
    assert found["eta_hat"] == [1e-4, 1e-3]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("samples = 3\n", "names no scene"),
        ('scene = "race-angles"\ncolour = 1\n', "colour: race-angles takes no such option"),
        ('scene = "race-angles"\nsamples = true\n', "samples = True"),
        ('scene = "race-angles"\neta_hat = "near"\n', "is not a number or a range"),
        ("scene = 5\n", "names no scene"),
        ("=", "not valid TOML"),
    ],
)
def test_a_wrong_scene_file_is_refused_in_words_and_nothing_is_written(content, message, capsys, tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text(content)
    status, _, err = said(capsys, "run", scene, "--out", tmp_path / "r")
    assert status == 2
    assert message in err
    assert not (tmp_path / "r").exists()


@pytest.fixture
def small_demo(monkeypatch):
    small = ({"samples": 3000, "grid": 31}, {"samples": 2}, {"samples": 2000})
    steps = tuple((n, {**d, **o}, t) for (n, d, t), o in zip(demo_module._STEPS, small, strict=True))
    monkeypatch.setattr(demo_module, "_STEPS", steps)
    monkeypatch.setattr(demo_module, "STATES", 3000)


def test_the_demo_runs_again_in_its_own_folder_and_in_no_other(capsys, tmp_path, small_demo):
    out = tmp_path / "demo"
    status, printed, err = said(capsys, "demo", "--out", out)
    assert status == 0
    assert "README.md" in printed
    assert "wrong way: 0" in err
    assert "rk8: 3,000 ok" in err
    page = (out / "README.md").read_text()
    pictures = re.findall(r'<img src="([^"]+)"', page)
    assert len(pictures) == 13
    assert all((out / picture).is_file() for picture in pictures)
    first = json.loads((out / "race-angles" / "summary.json").read_text())
    status, printed, _ = said(capsys, "demo", "--out", out, "--json", "--quiet")
    assert status == 0
    assert json.loads(printed)["race-angles"] == first
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "letter.txt").write_text("")
    status, _, err = said(capsys, "demo", "--out", tmp_path / "other")
    assert status == 2
    assert "not made; give another" in err


@pytest.mark.parametrize("words", ["demo --out", "portrait --out", "trade --out", "paper --out", "gallery"])
@pytest.mark.parametrize("content", ["# My precious readme\n", "# Mine\n\nMade by hand, with `nearflat`.\n", None])
def test_a_command_writes_no_page_over_what_a_user_made(words, content, capsys, tmp_path):
    """A folder without a page may still hold pictures of the names that a command writes."""
    mine = tmp_path / "mine"
    mine.mkdir()
    (mine / "README.md" if content else mine / "letter.txt").write_text(content or "")
    if words == "gallery" and content is None:
        return  # it writes a README.md and nothing else
    before = contents(tmp_path)
    status, _, err = said(capsys, *words.split(), mine)
    assert (status, len(err.splitlines())) == (2, 1)
    assert str(mine) in err
    assert contents(tmp_path) == before


def test_a_command_writes_anew_into_a_folder_that_it_left_unfinished(capsys, tmp_path, monkeypatch):
    out = tmp_path / "portraits"
    for end in (KeyboardInterrupt, None):
        monkeypatch.setattr(portrait, "_group", lambda folder, *rest, end=end: [] if end is None else raised(end))
        assert said(capsys, "portrait", "--only", "race", "--out", out)[0] == (130 if end else 0)
    assert "nearflat portrait --only race" in (out / "README.md").read_text()


def raised(error):
    raise error


def test_the_page_is_written_over_one_of_its_kind_and_over_nothing_else(capsys, tmp_path):
    where = tmp_path / "notes.html"
    for _ in range(2):
        assert said(capsys, "view", "--out", where)[0] == 0
    where.write_text("<!doctype html>\n<title>My notes on nearflat</title>")
    status, _, err = said(capsys, "view", "--out", where)
    assert (status, len(err.splitlines())) == (2, 1)
    with pytest.raises(ex.InputError, match="not made; give another name"):
        ex.view().save(where)
    assert where.read_text() == "<!doctype html>\n<title>My notes on nearflat</title>"


FOREIGN = "from explorer.commands.main import main\nraise SystemExit(main(['warmup']))"


def test_a_foreign_kernels_package_is_named_with_the_remedy(tmp_path):
    (tmp_path / "kernels").mkdir()
    (tmp_path / "kernels" / "__init__.py").write_text("raise SystemExit('foreign code ran')")
    root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(__file__))))  # noqa: PTH120
    done = subprocess.run(
        [sys.executable, "-c", FOREIGN],
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), root])},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert str(tmp_path / "kernels") in done.stderr
    assert "fresh virtual environment" in done.stderr
    assert len(done.stderr.strip().splitlines()) <= 2


@pytest.mark.parametrize("words", [["plan", "race-angles", "--json"], ["run", "--help"]])
def test_a_closed_pipe_ends_the_command_silently(words):
    """Also at the end of the interpreter, which flushes what is left."""
    with subprocess.Popen(
        [sys.executable, "-m", "explorer.commands.main", *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as command:
        command.stdout.close()
        assert command.stderr.read() == b""
        assert command.wait() in (0, 141)  # the parser itself swallows the error of its --help


LOADED = """
import sys
from explorer.commands.main import main
from explorer.scenes.scene import NAMES
passage = ["passage", "--sigma3-bar", "1", "--eta-hat", "-1e-6", "--phidot", "1", "--quiet"]
many = ["plan", "falling-set", "--samples", "1e9"]
small = {"one-sided": "2"}  # the others take any number
assert main(passage) == 0
print("heavy:", *(name for name in ("pyarrow", "joblib") if name in sys.modules))
for words in (*(["plan", scene, "--samples", small.get(scene, "2000")] for scene in NAMES), many):
    assert main(words) == 0
heavy = [f"scipy.{name}" for name in ("stats", "optimize", "linalg", "fft", "special", "interpolate")]
heavy += ["numpy.f2py", "matplotlib", "pandas", "numba.np.arraymath"]
print("heavy:", *(name for name in heavy if name in sys.modules))
"""


def test_short_commands_load_no_library_that_they_do_not_use():
    done = subprocess.run([sys.executable, "-c", LOADED], capture_output=True, text=True, check=True)
    assert [line for line in done.stdout.splitlines() if line.startswith("heavy:")] == ["heavy:"] * 2


HELPS = """
import contextlib, io, sys
from explorer.commands.main import COMMANDS, main
for name in COMMANDS:
    with contextlib.suppress(SystemExit), contextlib.redirect_stdout(io.StringIO()):
        main([name, "--help"])
print("heavy:", *(name for name in ("numba", "matplotlib") if name in sys.modules))
"""


def test_the_help_of_no_command_loads_what_draws_or_compiles():
    done = subprocess.run([sys.executable, "-c", HELPS], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "heavy:"


def test_a_run_without_pictures_loads_neither_pandas_nor_matplotlib(tmp_path):
    pytest.importorskip("pandas")
    call = f"ex.run('race-angles', samples=500, keep='all', out={str(tmp_path / 'run')!r}, figures=False)"
    told = "print('heavy:', *(name for name in ('pandas', 'matplotlib', 'scipy.stats') if name in sys.modules))"
    code = f"import sys, explorer as ex; {call}; {told}"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "heavy:"


@pytest.mark.parametrize("words", [["trade"], ["plan", "race-angles"], ["view"]])
def test_an_unknown_option_is_named_by_its_command(words, capsys):
    assert main([*words, "--delta", "3"]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"nearflat {words[0]}: unrecognized arguments: --delta 3\n")
    assert f"Try 'nearflat {' '.join(words)} --help'." in error


@pytest.mark.parametrize(
    ("words", "meant"),
    [
        (["run", "race-angles", "--sampels", "10"], "--sampels 10; did you mean --samples?"),
        (["passage", "--sigma3-bar=1", "--eta-hat=1", "--phidot=1", "--fase=1"], "did you mean --face?"),
    ],
)
def test_a_misspelt_option_is_answered_with_the_nearest_one(words, meant, capsys):
    assert main(words) == 2
    assert meant in capsys.readouterr().err.splitlines()[0]


def test_a_warning_is_a_sentence(capsys, tmp_path):
    path = tmp_path / "coin.csv"
    path.write_text("tilt,precession,spin\n2,60,-40\n3,60,-40\n")
    with warnings.catch_warnings():
        warnings.simplefilter("default")
        assert main(["run", "race-angles", "--states", str(path), "--out", str(tmp_path / "run"), "--quiet"]) == 0
    (line,) = [line for line in capsys.readouterr().err.splitlines() if "degrees" in line]
    assert line.startswith("nearflat run: tilt: all tilts lie beyond upright")


def test_commands_draw_whatever_windows_the_environment_asks_for():
    """matplotlib is not even imported where it does not know the name."""
    code = "from explorer.commands.main import main; main(); import matplotlib; print(matplotlib.get_backend())"
    done = subprocess.run(
        [sys.executable, "-c", code, "cite"],
        env={**os.environ, "MPLBACKEND": "no-such-window"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.splitlines()[-1] == "agg"


CFF = (Path(__file__).parents[3] / "CITATION.cff").read_text("utf-8")


def test_bibtex_and_the_citation_file_name_the_same_paper():
    (number,) = re.findall(r"^\s+volume: (\d+)", CFF, flags=re.MULTILINE)
    (title,) = re.findall(r"^\s+title: (.+)", CFF, flags=re.MULTILINE)
    (year,) = re.findall(r"^\s+year: (\d+)", CFF, flags=re.MULTILINE)
    assert all(f"{{{value}}}" in ex.cite() for value in (number, title, year))
    assert f"version = {{{metadata.version('nearflat')}}}" in ex.cite()


def test_the_command_prints_what_the_function_returns(capsys):
    assert main(["cite"]) == 0
    assert capsys.readouterr().out == ex.cite() + "\n"


def test_as_json_both_entries_have_their_keys(capsys):
    assert main(["cite", "--json"]) == 0
    assert set(json.loads(capsys.readouterr().out)) == {"nearflat", "CushmanDuistermaat2006"}


def test_the_page_is_written_and_opened(tmp_path, capsys, monkeypatch):
    opened = []
    monkeypatch.setattr(webbrowser, "open", opened.append)
    where = tmp_path / "page.html"
    arguments = ["view", "--disk", "hoop", "--eta-hat", "-1e-12", "--face", "-1", "--out", str(where), "--open"]
    assert main(arguments) == 0
    assert '"eta_hat": -1e-12' in where.read_text("utf-8")
    assert opened == [where.as_uri()]
    assert str(where) in capsys.readouterr().out


def test_json_is_all_that_is_printed(tmp_path, capsys):
    where = tmp_path / "page.html"
    assert main(["view", "--out", str(where), "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said == {"page": str(where), "bytes": where.stat().st_size, "disk": "uniform"}


def test_arguments_that_cannot_be_used_are_named(capsys):
    assert main(["view", "--eta-hat", "0"]) == 2
    assert "eta_hat = 0" in capsys.readouterr().err


COMPILING = """
import sys, time
from explorer import compiled
compiled.warmup = lambda *names, **say: print("compiling", flush=True) or time.sleep(60)
from explorer.commands.main import main
sys.exit(main())
"""


@pytest.mark.skipif(os.name != "posix", reason="no other system has SIGTERM")
@pytest.mark.parametrize("words", [["warmup"], ["passage", "--sigma3-bar=1", "--eta-hat=0", "--phidot=1"]])
def test_sigterm_while_kernels_are_compiled_ends_with_a_sentence(words):
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen([sys.executable, "-c", COMPILING, *words], **pipes) as command:
        assert command.stdout.readline() == "compiling\n"
        command.terminate()
        assert command.communicate()[1] == f"nearflat {words[0]}: interrupted\n"
        assert command.returncode == 130


def test_warmup_says_when_all_is_ready(capsys):
    assert main(["warmup", "--quiet"]) == 0
    capsys.readouterr()
    assert main(["warmup"]) == 0
    assert capsys.readouterr().out == "All kernels were ready.\n"


def test_the_package_can_be_run_as_the_command():
    ran = subprocess.run(
        [sys.executable, "-m", "explorer", "--version"], capture_output=True, text=True, check=True
    )
    assert ran.stdout.startswith("nearflat ")


@pytest.mark.parametrize(
    ("typed", "offered"),
    [
        ("pla", "plan"),
        ("run r", "race-angles"),
        ("run race-angles --eta", "--eta-hat"),
        ("run falling-set --samples 10 --theta", "--theta-min"),
        ("probability --tilt_", ""),
    ],
)
def test_a_shell_completes_commands_scenes_and_options(capsys, typed, offered):
    assert main(["completion"]) == 0
    script = capsys.readouterr().out
    words = ["nearflat", *typed.split()]
    asked = f"COMP_WORDS=({' '.join(words)}); COMP_CWORD={len(words) - 1}; _nearflat; echo ${{COMPREPLY[@]}}"
    ran = subprocess.run(["bash", "-c", f"{script}\n{asked}"], capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == offered
