"""Chromium without a window, driven by its own protocol through a pair of pipes."""

from __future__ import annotations

import base64
import io
import json
import os
import shutil
import subprocess
import time
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

NAMES = "chromium", "chromium-browser", "google-chrome"
CHROMIUM = next(filter(None, map(shutil.which, NAMES)), None)
FLAGS = (
    "--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--hide-scrollbars",
)  # fmt: skip
PATIENCE = 60.0  # seconds
# a report as it was when it was opened: its controls, its time, its camera, no cell chosen
RESTORE = """(() => {
  page.play(false);
  for (const one of document.querySelectorAll("input, select")) {
    const chosen = [...(one.options ?? [])].findIndex((option) => option.defaultSelected);
    if (one.options) one.selectedIndex = Math.max(chosen, 0);
    else if (one.type === "checkbox") one.checked = one.defaultChecked;
    else one.value = one.defaultValue;
    for (const kind of ["input", "change"]) one.dispatchEvent(new Event(kind, { bubbles: true }));
  }
  page.choose(page.views[0], -1);
  page.goTo(page.steps.at(-1));
  page.camera.look("aside");
  document.activeElement.blur();
  scrollTo(0, 0);
})()"""


class Browser:
    """A page in Chromium.

    Attributes
    ----------
    errors : list of str
        What the console has told of errors and warnings, and exceptions.
    requested : list of str
        Addresses that were asked for.
    shown : str
        Address of the report that is open.
    """

    def __init__(self, folder: Path, size: tuple[int, int] = (1000, 700)) -> None:
        assert CHROMIUM
        theirs, self._write = os.pipe()
        self._read, their_write = os.pipe()
        window = f"--window-size={size[0]},{size[1]}"

        def with_pipes() -> None:
            os.dup2(theirs, 13)  # above 3 and 4, either of which may be one of the pipes
            os.dup2(their_write, 14)
            os.dup2(13, 3)
            os.dup2(14, 4)

        self._process = subprocess.Popen(
            [CHROMIUM, *FLAGS, window, f"--user-data-dir={folder}", "--remote-debugging-pipe",
             "about:blank"],
            preexec_fn=with_pipes, close_fds=False, stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )  # fmt: skip
        os.close(theirs)
        os.close(their_write)
        self._rest, self._number, self._session = b"", 0, ""
        self.errors: list[str] = []
        self.requested: list[str] = []
        self.shown = ""
        pages = self.call("Target.getTargets")["targetInfos"]
        target = next(page["targetId"] for page in pages if page["type"] == "page")
        attached = self.call("Target.attachToTarget", targetId=target, flatten=True)
        self._session = attached["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.call(f"{domain}.enable")
        self.call(
            "Emulation.setDeviceMetricsOverride", width=size[0], height=size[1],
            deviceScaleFactor=0.5, mobile=False,  # a quarter of the pixels, which a processor draws
        )  # fmt: skip

    def close(self) -> None:
        os.close(self._write)
        os.close(self._read)
        self._process.kill()
        self._process.wait()

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Send a command and wait for its answer."""
        self._number += 1
        command = {"id": self._number, "method": method, "params": parameters}
        if self._session:
            command["sessionId"] = self._session
        os.write(self._write, json.dumps(command).encode() + b"\0")
        while True:
            message = self._next()
            if message.get("id") == self._number:
                assert "error" not in message, message["error"]
                answer: dict[str, Any] = message["result"]
                return answer
            self._note(message)

    def _next(self) -> dict[str, Any]:
        while b"\0" not in self._rest:
            part = os.read(self._read, 1 << 20)
            assert part, "Chromium has ended"
            self._rest += part
        line, _, self._rest = self._rest.partition(b"\0")
        message: dict[str, Any] = json.loads(line)
        return message

    def _note(self, message: dict[str, Any]) -> None:
        told = message.get("params", {})
        match message.get("method"):
            case "Runtime.consoleAPICalled" if told["type"] in ("error", "warning", "assert"):
                self.errors.append(str([value.get("value") for value in told["args"]]))
            case "Runtime.exceptionThrown":
                self.errors.append(told["exceptionDetails"]["exception"].get("description", ""))
            case "Log.entryAdded" if told["entry"]["level"] in ("error", "warning"):
                self.errors.append(told["entry"]["text"])
            case "Network.requestWillBeSent":
                self.requested.append(told["request"]["url"])

    def open(self, address: str) -> None:
        """Open a report, and wait until it is shown."""
        self.shown = address
        self.call("Page.navigate", url=address)
        self.until("document.body?.dataset.ready === 'yes'")

    def restore(self) -> None:
        """Show the report that is open as it was at first: faster than to open it again."""
        self.value(RESTORE)

    def value(self, code: str) -> Any:
        """Value of an expression in JavaScript."""
        how = {"returnByValue": True, "awaitPromise": True}
        answer = self.call("Runtime.evaluate", expression=code, **how)
        assert "exceptionDetails" not in answer, answer["exceptionDetails"]
        return answer["result"].get("value")

    def until(self, code: str) -> None:
        """Wait for an expression to be true."""
        deadline = time.monotonic() + PATIENCE
        while not self.value(code):
            assert time.monotonic() < deadline, f"never true: {code}; {self.errors}"
            time.sleep(0.05)

    def choose(self, name: str, value: str) -> None:
        """Set an input or a choice by its id, as a user does."""
        self.value(
            f"{{ const e = document.getElementById({name!r}); e.value = {value!r};"
            " e.dispatchEvent(new Event('input', {bubbles: true})); }"
        )

    def click(self, x: float, y: float) -> None:
        """Click at a place of the window, in pixels."""
        for kind in ("mouseMoved", "mousePressed", "mouseReleased"):
            self.call(
                "Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1
            )

    def picture(self, **clip: float) -> np.ndarray[Any, Any]:
        """Pixels (height, width, 3) of the window, or of a part of the page."""
        part = {"clip": {**clip, "scale": 1}, "captureBeyondViewport": True} if clip else {}
        data = self.call("Page.captureScreenshot", format="png", **part)["data"]
        with Image.open(io.BytesIO(base64.b64decode(data))) as image:
            return np.asarray(image.convert("RGB"))
