"""Workers of every kind, killed and stopped, give the numbers of an undisturbed run."""

import _thread
import contextlib
import io
import itertools
import json
import os
import random
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path
from types import SimpleNamespace

import coins
import psutil
import pytest
import tqdm.std
from coins import SMALL, Coins

import explorer as ex
from explorer.runs import cluster, workers
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


LIMIT = 600.0  # s for what happens soon, and on a busy machine later


class Tickets:
    """What processes need to compute chunks: one each; none once they are free."""

    def __init__(self, folder):
        self.folder = folder

    def give(self, count):
        """They compute so many chunks from now on, and wait with the next ones."""
        self.free()
        made = self.folder.with_name("made")
        made.mkdir()
        for number in range(count):
            (made / f"{number}").touch()
        made.rename(self.folder)

    def free(self):
        shutil.rmtree(self.folder, ignore_errors=True)


@pytest.fixture
def tickets(tmp_path):
    """For three chunks."""
    made = Tickets(tmp_path / "tickets")
    made.give(3)
    yield made
    made.free()


def nearflat(*words, seconds=0.0, tickets=None, **options):
    """The command in a process of its own; each of its chunks takes so long, or a ticket."""
    environment = {**os.environ, "COINS_SECONDS": str(seconds), "PYTHONPATH": os.pathsep.join(sys.path)}
    environment["COINS_TICKETS"] = str(tickets.folder) if tickets else ""
    return subprocess.Popen(
        [sys.executable, "-c", PROGRAM, *map(str, words)],
        **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "env": environment, **options},
    )


def command(folder, *more):
    given = [f"--{name.replace('_', '-')}={value}" for name, value in MANY.items()]
    return ["run", SCENE, *given, "--no-figures", "--resume", "--json", "--jobs", 2, "--out", folder, *more]


def there(folder):
    return len([*folder.glob("chunks/chunk-*.parquet")])


def until(condition):
    """Wait for what happens soon, and on a busy machine later."""
    limit = time.monotonic() + LIMIT
    while not condition():
        assert time.monotonic() < limit
        time.sleep(0.005)


def told(process, text):
    """Wait for a line of stderr with this text; all that came until then."""
    lines, guard = [], threading.Timer(LIMIT, process.kill)
    guard.start()
    for line in process.stderr:
        lines.append(line)
        if text in line:
            break
    guard.cancel()
    return "".join(lines)


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
    draw, kills = random.Random(53), 0
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
def test_the_first_signal_keeps_running_chunks_and_tells_how_to_go_on(number, backend, digest, tickets, tmp_path):
    if signal.getsignal(number) is signal.SIG_IGN:
        pytest.skip("whoever started the tests has it ignored, and so does the run")
    folder = tmp_path / "run"
    done = nearflat(*command(folder, "--backend", backend), tickets=tickets, start_new_session=True)
    until(lambda: done.poll() is not None or there(folder) == 3)
    os.killpg(done.pid, number)  # as a terminal does: to the processes too
    text = told(done, "stopping when the running chunks are done; interrupt again to stop now")
    tickets.free()
    text += done.communicate(timeout=LIMIT)[1]
    assert done.returncode == 130, text
    assert f"of 24 chunks done; continue with: nearflat resume {folder}" in text.splitlines()[-1]
    assert 3 < there(folder) < 24
    assert not (folder / "summary.json").exists()
    assert not [*folder.rglob("*.tmp")]
    assert ex.open(folder).resume(progress=False).summary["digest"] == digest


def test_the_second_signal_ends_at_once(tickets, tmp_path):
    """Also while chunks are computed that never end."""
    folder = tmp_path / "run"
    done = nearflat(*command(folder), tickets=tickets)
    until(lambda: done.poll() is not None or there(folder) == 3)
    for text in ("stopping when the running chunks are done", "stopped; continue with: nearflat resume"):
        done.send_signal(signal.SIGINT)
        assert text in told(done, text)
    done.communicate(timeout=LIMIT)
    assert done.returncode == 130


class Held(Coins):
    """Waits for a test."""

    begun, let_go, at_work = threading.Event(), threading.Event(), []

    def observe(self, drawn):
        self.at_work.append(threading.current_thread())
        self.begun.set()
        self.let_go.wait()
        return super().observe(drawn)


