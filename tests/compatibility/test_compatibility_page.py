"""docs/compatibility.md says what the table of commands says."""

from collections import Counter

from tests.compatibility.page import PAGE, whole
from tests.compatibility.tries import table


def test_page_holds_the_table() -> None:
    text = PAGE.read_text("utf-8")
    assert text == whole(text), "make it anew: python -m tests.compatibility.page"


def test_commands_are_named_once() -> None:
    names = Counter((row.family, row.command) for row in table())
    assert max(names.values()) == 1
