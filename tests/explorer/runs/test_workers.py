"""Workers of every kind, killed and stopped, give the numbers of an undisturbed run."""

import contextlib
import gc
import inspect
import json
import os
import runpy
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import psutil
import pytest
from small_runs import SMALL_RACES

import explorer as ex
from explorer.commands import main as cli
from explorer.runs import store, workers
from explorer.scenes.registry import SCENES

CHUNKS = 12
OPTIONS = {"samples": CHUNKS * 2000, "chunk_size": 2000, "seed": 3, "keep": "all"}
# The command without the pixels of its pictures, which take longer than its numbers. It hears Ctrl-C also where
# the suite runs in the background, where it would inherit that it is ignored. Its workers begin four chunks; with
# the others they wait as long as a file is there, so that a run is stopped in its middle however fast it is.
PROGRAM = """
import signal
import sys
import time
from pathlib import Path
from matplotlib.figure import Figure
from explorer.commands.main import main
from explorer.runs import workers
signal.signal(signal.SIGINT, signal.default_int_handler)
Figure.savefig = lambda _, path, **options: Path(path).touch()
hold = Path(sys.argv.pop(1))
def held(task, index, compute=workers.compute_chunk):
    while index > 3 and hold.exists():
        time.sleep(0.01)
    return compute(task, index)
workers.compute_chunk = held
sys.exit(main())
"""


def nearflat(*arguments, hold, errors=subprocess.PIPE):
    return subprocess.Popen(
        [sys.executable, "-c", PROGRAM, str(hold), *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=errors,
        text=True,
    )


def until(condition):
    """Wait for what happens soon, and on a busy machine later."""
    limit = time.monotonic() + 120.0
    while not condition():
        assert time.monotonic() < limit
        time.sleep(0.005)


def wait_for_chunks(run, folder, count):
    until(lambda: run.poll() is not None or len(store.found_chunks(folder)) >= count)


@pytest.fixture
def hold(tmp_path):
    """A file for which most chunks of `nearflat` wait until it is removed."""
    path = tmp_path / "hold"
    path.touch()
    yield path
    path.unlink(missing_ok=True)


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    """The same options in a file."""
    path = tmp_path_factory.mktemp("scene") / "races.toml"
    path.write_text(
        "\n".join(f"{name} = {value!r}" for name, value in {"scene": "race-angles", **OPTIONS}.items())
    )
    return path


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    return ex.run("race-angles", out=tmp_path_factory.mktemp("plain") / "run", **OPTIONS).summary["digest"]


def test_processes_give_the_digest_of_threads(undisturbed, tmp_path):
    run = ex.run("race-angles", out=tmp_path / "run", backend="processes", **OPTIONS)
    assert run.summary["digest"] == undisturbed


def test_a_run_that_broke_off_lets_the_processes_go_before_the_next_one_uses_them(tmp_path, monkeypatch):
    def broken(progress, status):
        raise ArithmeticError

    monkeypatch.setattr("explorer.runs.progress.Progress.advance", broken)
    with pytest.raises(ArithmeticError) as held:
        ex.run("race-angles", out=tmp_path / "run", backend="processes", jobs=2, **SMALL_RACES)
    made = [each for each in gc.get_objects() if inspect.isgenerator(each) and each.__name__ == "_by_joblib"]
    assert [each for each in made if each.gi_frame is not None] == []
    del held
    monkeypatch.undo()
    resumed = ex.run("race-angles", out=tmp_path / "run", backend="processes", jobs=2, **SMALL_RACES)
    assert resumed.summary["digest"] == ex.run("race-angles", out=None, **SMALL_RACES).summary["digest"]


def test_a_cluster_of_its_own_listens_on_the_loopback_only(tmp_path, monkeypatch):
    seen = set()

    def spied(client, digest):
        family = [psutil.Process(), *psutil.Process().children(recursive=True)]
        for each in family:
            seen.update(place.laddr.ip for place in each.net_connections("inet") if place.status == "LISTEN")

    monkeypatch.setattr(workers, "_check_kernels", spied)
    ex.run("race-angles", out=tmp_path / "run", backend="dask", jobs=1, **SMALL_RACES)
    assert seen == {"127.0.0.1"}


def test_stopped_at_random_moments_a_run_keeps_its_promises(tmp_path):
    script = Path(__file__).parents[2] / "faults" / "moments.py"
    command = [sys.executable, script, tmp_path, "threads", "3", str(time.time_ns() % 10**6), "8000"]
    rows = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=True).stdout.splitlines()
    assert len(rows) == 3
    assert [row for row in map(json.loads, rows) if row["broken"]] == []


