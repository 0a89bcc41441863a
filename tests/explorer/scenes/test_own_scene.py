"""A scene of a user: everything that ours have follows from its declarations."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from told import said

import explorer as ex
from explorer.scenes import Counts, SampledScene, option, whole_from
from explorer.scenes import scene as scenes

EXAMPLE = f"{Path(__file__).parents[3] / 'docs' / 'examples' / 'own_scene.py'}:Periods"


@pytest.fixture(autouse=True)
def forgotten(monkeypatch):
    """What a test loads is not known to the next."""
    monkeypatch.setattr(scenes, "_own", {})
    monkeypatch.setattr(sys, "path", [*sys.path])
    yield
    sys.modules.pop("own_scene", None)


def test_its_help_is_that_of_its_fields(capsys):
    status, out, _ = said(capsys, "run", EXAMPLE, "--help")
    text = " ".join(out.split())
    assert status == 0
    assert "How long is a period? Of motions that start at the vertical with speeds below a limit." in text
    assert "--speed X largest speed at the vertical (default 2)" in text
    assert "--samples N" in text
    assert "--ladder" not in text


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--speed", "fast"], "speed = fast is not a number"),
        (["--speed", "0.05"], "speed = 0.05 must be a finite number, 0.1 or more"),
        (["--method", "rk4"], "method rk4: periods names no observables"),
        (["--ladder", "1:2"], "--ladder"),
        (["--samples", "0"], "samples = 0"),
    ],
)
def test_its_values_are_checked(words, message, capsys, tmp_path):
    status, _, err = said(capsys, "run", EXAMPLE, *words, "--out", tmp_path / "run")
    assert status == 2
    assert message in err
    assert not (tmp_path / "run").exists()


def test_its_folder_remembers_where_it_came_from(capsys, tmp_path, monkeypatch):
    folder = tmp_path / "run"
    assert said(capsys, "run", EXAMPLE, "--samples", "1e3", "--speed", "2", "--seed", "4", "--out", folder)[0] == 0
    summary = json.loads((folder / "summary.json").read_text())
    assert (summary["speed"], summary["known"]) == (2.0, 1000)
    monkeypatch.setattr(scenes, "_own", {})
    sys.modules.pop("own_scene")
    (chunk,) = (folder / "chunks").glob("*.parquet")
    chunk.unlink()
    assert said(capsys, "verify", folder)[0] == 1
    status, _, err = said(capsys, "resume", folder)
    assert (status, "give trust" in err) == (2, True)
    assert said(capsys, "resume", folder, "--trust", "--backend", "processes")[0] == 0
    assert json.loads((folder / "summary.json").read_text()) == summary
    field = ex.open(folder).arrow().schema.field("period")
    assert field.metadata[b"unit"] == b"time"


def test_status_and_verify_do_without_its_file_and_say_where_it_was_changed(capsys, tmp_path):
    file, folder = tmp_path / "own_scene.py", tmp_path / "run"
    file.write_text(Path(EXAMPLE.removesuffix(":Periods")).read_text())
    assert said(capsys, "run", f"{file}:Periods", "--samples", "100", "--out", folder, "--no-figures")[0] == 0
    moved = file.rename(tmp_path / "moved.py")
    assert said(capsys, "status", folder)[0] == 0
    assert said(capsys, "verify", folder)[:2] == (0, "intact\n")
    file.write_text(moved.read_text() + "raise SystemExit('nobody runs this')\n")
    status, out, _ = said(capsys, "verify", folder)
    assert status == 1
    assert out.strip() == (
        f"run.json: {file}:Periods was changed since; put that file back as it was to resume the run, or replace "
        "the run"
    )


def test_it_may_be_named_in_a_scene_file_with_its_own_options(capsys, tmp_path):
    (tmp_path / "scene.toml").write_text(f"scene = '{EXAMPLE}'\nspeed = 3\nsamples = 10\n")
    status, out, _ = said(capsys, "run", tmp_path / "scene.toml", "--out", tmp_path / "run", "--json", "--quiet")
    assert status == 0
    assert json.loads(out)["speed"] == 3.0


def test_a_plan_does_not_invent_a_method(capsys):
    assert said(capsys, "plan", EXAMPLE, "--samples", "100")[0] == 0


def test_what_is_no_scene_is_refused(capsys, tmp_path):
    class Named(SampledScene):
        name = "race-angles"

    for wrong, message in ((3, "is no scene"), (Named, "is a scene of nearflat")):
        with pytest.raises(ex.InputError, match=message):
            ex.register(wrong)
    for words, message in (
        (f"{tmp_path}/none.py:Scene", "there is no file"),
        (EXAMPLE.replace("Periods", "Preiods"), "known: Periods"),
        (EXAMPLE.removesuffix(":Periods"), "'' is not known; known: Periods"),
    ):
        status, _, err = said(capsys, "run", words)
        assert status == 2
        assert message in err


class HeadCounts(Counts):
    heads: int


class Coins(SampledScene):
    """How often does a coin show heads?"""

    tally = HeadCounts

    def draw(self, random, count):
        return {"heads": random.random(count) < 0.5}

    def observe(self, drawn):
        return {**drawn, "status": 0 * drawn["heads"].astype("i1")}

    def count(self, tally, table):
        tally.heads += int(table["heads"].sum())

    def summarise(self, tally):
        return {"share": tally.heads / self.samples}


def test_a_class_is_a_scene_of_python_and_its_runs_add_up():
    runs = [ex.run(Coins, samples=3000, rng=seed, chunk_size=512) for seed in (1, 2)]
    assert 0.45 < runs[0].summary["share"] < 0.55
    both = ex.merge(*runs)
    assert both.summary["share"] == pytest.approx(sum(run.summary["share"] for run in runs) / 2)
    assert ex.run("coins", samples=3000, seed=1, chunk_size=512).summary["share"] == runs[0].summary["share"]


RIGHT = """
import numpy as np
import explorer as ex
from explorer.scenes import NUMBER, Counts, SampledScene, option

