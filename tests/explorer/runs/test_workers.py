"""Workers of every kind, killed and stopped, give the numbers of an undisturbed run."""

import contextlib
import json
import os
import random
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import coins
import psutil
import pytest
from coins import SMALL, Coins

import explorer as ex
from explorer.runs import workers
from explorer.runs.folder import identity

SCENE = f"{Path(coins.__file__).resolve()}:Coins"
MANY = {"samples": 24_000, "chunk_size": 1024, "seed": 3, "keep": "all"}
# The command hears Ctrl-C also where the suite runs in the background, where it would inherit that it is ignored.
PROGRAM = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
from explorer.commands.main import main
sys.exit(main())
"""


def nearflat(*words, seconds=0.0, **options):
    """The command in a process of its own; each of its chunks takes so long."""
    environment = {**os.environ, "COINS_SECONDS": str(seconds), "PYTHONPATH": os.pathsep.join(sys.path)}
    return subprocess.Popen(
        [sys.executable, "-c", PROGRAM, *map(str, words)],
        **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "env": environment, **options},
    )


def command(folder, *more):
    given = [f"--{name.replace('_', '-')}={value}" for name, value in MANY.items()]
    return ["run", SCENE, *given, "--no-figures", "--resume", "--json", "--out", folder, *more]


def there(folder):
    return len([*folder.glob("chunks/chunk-*.parquet")])


def until(condition):
    """Wait for what happens soon, and on a busy machine later."""
    limit = time.monotonic() + 120.0
    while not condition():
        assert time.monotonic() < limit
        time.sleep(0.005)


@pytest.fixture(scope="module")
def digest():
    return ex.run(Coins, **MANY).summary["digest"]


@pytest.mark.parametrize(
    ("how", "stored"),
    [
        ({"jobs": 1}, True),
        ({"jobs": 5}, False),
        ({"backend": "processes"}, True),
        ({"backend": "dask", "jobs": 1}, False),
    ],
)
def test_one_digest_for_any_jobs_backend_and_place(how, stored, digest, tmp_path):
    run = ex.run(Coins, out=tmp_path / "run" if stored else None, figures=False, progress=False, **how, **MANY)
    assert run.summary["digest"] == digest
    assert [chunk.number for chunk in run.chunks] == [*range(24)]


def test_killed_at_random_moments_a_run_ends_with_the_same_digest(digest, tmp_path):
    draw, kills = random.Random(time.time_ns()), 0
    while True:
        done = nearflat(*command(tmp_path / "run"), seconds=0.1)
        until(lambda done=done: done.poll() is not None or (tmp_path / "run" / "run.json").exists())
        with contextlib.suppress(subprocess.TimeoutExpired):
            out, err = done.communicate(timeout=draw.uniform(0.0, 0.5) + 0.7 * kills)
            break
        done.kill()
        done.communicate()
        kills += 1
    assert (done.returncode, kills > 0) == (0, True), err
    assert json.loads(out)["digest"] == digest
    assert not [*(tmp_path / "run").rglob("*.tmp")]
    assert not (tmp_path / "run" / "bad").exists()


@pytest.mark.parametrize(
    ("number", "backend"),
    [
        (signal.SIGINT, "threads"),
        (signal.SIGTERM, "threads"),
        (signal.SIGHUP, "threads"),
        (signal.SIGINT, "processes"),
        (signal.SIGINT, "dask"),
    ],
)
def test_the_first_signal_keeps_running_chunks_and_tells_how_to_go_on(number, backend, digest, tmp_path):
    if signal.getsignal(number) is signal.SIG_IGN:
        pytest.skip("whoever started the tests has it ignored, and so does the run")
    folder = tmp_path / "run"
    done = nearflat(*command(folder, "--backend", backend), seconds=0.2, start_new_session=True)
    until(lambda: done.poll() is not None or there(folder) >= 2)
    before = there(folder)
    os.killpg(done.pid, number)  # as a terminal does: to the processes too
    _, err = done.communicate(timeout=60)
    assert done.returncode == 130, err
    assert "stopping when the running chunks are done; interrupt again to stop now" in err
    assert f"of 24 chunks done; continue with: nearflat resume {folder}" in err.splitlines()[-1]
    assert before <= there(folder) < 24
    assert not (folder / "summary.json").exists()
    assert not [*folder.rglob("*.tmp")]
    assert ex.open(folder).resume(progress=False).summary["digest"] == digest


def test_the_second_signal_ends_at_once(tmp_path):
    folder = tmp_path / "run"
    done = nearflat(*command(folder), seconds=100.0)
    until(lambda: done.poll() is not None or (folder / "run.json").exists())
    time.sleep(0.5)
    for _ in range(2):
        done.send_signal(signal.SIGINT)
        time.sleep(0.2)
    assert "stopped; continue with: nearflat resume" in done.communicate(timeout=50)[1]  # chunks take longer
    assert done.returncode == 130


def family(pid):
    """The processes that compute chunks of another."""
    children = psutil.Process(pid).children(recursive=True)
    return [
        each for each in children if "resource_tracker" not in " ".join(each.cmdline()) and not each.children()
    ]


def test_a_killed_process_ends_the_run_with_a_sentence_and_resume_goes_on(digest, tmp_path):
    folder = tmp_path / "run"
    done = nearflat(*command(folder, "--backend", "processes"), seconds=0.2)
    until(lambda: done.poll() is not None or there(folder) >= 2)
    family(done.pid)[0].kill()
    _, err = done.communicate(timeout=60)
    assert done.returncode == 1
    assert "backend processes: a worker was killed" in err.splitlines()[-1]
    assert err.endswith(f"continue with: nearflat resume {folder}\n")
    assert ex.open(folder).resume(progress=False).summary["digest"] == digest


def test_processes_end_with_the_one_that_began_them(tmp_path):
    folder = tmp_path / "run"
    done = nearflat(*command(folder, "--backend", "processes"), seconds=0.2)
    until(lambda: done.poll() is not None or there(folder) >= 2)
    orphans = family(done.pid)
    assert orphans
    done.kill()
    done.communicate()
    _, alive = psutil.wait_procs(orphans, timeout=10)
    assert alive == []


def test_what_runs_in_a_thread_leaves_signals_alone(digest):
    before, found = signal.getsignal(signal.SIGINT), []
    thread = threading.Thread(target=lambda: found.append(ex.run(Coins, progress=False, **MANY).summary["digest"]))
    thread.start()
    thread.join()
    assert found == [digest]
    assert signal.getsignal(signal.SIGINT) is before


def test_a_worker_that_would_compute_other_numbers_is_refused(tmp_path):
    scene = Coins(**SMALL)
    with pytest.raises(ex.RunError, match="the worker would compute other numbers than this run"):
        workers.compute(scene, {**identity(scene), "kernels": "others"}, None, 0)
    assert identity(scene)["code"] != identity(type("Other", (Coins,), {"__module__": "x"})(**SMALL))["code"]


class Huge(Coins):
    """Does not fit."""

    def draw(self, random, count):
        raise MemoryError


class Faulty(Coins):
    """Has a mistake."""

    def draw(self, random, count):
        return 1 / 0


@pytest.mark.parametrize("backend", ["threads", "processes"])
def test_what_goes_wrong_in_a_chunk_comes_back_from_every_worker(backend):
    how = {"backend": backend, "jobs": 1, "progress": False, **SMALL}
    with pytest.raises(ex.RunError, match="512 samples do not fit into memory; give a smaller chunk_size"):
        ex.run(Huge, **how)
    with pytest.raises(
        ex.RunError, match=r"test_workers\.py, line \d+, in draw: ZeroDivisionError: division by zero"
    ):
        ex.run(Faulty, **how)


def test_progress_is_shown_where_a_run_takes_longer_than_two_seconds(tmp_path):
    given = ("--samples", 512, "--chunk-size", 128, "--jobs", 1, "--no-figures")
    runs = [
        (shown, nearflat("run", SCENE, *given, *words, "--out", tmp_path / f"{seconds}{shown}", seconds=seconds))
        for seconds, words, shown in ((1.6, (), True), (1.6, ("--quiet",), False), (0.0, (), False))
    ]
    for shown, done in runs:
        _, err = done.communicate(timeout=60)
        assert done.returncode == 0, err
        assert ("samples/s" in err) is shown
        assert "\r" not in err  # a log file, where nothing is drawn over


# A dask cluster


def dask(kind, *words):
    """A scheduler or a worker on the loopback, in a process of its own."""
    common = ["--host", "127.0.0.1", "--dashboard-address", "127.0.0.1:0"]
    more = ["--nthreads", "1", "--no-nanny"] if kind == "worker" else []
    full = [sys.executable, "-m", f"distributed.cli.dask_{kind}", *words, *more, *common]
    environment = {**os.environ, "COINS_SECONDS": "0.1", "PYTHONPATH": os.pathsep.join(sys.path)}
    return subprocess.Popen(full, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment)


@contextlib.contextmanager
def a_cluster(count):
    """A real scheduler and its workers; yields its address and the workers' processes."""
    distributed = pytest.importorskip("distributed")
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{probe.getsockname()[1]}"
    running = [dask("scheduler", "--port", address.rpartition(":")[2])]
    running += [dask("worker", address) for _ in range(count)]
    try:
        with distributed.Client(address, timeout=120) as client:
            if count:
                client.wait_for_workers(count, timeout=120)
        yield address, running[1:]
    finally:
        for process in running:
            process.kill()
            process.wait()


