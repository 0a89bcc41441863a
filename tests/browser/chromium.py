"""A headless Chromium, driven by its own protocol over two pipes: no driver and no package is needed.

https://chromedevtools.github.io/devtools-protocol: messages are JSON, ended by a zero byte. A command has an
id and is answered by a message with that id; messages without one are events.
"""

import base64
import json
import os
import select
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
_PATIENCE = 120.0  # s for one answer, also on a machine that does much else


def find() -> str | None:
    """The path of a Chromium, from $NEARFLAT_CHROMIUM or the usual names; None if there is none."""
    given = os.environ.get("NEARFLAT_CHROMIUM")
    return given or next((path for name in NAMES if (path := shutil.which(name))), None)


OPTIONS = (
    "--headless",
    "--no-sandbox",  # tests may run as root
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


class Browser:
    """One browser with one page. Use as a context manager."""

    def __init__(self, program: str) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="nearflat-chromium-", ignore_cleanup_errors=True)
        there, self._write = os.pipe()
        self._read, back = os.pipe()
        browser = [program, *OPTIONS, f"--user-data-dir={self._folder.name}", "about:blank"]
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
        deadline = time.monotonic() + _PATIENCE
        while True:
            answer = self._receive(deadline)
            if answer.get("id") == self._id:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer.get("result", {})
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
        return json.loads(text)

    def until(self, event: str) -> None:
        """Wait for an event."""
        deadline = time.monotonic() + _PATIENCE
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

    def frames(self, count: int = 2) -> None:
        """Let the page draw."""
        self.evaluate(
            f"new Promise(done => {{ let n = {count}; const f = () => n-- ? requestAnimationFrame(f) : done();"
            " f(); })"
        )

    def size(self, width: int, height: int) -> None:
        """The window, in CSS pixels."""
        self.send(
            "Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False
        )

    def prefer(self, **features: str) -> None:
        """What the user prefers: color_scheme="dark", reduced_motion="reduce"."""
        wanted = [
            {"name": f"prefers-{name.replace('_', '-')}", "value": value} for name, value in features.items()
        ]
        self.send("Emulation.setEmulatedMedia", features=wanted)

    def screenshot(self, whole: bool = False) -> bytes:
        """The page as PNG; `whole`: also what would have to be scrolled to."""
        return base64.b64decode(
            self.send("Page.captureScreenshot", format="png", captureBeyondViewport=whole)["data"]
        )

    def mouse(self, kind: str, x: float, y: float, pressed: bool = True) -> None:
        """mousePressed, mouseMoved or mouseReleased at a place in CSS pixels."""
        self.send(
            "Input.dispatchMouseEvent",
            type=kind,
            x=x,
            y=y,
            button="left" if pressed else "none",
            buttons=1 if pressed else 0,
            clickCount=1,
        )

    def drag(self, points: list[tuple[float, float]]) -> None:
        """Press at the first point, move through all, release at the last."""
        self.mouse("mousePressed", *points[0])
        for point in points:
            self.mouse("mouseMoved", *point)
        self.mouse("mouseReleased", *points[-1])

    def key(self, key: str) -> None:
        """Press and release one key."""
        typed = {"text": key} if len(key) == 1 else {}
        self.send("Input.dispatchKeyEvent", type="keyDown", key=key, **typed)
        self.send("Input.dispatchKeyEvent", type="keyUp", key=key)

    def problems(self) -> list[str]:
        """Errors and warnings that the page has reported since it was opened."""
        found = []
        for event in self.events:
            method, values = event.get("method"), event.get("params", {})
            if method == "Runtime.exceptionThrown":
                found.append(values["exceptionDetails"].get("exception", {}).get("description", "exception"))
            elif method == "Runtime.consoleAPICalled" and values["type"] in ("error", "warning", "assert"):
                found.append(str(values["args"]))
            elif method == "Log.entryAdded" and values["entry"]["level"] in ("error", "warning"):
                found.append(values["entry"]["text"])
        return found

    def requests(self) -> list[str]:
        """Addresses that the page has asked for since it was opened, itself included."""
        return [
            e["params"]["request"]["url"] for e in self.events if e.get("method") == "Network.requestWillBeSent"
        ]


@contextmanager
def started() -> Iterator[Browser]:
    """A browser that has started; the test is skipped where there is none."""
    program = find()
    if program is None:
        remedy = "install it (Debian: apt-get install chromium) or set NEARFLAT_CHROMIUM to its path"
        pytest.skip(f"no Chromium was found: {remedy}")
    with Browser(program) as browser:
        yield browser
