"""Cases of bad input, each carried out in another process that may crash or hang."""

from __future__ import annotations

import contextlib
import io
import multiprocessing
import os
import tempfile
import traceback
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, NamedTuple

PATIENCE = 120.0  # seconds for one case, on a busy machine


class Outcome(NamedTuple):
    """What came of a case: exit code, output, error, and the files that it left."""

    code: int
    out: str
    err: str
    files: dict[str, int]

    def check(self) -> None:
        """Accepted, or refused with one clear line; no traceback in either."""
        assert self.code in (0, 2), self
        assert "Traceback" not in self.out + self.err, self
        if self.code:
            (line,) = self.err.splitlines()
            assert line.startswith("error: ")
            assert len(line.split()) > 2, line


Case = Callable[..., Outcome]


class Sandbox:
    """A process for one case after the other, begun anew when one has ended it."""

    def __init__(self) -> None:
        self._process: Any = None

    def __call__(self, case: Case, *arguments: object) -> Outcome:
        if self._process is None or not self._process.is_alive():
            self._begin()
        self._ours.send((case, arguments))
        try:
            if not self._ours.poll(PATIENCE):
                raise AssertionError(f"hangs: {arguments}")
            reply = self._ours.recv()
        except BaseException as error:
            self._process.kill()
            self._process.join()
            if isinstance(error, EOFError):
                raise AssertionError(
                    f"ends with code {self._process.exitcode}: {arguments}"
                ) from None
            raise
        assert isinstance(reply, Outcome), reply
        return reply

    def _begin(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._ours, theirs = context.Pipe()
        self._process = context.Process(target=_serve, args=(theirs,), daemon=True)
        self._process.start()
        theirs.close()

    def close(self) -> None:
        if self._process is not None:
            self._process.kill()
            self._process.join()


def _serve(connection: Connection) -> None:
    while True:
        try:
            case, arguments = connection.recv()
        except EOFError:
            return
        try:
            reply = case(*arguments)
        except BaseException:
            reply = f"{arguments}\n{traceback.format_exc()}"
        connection.send(reply)


def in_empty_directory(act: Callable[[Path], int]) -> Outcome:
    """The act's exit code, what it printed, and the files it left, with their sizes."""
    back = Path.cwd()
    out, err = io.StringIO(), io.StringIO()
    with tempfile.TemporaryDirectory(prefix="skin-fuzz-") as folder:
        here = Path(folder) / "a" / "b"
        here.mkdir(parents=True)
        os.chdir(here)
        try:
            with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
                code = act(here)
        finally:
            os.chdir(back)
        files = {
            str(path.relative_to(folder)): path.stat().st_size
            for path in Path(folder).rglob("*")
            if path.is_file()
        }
    return Outcome(code, out.getvalue(), err.getvalue(), files)


def skin(*arguments: str) -> int:
    """The command, in this process; its exit code."""
    from lammps_skin.cli import main

    try:
        main(arguments)
    except SystemExit as end:
        return int(end.code or 0)
    raise AssertionError("the command did not end")