def killing(folder, worker):
    """Kill a worker as soon as there are a few chunks; a list with the moment."""
    moment = []

    def kill():
        until(lambda: there(folder) > 2)
        worker.kill()
        moment.append(time.monotonic())

    threading.Thread(target=kill).start()
    return moment


def test_a_cluster_loses_its_workers_one_after_the_other(digest, tmp_path):
    """With one of two a run ends as it would; without any that is told in ten seconds, and it can be stopped."""
    first, second, third = (tmp_path / name for name in ("first", "second", "third"))
    with a_cluster(2) as (address, workers):
        where = {"backend": "dask", "scheduler": address, "progress": False, "figures": False}
        lost = killing(first, workers[0])
        assert ex.run(Coins, out=first, **where, **MANY).summary["digest"] == digest
        assert lost

        lost = killing(second, workers[1])
        told = f"{address}: there is no worker; start one with: dask worker {address}; continue with: .*resume"
        with pytest.raises(ex.RunError, match=told):
            ex.run(Coins, out=second, **where, **MANY)
        assert time.monotonic() - lost[0] < 10.0
        assert 2 < there(second) < 24
        assert ex.open(second).resume(progress=False).summary["digest"] == digest

        done = nearflat(*command(third, "--backend", "dask", "--scheduler", address))
        until((third / "run.json").exists)
        time.sleep(1.5)
        done.send_signal(signal.SIGTERM)
        _, err = done.communicate(timeout=10)
    assert done.returncode == 130
    assert "stopped with 0 of 24 chunks done; continue with: nearflat resume" in err


def test_a_scheduler_that_is_not_there_is_named(tmp_path, monkeypatch):
    distributed = pytest.importorskip("distributed")
    patient, address = distributed.Client, "tcp://127.0.0.1:9"
    monkeypatch.setattr(distributed, "Client", lambda address, timeout: patient(address, timeout=0.5))
    with pytest.raises(ex.RunError, match=f"{address}: cannot be reached"):
        ex.run(Coins, out=tmp_path / "run", backend="dask", scheduler=address, progress=False, **SMALL)
