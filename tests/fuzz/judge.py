"""What became of one call: a value, a refusal in a sentence, or a fault of one of six kinds."""

import contextlib
import faulthandler
import io
import pickle
import time
import warnings
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path
from unittest import mock

import numpy as np
from matplotlib.artist import Artist

import explorer as ex
from explorer.errors import words_of_the_command

from .finite import not_finite

FAULTS = ("traceback", "warning", "too long a message", "hang", "not finite", "changed argument")
LONGEST = 300  # characters of a message
DEEPEST = 20  # lists in lists: a change further down is not seen
# Seconds of processor time that a call may take, and those that it may take more for each sample. Where other
# programs slow a machine down it has a tenth of a processor at least.
SLOWEST, EACH, SHARE = 10.0, 1e-4, 0.1
STUCK = 300.0  # seconds after which the process ends with the stack of the call that does not return


@dataclass
class Verdict:
    """What became of a call. kind: 'value', 'refused' or one of FAULTS; samples: how many the value has."""

    kind: str
    text: str = ""
    seconds: float = 0.0
    samples: int = 0


def image(value, depth=DEEPEST):
    """Something that differs where the value was changed; None for what cannot be changed or seen."""
    try:
        return _image(value, depth)
    except Exception:  # an object that fails when it is looked at
        return None


def _image(value, depth):
    if isinstance(value, ex.States):
        return value.natural.tobytes(), value.status.tobytes(), pickle.dumps(value.exact)
    if isinstance(value, ex.Disk):
        return value.describe()
    if isinstance(value, dict | list | tuple) and depth == 0:
        return None
    if isinstance(value, dict):
        return {name: image(each, depth - 1) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [image(each, depth - 1) for each in value]
    if is_dataclass(value) and not isinstance(value, type):  # its fields: what it keeps of answers may grow
        return {field.name: image(getattr(value, field.name), depth) for field in fields(value)}
    if isinstance(value, Artist):  # whoever draws on one changes it
        return None
    if isinstance(value, np.ma.MaskedArray):
        return value.data.tobytes(), np.ma.getmaskarray(value).tobytes()
    if hasattr(value, "to_numpy") and getattr(value, "ndim", 0):  # objects of pandas cache what they are asked
        return [repr(entry) for entry in np.ravel(value.to_numpy(dtype=object))]
    return pickle.dumps(value)


def judge(call, arguments):
    """Call with keyword arguments and say what became of it."""
    faulthandler.dump_traceback_later(STUCK, exit=True)
    try:
        before = image(arguments)
        start, began = time.process_time(), time.monotonic()
        verdict = _called(call, arguments)
    finally:
        faulthandler.cancel_dump_traceback_later()
    verdict.seconds = max(time.process_time() - start, SHARE * (time.monotonic() - began))
    if verdict.kind in ("value", "refused"):
        if verdict.seconds > SLOWEST + EACH * verdict.samples:
            return Verdict("hang", f"{verdict.seconds:.0f} s", verdict.seconds)
        if image(arguments) != before:
            return Verdict("changed argument", "", verdict.seconds)
    return verdict


def _called(call, arguments):
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            warnings.simplefilter("ignore", UserWarning)  # those that the program means to give
            warnings.simplefilter("error", RuntimeWarning)
            value = call(**arguments)
            _ = repr(value)
    except (ex.InputError, ex.RunError) as error:
        text = str(error)
        too_long = len(text) > LONGEST and isinstance(error, ex.InputError)
        return Verdict("too long a message" if too_long or not text else "refused", text)
    except Warning as warning:
        return Verdict("warning", f"{type(warning).__name__}: {warning}")
    except Exception as error:
        place = error.__traceback__
        while place.tb_next:
            place = place.tb_next
        where = f"{place.tb_frame.f_code.co_filename}:{place.tb_lineno}"
        return Verdict("traceback", f"{type(error).__name__}: {str(error)[:200]} ({where})")
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        bad = not_finite(value)
    samples = getattr(getattr(value, "status", None), "size", 0)
    return Verdict("not finite", ", ".join(bad)) if bad else Verdict("value", samples=samples)


def judge_command(words):
    """As `judge`, of a command line; it must end with exit status 0, 1 or 2, and say why unless with 0.

    Pictures are made, but become empty files.
    """
    from matplotlib.figure import Figure

    from explorer.commands.main import main

    out, err = io.StringIO(), io.StringIO()

    def call():
        without_pixels = mock.patch.object(Figure, "savefig", lambda figure, path, **how: Path(path).touch())
        quiet = contextlib.redirect_stdout(out), contextlib.redirect_stderr(err)
        with quiet[0], quiet[1], words_of_the_command(), without_pixels:
            try:
                status = main(words)
            except SystemExit as end:
                status = 0 if end.code is None else end.code
        if status not in (0, 1, 2):
            raise AssertionError(f"exit status {status}")
        if status and not (err.getvalue() + out.getvalue()).strip():
            raise AssertionError(f"exit status {status} without a word")
        if "Traceback" in err.getvalue():
            raise AssertionError(err.getvalue()[-200:])
        return status

    verdict = judge(call, {})
    said = err.getvalue()
    if verdict.kind == "value" and said.startswith("nearflat") and len(max(said.split("\n"), key=len)) > 600:
        return Verdict("too long a message", said[:200], verdict.seconds)
    return verdict