@pytest.mark.parametrize("redirection", [">&-", "2>&-", ">&- 2>&-"])
def test_streams_that_were_closed_before_the_start_take_nothing_else(redirection, tmp_path):
    command = f"{sys.executable} -m explorer.commands.main cite --json {redirection}"
    done = subprocess.run(command, shell=True, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def test_an_output_that_is_full_is_an_error_of_one_line():
    command = f"{sys.executable} -m explorer.commands.main columns > /dev/full"
    done = subprocess.run(command, shell=True, capture_output=True, text=True, check=False)
    assert (done.returncode, len(done.stderr.splitlines())) == (1, 1), done.stderr


def test_a_scheduler_that_is_not_there_is_named(tmp_path, monkeypatch, capsys):
    distributed = pytest.importorskip("distributed")
    patient = distributed.Client
    monkeypatch.setattr(distributed, "Client", lambda address, timeout: patient(address, timeout=0.5))
    address = "tcp://127.0.0.1:9"
    words = ["run", "race-angles", "--backend", "dask", "--scheduler", address, "--out", str(tmp_path / "run")]
    assert cli.main(words) == 1
    assert f"{address}: cannot be reached" in capsys.readouterr().err.splitlines()[-1]


@pytest.mark.parametrize(("protocol", "required"), [("tls", False), ("tcp", True)])
def test_settings_for_tls_that_do_not_fit_are_told_in_a_sentence(protocol, required, tmp_path):
    dask = pytest.importorskip("dask")
    pytest.importorskip("distributed")
    address = f"{protocol}://127.0.0.1:9"
    with (
        dask.config.set({"distributed.comm.require-encryption": required}),
        pytest.raises(ex.RunError, match=f"{address}: cannot be reached .*settings for TLS"),
    ):
        ex.run("race-angles", out=tmp_path / "run", backend="dask", scheduler=address, **SMALL_RACES)


def test_a_killed_process_costs_its_chunks_a_second_try_not_the_run(undisturbed, scene, hold, tmp_path):
    done = nearflat("run", scene, "--backend", "processes", "--out", tmp_path / "run", "--json", hold=hold)
    wait_for_chunks(done, tmp_path / "run", 2)
    children = [
        child
        for child in psutil.Process(done.pid).children(recursive=True)
        if "resource_tracker" not in " ".join(child.cmdline()) and not child.children()
    ]
    assert children
    children[0].kill()
    hold.unlink()
    out, err = done.communicate(timeout=200)
    assert done.returncode == 0, err
    assert json.loads(out)["digest"] == undisturbed


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_a_stopped_run_continues_to_the_same_digest(number, undisturbed, scene, hold, tmp_path, capsys):
    folder, said = tmp_path / "run", tmp_path / "said"
    with said.open("w") as errors:
        done = nearflat("run", scene, "--jobs", 2, "--out", folder, hold=hold, errors=errors)
    wait_for_chunks(done, folder, 2)
    os.kill(done.pid, number)
    until(lambda: done.poll() is not None or "stopping when the running chunks are done" in said.read_text())
    hold.unlink()
    done.communicate(timeout=120)
    if number != signal.SIGKILL:
        assert done.returncode == 130
        assert f"continue with: nearflat resume {folder}" in said.read_text().splitlines()[-1]
        assert not list((folder / "chunks").glob(".*.tmp"))
    assert not (folder / "summary.json").exists()
    there = set(store.found_chunks(folder).values())
    assert 2 <= len(there) < CHUNKS
    assert cli.main(["resume", str(folder), "--json"]) == 0
    assert there <= set(store.found_chunks(folder).values())
    assert json.loads(capsys.readouterr().out)["digest"] == undisturbed


def test_the_commands_that_look_at_a_run(tmp_path, capsys):
    folder = tmp_path / "run"
    run = ex.run("race-angles", out=folder, samples=5000, chunk_size=1000)
    store.found_chunks(folder)[2].unlink()
    for command, status, text in (
        ("status", 0, "4 of 5 chunks, 4,000 samples"),
        ("verify", 1, "chunk 2: is missing"),
        ("summary", 1, "1 of 5 chunks are missing"),
        ("resume", 0, "wrong way: 0"),
        ("status", 0, "5 of 5 chunks"),
        ("verify", 0, "intact"),
        ("summary", 0, "wrong way: 0"),
    ):
        got = cli.main([command, str(folder)])
        said = capsys.readouterr()
        assert (got, text in said.out + said.err) == (status, True), (command, said)
    assert json.loads((folder / "summary.json").read_text())["digest"] == run.summary["digest"]


@pytest.mark.filterwarnings("ignore")
def test_chunks_are_read_by_pandas_and_duckdb(tmp_path):
    duckdb, pandas = pytest.importorskip("duckdb"), pytest.importorskip("pandas")
    run = ex.run("race-angles", out=tmp_path / "run", samples=5000, chunk_size=1000)
    places = run.folder / "chunks"
    frame = pandas.read_parquet(places)
    assert len(frame) == 5000
    ((mean,),) = duckdb.sql(f"select avg(race_angle) from '{places}/*.parquet' where eta_hat > 0").fetchall()
    assert mean == pytest.approx(frame.race_angle[frame.eta_hat > 0].mean())
    assert np.isfinite(mean)


@pytest.mark.parametrize(
    ("options", "message"), [({"jobs": 0}, "jobs = 0"), ({"backend": "gpu"}, "backend 'gpu'")]
)
def test_workers_that_cannot_be_are_refused_before_anything_is_written(options, message, tmp_path):
    with pytest.raises(ex.InputError, match=message):
        ex.run("race-angles", out=tmp_path / "run", **options, **SMALL_RACES)
    assert not (tmp_path / "run").exists()


def dask(kind, *words):
    """A scheduler or a worker on the loopback, in a process of its own."""
    common = ["--host", "127.0.0.1", "--dashboard-address", "127.0.0.1:0"]
    more = ["--nthreads", "1", "--no-nanny"] if kind == "worker" else []
    command = [sys.executable, "-m", f"distributed.cli.dask_{kind}", *words, *more, *common]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


@contextlib.contextmanager
def a_cluster(workers):
    """A real scheduler and its workers; yields its address and their processes."""
    import distributed

    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    address = f"tcp://127.0.0.1:{port}"
    running = [dask("scheduler", "--port", str(port)), *(dask("worker", address) for _ in range(workers))]
    try:
        with distributed.Client(address, timeout=120) as client:
            if workers:
                client.wait_for_workers(workers, timeout=120)
        yield address, running[1:]
    finally:
        for process in running:
            process.kill()
            process.wait()


@pytest.fixture(scope="module")
def cluster():
    """The address of a cluster of two workers. Tests that need it stand last."""
    with a_cluster(2) as (address, _):
        yield address


def test_a_cluster_without_workers_is_told_within_ten_seconds_with_how_to_start_one(tmp_path):
    with a_cluster(0) as (address, _):
        began = time.monotonic()
        with pytest.raises(
            ex.RunError, match=f"{address}: there is no worker; start one with: dask worker {address}"
        ):
            ex.run("race-angles", out=tmp_path / "run", backend="dask", scheduler=address, **SMALL_RACES)
        assert time.monotonic() - began < 10.0
    assert ex.open(tmp_path / "run").resume().status.chunks_done == 5


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_run_that_waits_for_a_worker_can_be_stopped(number, scene, hold, tmp_path):
    said = tmp_path / "said"
    with a_cluster(0) as (address, _), said.open("w") as errors:
        words = ("run", scene, "--backend", "dask", "--scheduler", address, "--out", tmp_path / "run")
        done = nearflat(*words, hold=hold, errors=errors)
        until((tmp_path / "run" / "run.json").exists)
        time.sleep(1.0)
        done.send_signal(number)
        done.communicate(timeout=5.0)
    assert done.returncode == 130
    assert "stopped with 0 of 12 chunks done; continue with: nearflat resume" in said.read_text()


def test_the_last_worker_lost_is_told_and_finished_chunks_stay(tmp_path):
    folder, lost = tmp_path / "run", []
    options = {"samples": 2_000_000, "chunk_size": 4096, "eta_hat": "1e-4:1e-2", "keep": "none", "figures": False}

    def kill(worker):
        until(lambda: len(store.found_chunks(folder)) > 2)
        worker.kill()
        lost.append(time.monotonic())

    with a_cluster(1) as (address, (worker,)):
        killer = threading.Thread(target=kill, args=(worker,))
        killer.start()
        with pytest.raises(
            ex.RunError, match=rf"{address}: there is no worker; .*then continue with: .*resume\(\)"
        ):
            ex.run("race-angles", out=folder, backend="dask", scheduler=address, progress=False, **options)
        told = time.monotonic()
        killer.join()
    assert told - lost[0] < 10.0
    there = set(store.found_chunks(folder).values())
    assert 2 < len(there) < 489
    resumed = ex.open(folder).resume(progress=False)
    assert there <= set(store.found_chunks(folder).values())
    assert resumed.verify() == []


@pytest.fixture
def own_scene():
    """The documented scene of a user, from a file that no worker can import; forgotten at the end."""
    known = dict(SCENES)
    module = runpy.run_path(str(Path(__file__).parents[3] / "docs" / "examples" / "own_scene.py"))
    yield module["Periods"]
    SCENES.clear()
    SCENES.update(known)


@pytest.mark.parametrize("backend", ["threads", "processes", "dask"])
def test_a_scene_of_a_user_has_workers_of_every_kind(backend, own_scene, request, tmp_path):
    where = {"scheduler": request.getfixturevalue("cluster")} if backend == "dask" else {}
    options = {"samples": 300, "chunk_size": 100, "speed": 1.5}
    held = ex.run("periods", **options)
    assert held.summary["mean"] == pytest.approx(held.frame()["period"].mean())
    run = ex.run(own_scene, out=tmp_path / "run", backend=backend, **where, **options)
    assert run.summary == held.summary
    store.found_chunks(run.folder)[1].unlink()
    assert ex.open(run.folder).resume().summary == run.summary
    assert ex.merge(run, ex.run("periods", rng=1, **options)).summary["known"] == 600


def test_a_dask_cluster_gives_the_digest_of_threads(undisturbed, scene, cluster, tmp_path, capsys):
    words = ["run", scene, "--json", "--backend", "dask", "--scheduler", cluster, "--out", tmp_path / "run"]
    assert cli.main(list(map(str, words))) == 0
    assert json.loads(capsys.readouterr().out)["digest"] == undisturbed


def test_workers_with_other_kernels_are_refused_by_name(cluster, tmp_path, monkeypatch):
    monkeypatch.setattr(workers.compiled, "source_digest", lambda: "of another version")
    with pytest.raises(ex.RunError, match=r"tcp://127\.0\.0\.1:\d+: the worker has other kernels than this run"):
        ex.run("race-angles", out=tmp_path / "run", backend="dask", scheduler=cluster, **SMALL_RACES)
    monkeypatch.undo()
    task = workers.Task(ex.open(tmp_path / "run").scene, "", None, "of another version", None)
    with pytest.raises(ex.RunError, match="chunk 0: the worker has other kernels"):
        workers.compute_chunk(task, 0)