class HeadCounts(Counts):
    heads: int

class Coins(SampledScene):
    tally, columns = HeadCounts, ("status",)

    def draw(self, random, count):
        return {"heads": random.random(count) < 0.5}

    def observe(self, drawn):
        return {**drawn, "status": 0 * drawn["heads"].astype("i1")}

    def near(self, table):
        return table["heads"]

    def count(self, tally, table):
        tally.heads += int(table["heads"].sum())

    def summarise(self, tally):
        return {"share": tally.heads / self.samples}
"""


@pytest.mark.parametrize(
    ("right", "wrong", "message"),
    [
        ("heads: int", "heads: dict", "in count: TypeError"),
        ("= HeadCounts,", "= dict,", "AttributeError: 'dict' object has no attribute 'status'"),
        ('("status",)', '("status", "theta_min")', "observe returns no column theta_min"),
        ("def draw", "def drawn", r"a scene offers draw(random, count)"),
        ("random(count)", "random(3)", "draw and observe give 3 samples, not 100"),
        ('"status": 0', '"state": 0', "observe returns no column status; return a dict with it"),
        ('return {**drawn, "status"', 'drawn |= {"status"', "observe returns no column status"),
        (
            '0 * drawn["heads"].astype("i1")',
            'np.where(drawn["heads"], np.nan, 0)',
            "statuses that are none",
        ),
        (
            '0 * drawn["heads"].astype("i1")',
            '256 * drawn["heads"].astype(int)',
            "statuses that are none",
        ),
        ("random.random(count)", "ex.falls(3)", "in draw: InputError: states"),
        ('"status": 0 *', '"status": 99 +', "99 is not a valid Status"),
        ('0 * drawn["heads"]', '0 * drawn["tails"]', "line 16, in observe: KeyError: 'tails'"),
        ('**drawn, "', '**drawn, "less": drawn["heads"][1:], "', "observe returns columns of several shapes"),
        ('return table["heads"]', 'return table["heads"][1:]', "boolean index did not match"),
        ("tally.heads +=", "tally.tails +=", "has no attribute 'tails'"),
        ("int(table", "1j * (table", "complex"),
        ('**drawn, "', '**drawn, "more": np.array([{}] * len(drawn["heads"])), "', "Cannot write struct"),
    ],
)
def test_what_is_wrong_with_its_samples_is_told_in_a_sentence(right, wrong, message, capsys, tmp_path):
    status, _, err = _tried(right, wrong, capsys, tmp_path)
    assert status == 1
    assert len(err.splitlines()) == 1, err
    assert "Coins" in err or "coins" in err
    assert message in err


@pytest.mark.parametrize(
    ("right", "wrong", "message"),
    [
        ("tally, columns", "bias = option(NUMBER, 'share')\n    tally, columns", "'bias' is a field"),
        (
            "tally, columns",
            "length: float = option(NUMBER, 'x')\n    tally, columns",
            "Coins.length is the name of a method",
        ),
        ("tally, columns", "samples = 50\n    tally, columns", "Coins.samples is an option; declare it anew"),
        ("heads: int", "heads = 0", "HeadCounts.heads has no kind; write heads: int"),
        ("SampledScene):", "SampledScene)", "expected ':'"),
        ('{"share": tally.heads / self.samples}', "[1]", "'list' object is not a mapping"),
        ("tally.heads / self", "tally.heads / 0 / self", "division by zero"),
        ("tally.heads / self.samples", "self.draw", "is not JSON serializable"),
    ],
)
def test_what_is_wrong_with_its_code_is_raised_as_it_is(right, wrong, message, capsys, tmp_path):
    with pytest.raises((TypeError, SyntaxError, ZeroDivisionError), match=message):
        _tried(right, wrong, capsys, tmp_path)


@pytest.mark.parametrize("name", ["jobs", "quiet", "resume", "call", "command_line"])
def test_an_option_may_not_have_the_name_of_a_setting(name, capsys, tmp_path):
    wrong = f"{name}: float = option(NUMBER, 'x')\n    tally, columns"
    status, _, err = _tried("tally, columns", wrong, capsys, tmp_path)
    assert status == 2
    assert f"{name} is the name of a setting of runs" in err


def _tried(right, wrong, capsys, tmp_path):
    """What the command says of a scene with a mistake."""
    file = tmp_path / f"my{abs(hash((right, wrong)))}.py"
    assert right in RIGHT
    file.write_text(RIGHT.replace(right, wrong))
    return said(capsys, "run", f"{file}:Coins", "--samples", "100", "--out", tmp_path / "run", "--quiet")


def test_seed_and_samples_may_be_declared_anew_with_other_defaults():
    class Few(Coins):
        samples: int = option(whole_from(10, 200), "number of coins", default=50)
        seed: int = option(whole_from(1), "seed", default=3)

    run = ex.run(Few)
    assert (run.summary["samples"], run.summary["seed"]) == (50, 3)
    with pytest.raises(ex.InputError, match="samples = 9 must be a whole number"):
        ex.run(Few, samples=9)


def test_statuses_and_numbers_of_any_kind_can_be_stored(tmp_path):
    class Odd(Coins):
        def observe(self, drawn):
            return {**drawn, "status": np.zeros(drawn["heads"].size, int)}

        def summarise(self, tally):
            return {"none": np.float64("nan"), "many": np.int64(3), "list": np.arange(2)}

    run = ex.run(Odd, samples=100, out=tmp_path / "run")
    assert run.verify() == []
    assert [run.summary[name] for name in ("none", "many", "list")] == [None, 3, [0, 1]]
    assert json.loads((tmp_path / "run" / "summary.json").read_text()) == run.summary


def test_sums_of_numpy_are_counts():
    class Summed(Coins):
        def count(self, tally, table):
            tally.heads += table["heads"].sum()

    assert ex.run(Summed, samples=100).summary["share"] == ex.run(Coins, samples=100).summary["share"]


def test_its_numbers_are_told_without_its_options():
    told = ex.run(Coins, samples=100).headline
    assert [line.partition(":")[0] for line in told] == ["share"]


def test_without_its_file_a_run_is_read_and_goes_on_where_the_file_is_now(capsys, tmp_path, monkeypatch):
    file, folder = tmp_path / "own_scene.py", tmp_path / "run"
    file.write_text(Path(EXAMPLE.removesuffix(":Periods")).read_text())
    words = ["--samples", "100", "--out", folder, "--no-figures"]
    assert said(capsys, "run", f"{file}:Periods", *words)[0] == 0
    summary = ex.open(folder).summary
    (moved := tmp_path / "elsewhere" / "own_scene.py").parent.mkdir()
    file.rename(moved)
    monkeypatch.setattr(scenes, "_own", {})
    sys.modules.pop("own_scene")
    next((folder / "chunks").iterdir()).unlink()
    for command in ("resume", "summary"):
        status, _, err = said(capsys, command, folder, "--trust")
        assert status == 2
        assert "the file is gone; put it back, or" in err
    assert "nearflat run NEW.py:Periods ... --resume --out DIR" in err
    assert said(capsys, "run", f"{moved}:Periods", *words, "--resume")[0] == 0
    assert ex.open(folder).summary == summary
    assert said(capsys, "verify", folder)[0] == 0


def test_a_changed_scene_is_not_run_and_the_stored_summary_stays(capsys, tmp_path, monkeypatch):
    file, folder = tmp_path / "own_scene.py", tmp_path / "run"
    file.write_text(Path(EXAMPLE.removesuffix(":Periods")).read_text())
    assert said(capsys, "run", f"{file}:Periods", "--samples", "100", "--out", folder, "--no-figures")[0] == 0
    before = (folder / "summary.json").read_bytes()
    file.write_text(file.read_text().replace('"mean": mean', '"mean": 2 * mean'))
    monkeypatch.setattr(scenes, "_own", {})
    sys.modules.pop("own_scene")
    status, _, err = said(capsys, "summary", folder, "--trust")
    assert status == 2
    assert f"{file}:Periods was changed since" in err
    assert (folder / "summary.json").read_bytes() == before


def test_a_scene_in_a_script_runs_in_processes_and_its_folder_can_be_checked(tmp_path, capsys):
    """The script is not run again by what looks at the folder."""
    script, folder, log = tmp_path / "script.py", tmp_path / "run", tmp_path / "log"
    script.write_text(
        f"{RIGHT}\n\nif __name__ == '__main__':\n    import explorer as ex\n\n"
        "    how = dict(samples=100, chunk_size=64, progress=False)\n"
        f"    stored = ex.run(Coins, backend='processes', out={str(folder)!r}, **how)\n"
        "    assert stored.summary['digest'] == ex.run(Coins, **how).summary['digest']\n"
        f"    assert ex.open({str(folder)!r}).summary == stored.summary\n"
        f"with open({str(log)!r}, 'a') as file:\n    file.write(__name__ + ' ')\n"
    )
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    begun = log.read_text()
    for _ in range(2):
        assert said(capsys, "verify", folder)[:2] == (0, "intact\n")
        assert said(capsys, "status", folder)[0] == 0
        script.unlink(missing_ok=True)
    assert log.read_text() == begun


def test_the_folder_of_a_script_is_continued_from_the_script_if_it_is_trusted_and_unchanged(tmp_path, capsys):
    script, folder = tmp_path / "coin_script.py", tmp_path / "run"
    lines = "    import explorer as ex\n\n    ex.run(Coins, samples=100, chunk_size=64, progress=False, out="
    script.write_text(f"{RIGHT}\n\nif __name__ == '__main__':\n{lines}{str(folder)!r})\n")
    subprocess.run([sys.executable, script], check=True)
    assert said(capsys, "resume", folder)[0] == 2
    assert said(capsys, "resume", folder, "--trust")[0] == 0
    assert said(capsys, "verify", folder)[:2] == (0, "intact\n")
    script.write_text(f"{script.read_text()}# other\n")
    assert str(script) in "".join(said(capsys, "verify", folder)[1:])