def test_what_is_left_at_the_second_signal_writes_nothing(tmp_path, monkeypatch):
    folder, said = tmp_path / "run", io.StringIO()
    monkeypatch.setattr(sys, "stderr", said)
    heard = signal.signal(signal.SIGINT, signal.default_int_handler)

    def twice():
        Held.begun.wait()
        _thread.interrupt_main()
        until(lambda: "interrupt again to stop now" in said.getvalue())
        _thread.interrupt_main()

    threading.Thread(target=twice).start()
    try:
        with pytest.raises(KeyboardInterrupt, match="continue with: nearflat resume"):
            ex.run(Held, out=folder, progress=False, jobs=2, **SMALL)
    finally:
        Held.let_go.set()
        signal.signal(signal.SIGINT, heard)
    until(lambda: not any(thread.is_alive() for thread in Held.at_work))
    assert there(folder) == 0
    assert not [*folder.rglob("*.tmp")]


@pytest.mark.long
@pytest.mark.filterwarnings("default")  # Jupyter's client has warnings of its own
def test_in_a_notebook_the_second_interrupt_leaves_variables_alive_and_runs_can_be_made(tmp_path, monkeypatch):
    from jupyter_client.manager import start_new_kernel

    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(sys.path))
    manager, client = start_new_kernel(startup_timeout=LIMIT)

    def message(kind, text=""):
        """The content of the next message of this kind that has this text."""
        while True:
            got = client.get_iopub_msg(timeout=LIMIT)
            if got["msg_type"] == kind and text in got["content"].get("text", ""):
                return got["content"]

    try:
        client.execute("import glob, os, explorer as ex; from coins import Coins")
        client.execute("mine, ended, pid = 42, 0, os.getpid()")
        for backend in ("threads", "processes"):
            folder, tickets = tmp_path / backend, Tickets(tmp_path / f"tickets-{backend}")
            tickets.give(3)
            client.execute(f"os.environ['COINS_TICKETS'] = {str(tickets.folder)!r}")
            call = f"ex.run(Coins, out={str(folder)!r}, figures=False, jobs=2, **{MANY}, backend="
            client.execute(f"try: {call}{backend!r})\nfinally: ended += 1", stop_on_error=False)
            until(lambda folder=folder: there(folder) == 3)
            manager.interrupt_kernel()
            message("stream", "interrupt again to stop now")
            manager.interrupt_kernel()
            error = message("error")
            assert error["ename"] == "KeyboardInterrupt"
            assert "continue with: nearflat resume" in error["evalue"]
            assert there(folder) == 3
            client.execute("print('left', glob.glob(f'/dev/shm/*-{pid}-*'))")
            assert message("stream", "left")["text"] == "left []\n"
            tickets.free()
            client.execute(f"print('again', mine, ended, {call}'threads', progress=False).status.chunks_done)")
            assert message("stream", "again")["text"].split()[1:] == ["42", str(1 + (backend != "threads")), "24"]
    finally:
        client.stop_channels()
        manager.shutdown_kernel(now=True)


@pytest.mark.parametrize(("backend", "number"), [("processes", signal.SIGINT), ("threads", signal.SIGTERM)])
def test_a_signal_after_the_answer_changes_nothing(backend, number, tmp_path):
    done = nearflat(*command(tmp_path / "run", "--backend", backend, "--quiet"))
    assert done.stdout.readline().startswith("{")
    done.send_signal(number)
    _, err = done.communicate(timeout=LIMIT)
    assert (done.returncode, err) == (0, "")


def family(pid):
    """The processes that compute chunks of another."""
    children = psutil.Process(pid).children(recursive=True)
    return [
        each for each in children if "resource_tracker" not in " ".join(each.cmdline()) and not each.children()
    ]


def test_a_killed_process_ends_the_run_with_a_sentence_and_resume_goes_on(digest, tickets, tmp_path):
    folder = tmp_path / "run"
    done = nearflat(*command(folder, "--backend", "processes"), tickets=tickets)
    until(lambda: done.poll() is not None or there(folder) == 3)
    family(done.pid)[0].kill()
    _, err = done.communicate(timeout=LIMIT)
    assert done.returncode == 1
    assert "backend processes: a worker was killed" in err.splitlines()[-1]
    assert err.endswith(f"continue with: nearflat resume {folder}\n")
    assert ex.open(folder).resume(progress=False).summary["digest"] == digest


