"""The first signal lets running chunks finish; signals are left alone elsewhere than in the main thread."""

import os
import signal
import subprocess
import sys
import threading

import pytest

from explorer.runs.interrupt import SIGNALS, as_interrupts, graceful, was_told, withheld


def test_the_first_signal_is_noted_and_the_handlers_come_back(tmp_path, capsys):
    before = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)]
    with graceful(tmp_path, quiet=False) as stop:
        assert not stop.is_set()
        os.kill(os.getpid(), signal.SIGTERM)
        assert stop.wait(1.0)
    assert "stopping when the running chunks are done" in capsys.readouterr().err
    assert [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)] == before


def test_another_thread_handles_no_signals(tmp_path):
    before, seen = signal.getsignal(signal.SIGINT), []

    def work():
        with graceful(tmp_path, quiet=True) as stop:
            seen.append((signal.getsignal(signal.SIGINT), stop.is_set()))

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert seen == [(before, False)]


@pytest.fixture
def heard(number):
    """A signal that is not ignored; a suite that runs under nohup ignores SIGHUP."""
    before = signal.signal(number, signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL)
    yield
    signal.signal(number, before)


@pytest.mark.parametrize("number", SIGNALS)
@pytest.mark.usefixtures("heard")
def test_a_signal_to_a_command_is_an_interrupt_and_the_next_run_begins_stopped(number, tmp_path):
    with as_interrupts():
        with pytest.raises(KeyboardInterrupt):
            os.kill(os.getpid(), number)
        assert was_told()
        with graceful(tmp_path, quiet=True) as stop:
            assert stop.is_set()  # also where the interrupt was lost in a callback
    assert not was_told()


def test_what_is_ignored_stays_ignored(tmp_path):
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with as_interrupts(), graceful(tmp_path, quiet=True) as stop:
            os.kill(os.getpid(), signal.SIGHUP)
            assert not stop.is_set()
    finally:
        signal.signal(signal.SIGHUP, before)


def test_a_process_started_meanwhile_never_gets_signals():
    code = "import os, signal; os.kill(os.getpid(), signal.SIGINT); os.kill(os.getpid(), signal.SIGTERM); print(1)"
    with withheld():
        started = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (started.returncode, started.stdout) == (0, "1\n")
    assert not signal.pthread_sigmask(signal.SIG_BLOCK, ())


def test_signals_stay_withheld_where_processes_have_locks_and_queues():
    code = (
        "import signal; from multiprocessing import get_context; from explorer.runs.interrupt import *\n"
        "with withheld():\n"
        "    get_context('spawn').Lock()\n"  # starts Python's tracker of resources
        "    print(set(SIGNALS) <= signal.pthread_sigmask(signal.SIG_BLOCK, ()))\n"
        "print(signal.pthread_sigmask(signal.SIG_BLOCK, ()))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.stdout, done.stderr) == ("True\nset()\n", "")
