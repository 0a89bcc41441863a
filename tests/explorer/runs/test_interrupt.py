"""The first signal lets running chunks finish; signals are left alone elsewhere than in the main thread."""

import os
import signal
import threading

from explorer.runs.interrupt import graceful


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
