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


def interrupted(call, begun):
    """Press Ctrl-C in this thread once `begun()` says that a call has begun its work."""
    over = threading.Event()

    def press():
        while not (begun() or over.is_set()):
            time.sleep(0.001)
        _thread.interrupt_main()

    def pressed():
        threading.Thread(target=press).start()
        try:
            call()
        finally:
            over.set()

    with pytest.raises(KeyboardInterrupt):
        pressed()


def threads_end(before):
    """Whether all threads that were not there before come to their end."""
    end = time.monotonic() + 600.0
    while set(threading.enumerate()) - before:
        if time.monotonic() > end:
            return False
        time.sleep(0.01)
    return True


def cost(call):
    """Processor time of a call, in seconds."""
    start = time.process_time()
    call()
    return time.process_time() - start


def interrupted_in_kernels(call):
    """Press Ctrl-C when a call has begun a thread, in which kernels are, and wait for the end of its threads."""
    before = set(threading.enumerate())
    # One more is the thread that presses.
    interrupted(call, lambda: len(set(threading.enumerate()) - before) > 1)
    assert threads_end(before)


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
    before, seen, pressed = set(threading.enumerate()), [], threading.Event()

    def call(rows):
        seen.append(rows.start)
        pressed.wait()

    interrupted(lambda: threads.in_parts(2, 2000, call, 1), lambda: len(seen) == 2)
    pressed.set()
    assert threads_end(before)
    assert sorted(seen) == [0, 1000]


@pytest.mark.parametrize("jobs", [1, 2])
def test_ctrl_c_is_answered_while_motions_are_followed_and_none_is_begun_any_more(jobs):
    """All of them would take a year."""
    states = ex.phi_to_states(DISK, 0.3, 1.0, 0.5, np.linspace(0.5, 1.0, 20_000))
    assert ex.simulate(states[:2], 1.0).ok.all()
    asked = {"t_eval": [1e12], "observables": ["phidot"], "method": "dop853", "max_steps": 10**9}
    interrupted_in_kernels(lambda: ex.simulate(states, **asked, jobs=jobs))
    assert ex.simulate(states[:2], 1.0).ok.all()


@pytest.mark.parametrize("phidot", [1.0, 1e6])
def test_ctrl_c_ends_a_single_motion_of_very_many_steps(phidot):
    """In one call of a kernel; also of a fast one, which takes many steps in a short time."""
    states = ex.phi_to_states(DISK, 0.3, phidot, 0.5, 0.7)

    def follow(max_steps):
        how = {"method": "dop853", "accuracy": 1e-10, "max_steps": max_steps}
        return ex.simulate(states, t_eval=[1e12], observables=["phidot"], **how)

    assert follow(10**3).status_names == "step_limit"
    some = cost(lambda: follow(10**6))
    assert cost(lambda: interrupted_in_kernels(lambda: follow(10**9))) < 500 * some  # all of it costs a thousand


def test_ctrl_c_is_answered_while_many_passages_are_integrated():
    def integrate(count):
        return ex.passages(DISK, 1.0, np.full(count, 0.1), 1.0, method="rk4", accuracy=1e-11)

    assert integrate(2).ok.all()
    some = cost(lambda: integrate(2000))
    assert cost(lambda: interrupted_in_kernels(lambda: integrate(2_000_000))) < 500 * some
