"""Words for numbers of things."""

from __future__ import annotations


def counted(number: int, what: str) -> str:
    """A number of things, whose word is given in the singular: ``1 run``, ``2,000 runs``."""
    return f"{number:,} {what}{'' if number == 1 else 's'}"
