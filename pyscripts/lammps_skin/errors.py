"""The errors that a user sees: one line each, naming the key, the value and what is allowed."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def reading(what: str) -> Iterator[None]:
    """Whatever goes wrong within, in a file that is damaged, becomes a `SkinError` of one line."""
    try:
        yield
    except (OSError, LookupError, ValueError, TypeError, ArithmeticError, RuntimeError) as error:
        reason = getattr(error, "strerror", None) or "is damaged"
        raise SkinError(f"{what}: {reason}") from None


class SkinError(Exception):
    """Anything wrong with what the user gave or with a run; the text is one clear line."""


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
