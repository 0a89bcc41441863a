"""Runs as users hold them: numbers, samples, pictures, status; opened, mended, merged."""

import shutil

import pytest
from coins import SMALL, Coins

import explorer as ex
from explorer.commands.main import main
from explorer.errors import RunError


def test_a_stored_run_is_opened_mended_and_asked_again(finished):
    digest = finished.summary["digest"]
    finished.chunks[3].content.unlink()
    (finished.folder / "summary.json").unlink()
    (finished.folder / "figures" / "bars.svg").unlink()
    opened = ex.open(str(finished.folder))
    far = opened.status
    assert (far.scene, far.chunks_done, far.chunks, far.samples_done) == ("coins", 4, 5, 1988)
    assert (far.status, far.missing) == ({"ok": 1988}, ("chunks", "summary"))
    assert opened.verify() == ["1 of 5 chunks are missing: 3"]
    assert "4 of 5 chunks; resume() computes the others" in repr(opened)
    with pytest.raises(ex.RunError, match=r"1 of 5 chunks are missing; continue with: nearflat resume"):
        _ = opened.summary
    assert opened.resume(progress=False).verify() == []
    assert opened.status.missing == ()
    assert opened.summary["digest"] == digest
    assert ex.run(Coins, **{key: opened.options[key] for key in SMALL}).summary == opened.summary


def test_many_missing_chunks_are_told_in_a_few_lines(finished):
    longer = ex.run(Coins, out=finished.folder, **{**SMALL, "samples": 512 * 30}, figures=False)
    for chunk in longer.chunks[5:]:
        chunk.content.unlink()
    (fault,) = longer.verify()
    assert fault.startswith("25 of 30 chunks are missing: 5, 6, 7")
    assert len(fault) < 100


def test_samples_are_tables_with_status_by_name(finished):
    frame = finished.frame(["height", "status"])
    assert list(frame) == ["height", "status"]
    assert len(frame) == 2500
    assert set(frame["status"]) == {"ok"}
    assert frame["height"].mean() == pytest.approx(finished.summary["mean"], abs=1e-12)
    table = finished.arrow()
    assert table.schema.field("height").metadata[b"unit"] == b"length"
    assert table.num_rows == 2500
    for read in (finished.arrow, finished.frame, finished.tables):
        with pytest.raises(ex.InputError, match="column 'hight' is not known; did you mean 'height'"):
            read(["hight"])
        with pytest.raises(ex.InputError, match="columns = 'height': give a list of words"):
            read("height")


@pytest.mark.parametrize(("keep", "rows"), [("none", 0), ("near", 250), ("all", 2500)])
def test_counts_are_of_all_samples_whichever_rows_are_kept(keep, rows, finished):
    run = ex.run(Coins, **{**SMALL, "keep": keep})
    assert abs(run.arrow().num_rows - rows) <= 30
    numbers = {name: run.summary[name] for name in ("share", "mean", "status")}
    assert numbers == {name: finished.summary[name] for name in numbers}


def test_a_run_describes_itself_in_a_few_lines(finished):
    assert repr(finished).startswith(f"Run of coins, stored in {finished.folder}\n  ")
    assert repr(ex.run(Coins, samples=10)).startswith("Run of coins, in memory\n  ")
    assert "<li>share: " in finished._repr_html_()


def test_summary_json_is_that_of_the_chunks_and_can_be_added_up_anew(finished):
    path = finished.folder / "summary.json"
    right = path.read_text()
    for wrong in (right.replace('"share": 0.', '"share": 0.1'), "{", right + " "):
        path.write_text(wrong)
        opened = ex.open(finished.folder)
        assert opened.summary == finished.summary
        assert opened.verify() == ["summary.json: does not belong to these chunks; run `nearflat summary`"]
        assert main(["summary", str(finished.folder)]) == 0
        assert opened.verify() == []
        assert path.read_text() == right


def test_a_finished_run_is_read_and_summed_up_where_nothing_can_be_written(finished):
    for path in (finished.folder, *finished.folder.rglob("*")):
        path.chmod(0o555 if path.is_dir() else 0o444)
    opened = ex.open(finished.folder)
    assert main(["summary", str(finished.folder)]) == 0
    assert opened.verify() == []
    for path in (finished.folder, *finished.folder.rglob("*")):
        path.chmod(0o755)


class Nothing(Coins):
    """Finds, when all is counted, that nothing can be said."""

    def summarise(self, tally):
        raise RunError("none of the samples is a state; look at bias")


def test_input_that_only_the_whole_run_shows_to_be_useless_is_told_and_chunks_are_kept(tmp_path):
    for where in ({}, {"out": tmp_path / "run"}):
        with pytest.raises(ex.RunError, match="none of the samples is a state; look at bias"):
            ex.run(Nothing, samples=10, progress=False, **where)
    assert len([*(tmp_path / "run" / "chunks").iterdir()]) == 1


