"""The headless browser of `explorer.view.browser` with what a user does to a page."""

import base64
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from explorer.errors import InputError
from explorer.view import browser


class Browser(browser.Browser):
    """One browser with one page. Use as a context manager."""

    def frames(self, count: int = 2) -> None:
        """Let the page draw."""
        self.evaluate(
            f"new Promise(done => {{ let n = {count}; const f = () => n-- ? requestAnimationFrame(f) : done();"
            " f(); })"
        )

    def drawn(self) -> None:
        """Wait until the laboratory has drawn twice, also where nothing moves and however long that takes."""
        self.evaluate(
            "new Promise(done => { nearflat.restless = Infinity; const before = nearflat.frame.count; const look ="
            " () => nearflat.frame.count > before + 1 ? done() : requestAnimationFrame(look); look(); })"
        )

    def size(self, width: int, height: int, mobile: bool = False) -> None:
        """The window, in CSS pixels; `mobile`: it is touched."""
        self.send(
            "Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=mobile
        )
        self.send("Emulation.setTouchEmulationEnabled", enabled=mobile)

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

    def swipe(self, x: float, y: float, dx: float, dy: float) -> None:
        """Move one finger, as far as (dx, dy)."""
        self.send("Input.dispatchTouchEvent", type="touchStart", touchPoints=[{"x": x, "y": y}])
        for share in (0.25, 0.5, 0.75, 1.0):
            point = {"x": x + share * dx, "y": y + share * dy}
            self.send("Input.dispatchTouchEvent", type="touchMove", touchPoints=[point])
        self.send("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def key(self, key: str) -> None:
        """Press and release one key."""
        typed = {"text": key} if len(key) == 1 else {}
        self.send("Input.dispatchKeyEvent", type="keyDown", key=key, **typed)
        self.send("Input.dispatchKeyEvent", type="keyUp", key=key)

    @contextmanager
    def downloads(self, folder: Path) -> Iterator[None]:
        """What is done within this context saves one file into a folder, which is complete at its end."""
        how = {"behavior": "allow", "downloadPath": str(folder), "eventsEnabled": True}
        self.send("Browser.setDownloadBehavior", **how)
        yield
        while not any(event.get("params", {}).get("state") == "completed" for event in self.events):
            self.events.append(self._receive(time.monotonic() + self._patience))

    def problems(self) -> list[str]:
        """What the page has written to the console since it was opened, errors of its program included."""
        found = []
        for event in self.events:
            method, values = event.get("method"), event.get("params", {})
            if method == "Runtime.exceptionThrown":
                found.append(values["exceptionDetails"].get("exception", {}).get("description", "exception"))
            elif method == "Runtime.consoleAPICalled":
                found.append(str(values["args"]))
            elif method == "Log.entryAdded":
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
    try:
        program = browser.find()
    except InputError as error:
        pytest.skip(str(error))
    with Browser(program) as opened:
        yield opened
