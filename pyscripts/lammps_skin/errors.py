"""The errors that a user sees: one line each, naming the key, the value and what is allowed."""

from __future__ import annotations

import errno
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager


class SkinError(Exception):
    """Anything wrong with what the user gave or with a run; the text is one clear line."""


class DamagedError(SkinError):
    """A file whose contents cannot be right; whoever reads it again finds the same."""


def why(number: int) -> str:
    """What the system means by the number of an error."""
    if number == errno.EAGAIN:  # of files alone, which are locked then
        return "another process has it open; try again when that has closed it"
    return os.strerror(number)


@contextmanager
def reading(what: str) -> Iterator[None]:
    """Whatever goes wrong within, while a file is read, becomes a `SkinError` of one line.

    It is a `DamagedError` unless the system names a reason, as for a file that is locked,
    unreadable or on a sick disk: that may be over the next time.
    """
    try:
        yield
    except OSError as error:
        told = re.search(r"errno = (\d+)", str(error))  # of HDF5, which says it in its text alone
        number = error.errno or (int(told[1]) if told else 0)
        if number:
            raise SkinError(f"{what}: {why(number)}") from None
        raise DamagedError(f"{what}: is damaged") from None
    except (LookupError, ValueError, TypeError, AttributeError, ArithmeticError, RuntimeError):
        raise DamagedError(f"{what}: is damaged") from None


class SceneError(SkinError):
    """A scene that cannot be: unknown key, value out of range, parts that contradict."""


class ConfigurationError(SkinError):
    """Arrays or a file that describe no possible initial state."""


class SimulationError(SkinError):
    """A run that LAMMPS, or the watch over it, has stopped."""


class MembraneError(SkinError, ValueError):
    """A membrane that does not have what was asked for, as a height at every place."""


class FigureError(SkinError):
    """A figure or snapshot that cannot be drawn from what is there."""


def printable(text: str) -> str:
    """The text without control characters and the like, but for ends of lines.

    What stands in a file of a stranger must not give orders to the terminal.
    """
    return "".join(c for c in text if c.isprintable() or c == "\n")


def one_line(text: str) -> str:
    """The text in one line of what can be printed."""
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())