def test_processes_end_with_the_one_that_began_them(tickets, tmp_path):
    folder = tmp_path / "run"
    done = nearflat(*command(folder, "--backend", "processes"), tickets=tickets)
    until(lambda: done.poll() is not None or there(folder) == 3)
    orphans = family(done.pid)
    assert orphans
    done.kill()
    done.communicate()
    _, alive = psutil.wait_procs(orphans, timeout=LIMIT)
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


@pytest.mark.parametrize(("step", "quiet", "shown"), [(3.0, False, True), (3.0, True, False), (0.0, False, False)])
def test_progress_is_shown_where_a_run_takes_longer_than_two_seconds(step, quiet, shown, monkeypatch, capsys):
    """By a clock that goes on by so many seconds whenever it is looked at."""
    clock = itertools.count(0.0, step)
    monkeypatch.setattr(tqdm.std, "time", lambda: next(clock))
    ex.run(Coins, progress=not quiet, **SMALL)
    assert ("samples/s" in capsys.readouterr().err) is shown


# A dask cluster


def dask(kind, *words, tickets="", path=()):
    """A scheduler or a worker on the loopback, in a process of its own. path: what Python looks at first."""
    common = ["--host", "127.0.0.1", "--dashboard-address", "127.0.0.1:0"]
    more = ["--nthreads", "1", "--no-nanny"] if kind == "worker" else []
    full = [sys.executable, "-m", f"distributed.cli.dask_{kind}", *words, *more, *common]
    path = os.pathsep.join([*map(str, path), *sys.path])
    environment = {**os.environ, "COINS_TICKETS": str(tickets), "PYTHONPATH": path}
    return subprocess.Popen(full, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment)


@contextlib.contextmanager
def a_cluster(count, tickets, path=()):
    """A real scheduler and its workers; yields a client of it, and the processes of the workers and of itself."""
    distributed = pytest.importorskip("distributed")
    file = tickets.folder.with_name("scheduler.json")
    running = [dask("scheduler", "--port", "0", "--scheduler-file", file)]
    try:
        until(lambda: running[0].poll() is not None or (file.exists() and file.read_text().endswith("}")))
        running += [
            dask("worker", "--scheduler-file", file, tickets=tickets.folder, path=path) for _ in range(count)
        ]
        with distributed.Client(scheduler_file=str(file), timeout=LIMIT) as client:
            client.wait_for_workers(count, timeout=LIMIT)
            yield client, [*running[1:], running[0]]
    finally:
        for process in running:
            process.kill()
            process.wait()


def killing(folder, worker, tickets):
    """Kill a worker as soon as there are three chunks, and let the others go on."""
    tickets.give(3)

    def kill():
        until(lambda: there(folder) == 3)
        worker.kill()
        worker.wait()
        tickets.free()

    threading.Thread(target=kill).start()


# So that a signal comes before the seconds are over after which a run without a worker ends by itself.
PATIENT = "from explorer.runs import cluster\ncluster._PATIENCE = 10**6\n"


def test_a_cluster_loses_its_workers_one_after_the_other(digest, tickets, tmp_path, monkeypatch):
    """With one of two a run ends as it would; without any that is told, and it can be stopped."""
    first, second, third = (tmp_path / name for name in ("first", "second", "third"))
    with a_cluster(2, tickets) as (client, workers):
        address = client.scheduler.address
        where = {"backend": "dask", "scheduler": address, "progress": False, "figures": False}
        killing(first, workers[0], tickets)
        assert ex.run(Coins, out=first, **where, **MANY).summary["digest"] == digest
        assert workers[0].poll() is not None

        killing(second, workers[1], tickets)
        message = f"{address}: there is no worker; start one with: dask worker {address}; continue with: .*resume"
        with pytest.raises(ex.RunError, match=message):
            ex.run(Coins, out=second, **where, **MANY)
        assert there(second) == 3
        assert ex.open(second).resume(progress=False).summary["digest"] == digest

        monkeypatch.setitem(globals(), "PROGRAM", PATIENT + PROGRAM)
        done = nearflat(*command(third, "--backend", "dask", "--scheduler", address))
        # Of what asked before, nothing is left, as it has ended.
        until(lambda: client.run_on_scheduler(lambda dask_scheduler: len(dask_scheduler.tasks)) > 0)
        done.send_signal(signal.SIGTERM)
        _, err = done.communicate(timeout=LIMIT)
    assert done.returncode == 130
    assert "stopped with 0 of 24 chunks done; continue with: nearflat resume" in err


