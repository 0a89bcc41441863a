"""Work in parts: all of it, in its order; and Ctrl-C is answered while a kernel is at work, which then ends."""

import _thread
import signal
import threading
import time

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.motion import threads

DISK = BODIES["uniform"]


@pytest.fixture(autouse=True)
def heard():
    """Ctrl-C, also where these tests were started by a program that had it ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def interrupted_during(call):
    """Press Ctrl-C while a call is at work in this thread."""
    timer = threading.Timer(0.1, _thread.interrupt_main)
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            call()
    finally:
        timer.cancel()


def threads_end(before, seconds=60.0):
    """Whether all threads that were not there before come to their end."""
    end = time.monotonic() + seconds
    while set(threading.enumerate()) - before:
        if time.monotonic() > end:
            return False
        time.sleep(0.01)
    return True


def test_an_error_in_one_thread_is_raised_and_the_others_are_left():
    before, begun, ended = set(threading.enumerate()), threading.Barrier(2), threading.Event()

    def call(rows):
        if rows.start == 0:
            begun.wait()
            raise ex.InputError("no")
        threads.attended(lambda: (begun.wait() and None) or ended.wait(60.0), ended.set)

    with pytest.raises(ex.InputError, match="no"):
        threads.in_parts(2, 2, call)
    assert ended.is_set()
    assert threads_end(before)


def test_ctrl_c_ends_blocks_that_threads_have_still_before_them():
    before, seen = set(threading.enumerate()), []

    def call(rows):
        seen.append(rows.start)
        time.sleep(0.05)

    interrupted_during(lambda: threads.in_parts(2, 2000, call, 1))
    assert threads_end(before)
    assert 2 <= len(seen) < 1000


@pytest.mark.parametrize("jobs", [1, 2])
def test_ctrl_c_is_answered_while_motions_are_followed_and_none_is_begun_any_more(jobs):
    """All of them would take a minute."""
    states = ex.phi_to_states(DISK, 0.3, 1.0, 0.5, np.linspace(0.5, 1.0, 20_000))
    assert ex.simulate(states[:2], 1.0).ok.all()
    before, start = set(threading.enumerate()), time.process_time()
    interrupted_during(lambda: ex.simulate(states, t_eval=[2e4], observables=["phidot"], jobs=jobs))
    assert threads_end(before)
    assert time.process_time() - start < 15.0
    assert ex.simulate(states[:2], 1.0).ok.all()


@pytest.mark.parametrize(("phidot", "end"), [(1.0, 1e7), (1e6, 10.0)])
def test_ctrl_c_ends_a_single_motion_of_very_many_steps(phidot, end):
    """It would take minutes, in one call of a kernel; also a fast one, which takes many steps in a short time."""
    states = ex.phi_to_states(DISK, 0.3, phidot, 0.5, 0.7)
    asked = {"observables": ["phidot"], "accuracy": 1e-10, "max_steps": 10**9}
    assert ex.simulate(states, t_eval=[1e-6], **asked).ok.all()
    before, start = set(threading.enumerate()), time.process_time()
    interrupted_during(lambda: ex.simulate(states, t_eval=[end], **asked))
    assert threads_end(before, 5.0)
    assert time.process_time() - start < 5.0


def test_ctrl_c_is_answered_while_many_passages_are_integrated():
    """All of them would take a minute."""
    some, many = (np.full(count, 0.1) for count in (2, 5_000_000))
    assert ex.passages(DISK, 1.0, some, 1.0, method="rk8").ok.all()
    before, start = set(threading.enumerate()), time.process_time()
    interrupted_during(lambda: ex.passages(DISK, 1.0, many, 1.0, method="rk8"))
    assert threads_end(before)
    assert time.process_time() - start < 10.0
