"""The page of a run that goes on, for browsers of this machine."""

from __future__ import annotations

import json
import time
from functools import partial
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any
from urllib.parse import parse_qs, urlsplit

from lammps_skin.errors import SkinError
from lammps_skin.report.page import page
from lammps_skin.report.record import record

HOST = "127.0.0.1"
SHARE = 0.1  # of the time at most, in which the page is made: the run needs the cores


class PageServer:
    """Serves the page of a run on an address of this machine alone; a context manager.

    Parameters
    ----------
    run : Path
    port : int
        0 is any that is free.

    Attributes
    ----------
    address : str
    version : int
        How often the page has been made.

    Raises
    ------
    SkinError
        If the run cannot be read, or if the port is taken.
    """

    def __init__(self, run: Path, port: int = 0) -> None:
        self._run, self._record = run, record(run)
        self._frames = len(self._record.told["table"]["time"])
        self.version, self._asked, self._rest = 1, False, 0.0
        try:
            self._server = ThreadingHTTPServer((HOST, port), partial(_Handler, self))
        except (OSError, OverflowError) as error:
            raise SkinError(f"port = {port}: {getattr(error, 'strerror', error)}") from None
        self.port = self._server.server_port
        self.address = f"http://{HOST}:{self.port}/"
        self._thread = Thread(target=self._server.serve_forever, daemon=True)

    def __enter__(self) -> PageServer:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._server.shutdown()
        self._server.server_close()

    def refresh(self, frames: int) -> None:
        """Make the page anew if there are more frames and a browser looks, but not all the time."""
        began = time.monotonic()
        if frames == self._frames or not self._asked or began < self._rest:
            return
        self._record = record(self._run)
        self._frames, self._asked = frames, False
        self.version += 1
        now = time.monotonic()
        self._rest = now + (now - began) / SHARE

    def html(self) -> bytes:
        """The page as it is now."""
        self._asked = True
        return page([self._record], live=self.version).encode()

    def news(self, after: int) -> bytes:
        """Nothing if a version is the last; else the last one: a line of JSON and packed arrays."""
        self._asked = True
        if after >= self.version:
            return b""
        told = {"version": self.version, "told": self._record.told}
        return json.dumps(told, allow_nan=False).encode() + b"\n" + self._record.packed


class _Handler(BaseHTTPRequestHandler):
    """Answers a browser, but not a page of elsewhere, which calls this machine by another name."""

    def __init__(self, served: PageServer, *request: Any) -> None:
        self._served = served
        super().__init__(*request)

    def do_GET(self) -> None:
        asked = urlsplit(self.path)
        names = [f"{name}:{self._served.port}" for name in (HOST, "localhost")]
        if self.headers.get("Host") not in names:
            self._answer(HTTPStatus.FORBIDDEN, "text/plain", b"ask for 127.0.0.1\n")
        elif asked.path == "/":
            self._answer(HTTPStatus.OK, "text/html; charset=utf-8", self._served.html())
        elif asked.path == "/news":
            after = parse_qs(asked.query).get("after", ["0"])[0]
            news = self._served.news(int(after) if after.isdecimal() else 0)
            status = HTTPStatus.OK if news else HTTPStatus.NO_CONTENT
            self._answer(status, "application/octet-stream", news)
        else:
            self._answer(HTTPStatus.NOT_FOUND, "text/plain", b"there is nothing here\n")

    def _answer(self, status: HTTPStatus, kind: str, content: bytes) -> None:
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        self.send_header("Cache-Control", "no-store")
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, *_: Any) -> None:
        """Nothing: the terminal shows the run."""
