"""Signals that end a run, put off to a moment at which it can be ended well."""

from __future__ import annotations

import signal
import threading
from types import FrameType
from typing import Any, Self

ENDING = (signal.SIGINT, signal.SIGTERM)


class Interruption:
    """While it is entered, SIGINT and SIGTERM wait for `check`; a second one does not.

    Signals for which somebody else has set a handler are left to them, and all signals are if
    this is not the main thread.
    """

    def __init__(self) -> None:
        self._former: dict[signal.Signals, Any] = {}
        self._noted: int | None = None

    def __enter__(self) -> Self:
        if threading.current_thread() is threading.main_thread():
            for number in ENDING:
                if signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
                    self._former[number] = signal.signal(number, self._note)
        return self

    def __exit__(self, _: object, error: BaseException | None, *__: object) -> None:
        for number, handler in self._former.items():
            signal.signal(number, handler)
        if error is None:
            self.check()

    def check(self) -> None:
        """Raise KeyboardInterrupt after SIGINT, SystemExit with code 143 after SIGTERM."""
        if self._noted == signal.SIGINT:
            raise KeyboardInterrupt
        if self._noted is not None:
            raise SystemExit(128 + self._noted)

    def _note(self, number: int, _: FrameType | None) -> None:
        impatient = self._noted is not None
        self._noted = number
        if impatient:
            self.check()