# Pictures


def test_pictures_are_drawn_by_name_with_keywords_and_on_axes_of_a_user(finished):
    from matplotlib.figure import Figure

    ax = Figure().add_subplot()
    assert finished.pictures == ["bars"]
    assert finished.figure("bars", ax=ax, width=0.2) is ax.figure
    assert ax.patches[0].get_width() == 0.2
    assert len(finished.figure("bars").axes) == 1
    for name, message in (("bras", "'bras' is not known; did you mean 'bars'"), (None, "None is not known")):
        with pytest.raises(ex.InputError, match=f"figure {message}"):
            finished.figure(name)


def test_a_run_draws_the_formats_that_were_asked_for_and_resume_those_that_are_missing(tmp_path):
    run = ex.run(Coins, out=tmp_path / "run", figures=False, **SMALL)
    drawn = run.folder / "figures"
    assert not drawn.exists()
    assert run.status.missing == ()
    for how, files in (
        ({"figures": False}, set()),
        ({"format": "pdf"}, {"bars.pdf"}),
        ({}, {"bars.pdf"}),
        ({"format": ["svg", "png"]}, {"bars.pdf", "bars.svg", "bars.png"}),
    ):
        run.resume(progress=False, **how)
        assert {path.name for path in drawn.glob("*")} == files
    before = {path: path.stat().st_mtime_ns for path in drawn.iterdir()}
    (drawn / "bars.png").unlink()
    run.resume(progress=False)
    assert {path for path in drawn.iterdir() if path.stat().st_mtime_ns != before[path]} == {drawn / "bars.png"}
    ex.run(Coins, out=run.folder, exist="replace", format="svg", **SMALL)
    assert {path.name for path in drawn.iterdir()} == {"bars.svg"}


def test_pictures_are_drawn_anew_where_samples_were_added(finished):
    path = finished.folder / "figures" / "bars.png"
    path.write_bytes(b"of fewer samples")
    finished.resume(progress=False)
    assert path.read_bytes() == b"of fewer samples"
    ex.run(Coins, out=finished.folder, **{**SMALL, "samples": 4000})
    assert path.read_bytes() != b"of fewer samples"


# Several runs as one


@pytest.fixture(scope="module")
def several():
    how = ({"seed": 2}, {"seed": 1, "keep": "none"}, {"seed": 3, "samples": 700, "chunk_size": 256})
    return [ex.run(Coins, **{**SMALL, **each}) for each in how]


def test_merged_runs_add_up_whatever_their_order_and_what_they_keep(several):
    both = ex.merge(*several)
    assert both.summary["samples"] == 5700 == both.summary["status"]["ok"]
    assert both.summary["seed"] == [1, 2, 3]
    heads = sum(round(run.summary["share"] * run.scene.samples) for run in several)
    assert both.summary["share"] == heads / 5700
    assert both.arrow().num_rows == 3200
    assert both.summary == ex.merge(ex.merge(*several[1:]), several[0]).summary
    assert (both.folder, both.status.chunks_done, both.verify()) == (None, 13, [])
    assert repr(both).startswith("Run of coins, 3 merged")
    assert both.figure("bars").axes
    with pytest.raises(ex.InputError, match="resume each of them"):
        both.resume()


def test_runs_that_do_not_go_together_are_not_merged(several, finished):
    first = several[0]
    for other, message in (
        (first, "two runs have seed 2"),
        (
            ex.run(Coins, **{**SMALL, "bias": 0.25}),
            "bias = 0.5, another 0.25|bias = 0.25, another 0.5",
        ),
        ("run", "is no run; give runs one after the other"),
    ):
        with pytest.raises(ex.InputError, match=message):
            ex.merge(first, other)
    with pytest.raises(ex.InputError, match="merge takes two or more"):
        ex.merge(first)
    folder = shutil.copytree(finished.folder, finished.folder.parent / "other")
    next((folder / "chunks").iterdir()).unlink()
    with pytest.raises(ex.RunError, match="1 of 5 chunks are missing"):
        ex.merge(first, ex.open(folder))


def test_resume_takes_what_changes_no_number_and_nothing_else(finished):
    with pytest.raises(ex.InputError, match="resume takes no such option"):
        ex.run(Coins, **SMALL).resume(samples=3)
    for setting in ({"exist": "replace"}, {"rng": 7}, {"out": "elsewhere"}, {"samples": 3}):
        with pytest.raises(ex.InputError, match="resume takes no such option; known: jobs, backend"):
            finished.resume(**setting)
