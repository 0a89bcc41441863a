"""A headless Chromium, driven by its own protocol over two pipes: no driver and no package is needed.

https://chromedevtools.github.io/devtools-protocol: messages are JSON, ended by a zero byte. A command has an
id and is answered by a message with that id; messages without one are events.
"""

import json
import os
import select
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from explorer.errors import InputError

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
_PATIENCE = 120.0  # s for one answer, also on a machine that does much else
_OPTIONS = (
    "--headless",
    "--no-sandbox",  # it shows pages of this package only, also to root, for whom there is no sandbox
    "--disable-gpu",
    "--disable-dev-shm-usage",
    "--remote-debugging-pipe",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-extensions",
    "--hide-scrollbars",
)
# The browser reads file 3 and writes file 4. Shells know only files below 10, and 3 and 4 may be taken here.
_LAUNCH = """
import os, sys
for given, place in ((1, 100), (2, 101)): os.dup2(int(sys.argv[given]), place)
for place, wanted in ((100, 3), (101, 4)): os.dup2(place, wanted)
os.execv(sys.argv[3], sys.argv[3:])
"""


def find() -> str:
    """The path of a Chromium, from $NEARFLAT_CHROMIUM or the usual names. Raises InputError if there is none."""
    found = os.environ.get("NEARFLAT_CHROMIUM") or next(filter(None, map(shutil.which, NAMES)), None)
    if found is None or os.name == "nt":  # the pipes are files 3 and 4, which Windows does not hand on
        raise InputError(
            "no Chromium was found; install it (Debian: apt-get install chromium) or set NEARFLAT_CHROMIUM to its "
            "path. On Windows, save both with the buttons of `nearflat view`"
        )
    return found


class Browser:
    """One browser with one page. Use as a context manager.

    patience: seconds for one answer.
    """

    def __init__(self, program: str, patience: float = _PATIENCE) -> None:
        self._patience = patience
        self._folder = tempfile.TemporaryDirectory(prefix="nearflat-chromium-", ignore_cleanup_errors=True)
        there, self._write = os.pipe()
        self._read, back = os.pipe()
        browser = [program, *_OPTIONS, f"--user-data-dir={self._folder.name}", "about:blank"]
        self._process = subprocess.Popen(
            [sys.executable, "-c", _LAUNCH, str(there), str(back), *browser],
            pass_fds=(there, back),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(there)
        os.close(back)
        self._buffer = b""
        self._id = 0
        self.events: list[dict[str, Any]] = []
        self._session: str | None = None

    def __enter__(self) -> "Browser":
        try:
            targets = self.send("Target.getTargets")["targetInfos"]
            page = next(target["targetId"] for target in targets if target["type"] == "page")
            self._session = self.send("Target.attachToTarget", targetId=page, flatten=True)["sessionId"]
            for domain in ("Page", "Runtime", "Network", "Log"):
                self.send(f"{domain}.enable")
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        try:
            self._session = None
            self.send("Browser.close")
            self._process.wait(5.0)
        except (OSError, TimeoutError, subprocess.TimeoutExpired):
            self._process.kill()
            self._process.wait()
        os.close(self._write)
        os.close(self._read)
        self._folder.cleanup()

    def send(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Give a command and wait for its answer; events that come meanwhile are kept."""
        self._id += 1
        message: dict[str, Any] = {"id": self._id, "method": method, "params": parameters}
        if self._session is not None:
            message["sessionId"] = self._session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        deadline = time.monotonic() + self._patience
        while True:
            answer = self._receive(deadline)
            if answer.get("id") == self._id:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                result: dict[str, Any] = answer.get("result", {})
                return result
            self.events.append(answer)

    def _receive(self, deadline: float) -> dict[str, Any]:
        while b"\0" not in self._buffer:
            ready, _, _ = select.select([self._read], [], [], max(0.0, deadline - time.monotonic()))
            if not ready:
                raise TimeoutError("the browser does not answer")
            part = os.read(self._read, 1 << 20)
            if not part:
                raise TimeoutError("the browser is gone")
            self._buffer += part
        text, _, self._buffer = self._buffer.partition(b"\0")
        received: dict[str, Any] = json.loads(text)
        return received

    def until(self, event: str) -> None:
        """Wait for an event."""
        deadline = time.monotonic() + self._patience
        while not any(seen.get("method") == event for seen in self.events):
            self.events.append(self._receive(deadline))

    def open(self, path: Path, fragment: str = "") -> None:
        """Open a file and wait until it is loaded. What the page does from now on is in `events`."""
        # By way of an empty page: an address that differs after # only would load nothing.
        for address in ("about:blank", path.resolve().as_uri() + fragment):
            self.events.clear()
            self.send("Page.navigate", url=address)
            self.until("Page.loadEventFired")

    def evaluate(self, expression: str) -> Any:
        """The value of a JavaScript expression in the page; promises are waited for."""
        answer = self.send("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            details = answer["exceptionDetails"]
            raise RuntimeError(details.get("exception", {}).get("description", details["text"]))
        return answer["result"].get("value")