# So that a minute without a sign of life is over soon: the scheduler answers in time, however busy the machine is.
QUICK = SimpleNamespace(monotonic=lambda: 20.0 * time.monotonic(), sleep=time.sleep)


@pytest.mark.skipif(os.name == "nt", reason="no process can be frozen there")
@pytest.mark.parametrize(
    ("frozen", "sooner", "message"),
    [(1, ("_SILENCE", 3.0), "the scheduler does not answer"), (0, ("time", QUICK), "the workers are silent")],
)
def test_a_run_ends_where_a_scheduler_or_a_worker_is_frozen(
    frozen, sooner, message, tickets, tmp_path, monkeypatch
):
    folder = tmp_path / "run"
    with a_cluster(1, tickets) as (client, processes):
        where = {"backend": "dask", "scheduler": client.scheduler.address, "progress": False, "figures": False}

        def freeze():
            until(lambda: there(folder) == 3)
            processes[frozen].send_signal(signal.SIGSTOP)
            monkeypatch.setattr(cluster, *sooner)

        threading.Thread(target=freeze).start()
        with pytest.raises(ex.RunError, match=f"{message}; continue with: .*--backend dask --scheduler tcp"):
            ex.run(Coins, out=folder, **where, **MANY)
        processes[frozen].send_signal(signal.SIGCONT)


# What workers on other machines may lack; Python runs this when it starts.
NO_NEARFLAT = """
class Hidden:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] == "explorer":
            raise ModuleNotFoundError(f"No module named {name!r}")
import sys
sys.meta_path.insert(0, Hidden())
"""
NO_FOLDER = """
from pathlib import Path
plain = Path.is_dir
Path.is_dir = lambda self: self.name != "run" and plain(self)
"""
OTHER_FOLDER = """
import os
from pathlib import Path
plain = Path.replace
Path.replace = lambda self, target: plain(self, Path(os.environ["COINS_TICKETS"]).parent / Path(target).name)
"""


@pytest.mark.parametrize(
    ("lack", "message"),
    [
        (NO_NEARFLAT, "worker tcp.*: No module named 'explorer.*"),
        (NO_FOLDER, "worker tcp.* has not this folder .*run; all machines must share it"),
        (OTHER_FOLDER, "worker tcp.* has not this folder .*run; all machines must share it"),
    ],
)
def test_what_a_worker_lacks_is_told_at_its_first_chunk(lack, message, tickets, tmp_path):
    folder = tmp_path / "run"
    (tmp_path / "sitecustomize.py").write_text(lack)
    with a_cluster(1, tickets, [tmp_path]) as (client, _):
        where = {"backend": "dask", "scheduler": client.scheduler.address, "progress": False, "figures": False}
        with pytest.raises(ex.RunError, match=f"{message}; continue with: .*--backend dask --scheduler tcp"):
            ex.run(Coins, out=folder, **where, **MANY)
    assert there(folder) == 0


@pytest.mark.parametrize("answers", [False, True])
def test_a_scheduler_that_is_not_there_or_never_answers_is_named(answers, tmp_path, monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr(cluster, "_PATIENCE", 0.5)
    with socket.socket() as silent:
        silent.bind(("127.0.0.1", 0))
        if answers:
            silent.listen()
        address = f"tcp://127.0.0.1:{silent.getsockname()[1]}"
        with pytest.raises(ex.RunError, match=f"scheduler {address}: cannot be reached .*continue with"):
            ex.run(Coins, out=tmp_path / "run", backend="dask", scheduler=address, progress=False, **SMALL)


def test_where_no_workers_can_be_started_here_a_scheduler_is_asked_for(monkeypatch):
    distributed = pytest.importorskip("distributed")

    def failing(**options):
        raise RuntimeError("Nanny failed to start.")

    monkeypatch.setattr(distributed, "LocalCluster", failing)
    with pytest.raises(ex.RunError, match=r"^backend dask: .*Nanny failed.*give the address of a scheduler"):
        ex.run(Coins, backend="dask", progress=False, **SMALL)
