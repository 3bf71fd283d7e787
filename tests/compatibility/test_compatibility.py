"""Every command of the table, tried beside our styles."""

import re
from dataclasses import replace

import pytest

from tests.compatibility import verifications
from tests.compatibility.conftest import Tried
from tests.compatibility.tries import (
    Row,
    Try,
    assert_alike,
    assert_consistent,
    assert_equations,
    table,
)


def name_of(row: Row) -> str:
    return f"{row.family}: {row.command}"


TABLE = table()
ENDING = [row for row in TABLE if row.on_ranks != "hangs"]  # on several ranks
IDS = [name_of(row) for row in TABLE]
MARKED = [pytest.param(row, marks=pytest.mark.slow if row.slow else ()) for row in TABLE]


@pytest.mark.parametrize("row", MARKED, ids=IDS)
def test_command(row: Row, tried: Tried) -> None:
    assert_as_told(tried(row), tried, row.refused)


@pytest.mark.slow
@pytest.mark.parametrize("row", ENDING, ids=map(name_of, ENDING))
def test_command_on_two_ranks(row: Row, tried: Tried) -> None:
    """Compared with what there is on one rank."""
    assert_as_told(tried(row, ranks=2), tried, row.on_ranks or row.refused)


def assert_as_told(done: Try, tried: Tried, refusal: str) -> None:
    """What a try has left is what the table says of its command."""
    row = done.row
    assert done.status >= 0, f"ended by signal {-done.status}"
    if row.refused:
        assert done.status > 0, "was not refused"
        assert refusal in done.error
        return
    assert done.status == 0, done.error
    assert row.check or row.verify or row.like is not None, "nothing is compared"
    assert_equations(done)
    if row.like is not None:
        assert_alike(done, tried(replace(plain(row), lines=row.like)))
    if row.verify:
        getattr(verifications, row.verify)(done, tried(plain(row)))
    if row.atoms:
        assert_consistent(done, tried(replace(plain(row), run=0)).atoms)


def plain(row: Row) -> Row:
    """The scene of a row without the command."""
    variables = " ".join(re.findall(r"-var \w+ (?:'.*?'|\S+)", row.arguments))
    return Row("", row.scene, row.family, young=row.young, arguments=variables)
