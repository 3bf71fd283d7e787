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

TABLE = table()


IDS = [f"{row.family}: {row.command}" for row in TABLE]
MARKED = [pytest.param(row, marks=pytest.mark.slow if row.slow else ()) for row in TABLE]


@pytest.mark.parametrize("row", MARKED, ids=IDS)
def test_command(row: Row, tried: Tried) -> None:
    assert_as_told(tried(row), tried)


@pytest.mark.slow
@pytest.mark.parametrize("row", TABLE, ids=IDS)
def test_command_on_two_ranks(row: Row, tried: Tried) -> None:
    """Compared with what there is on one rank."""
    if row.says.startswith("on one rank"):
        pytest.skip("LAMMPS waits for ever")
    assert_as_told(tried(row, ranks=2), tried)


def assert_as_told(done: Try, tried: Tried) -> None:
    """What a try has left is what the table says of its command."""
    row = done.row
    assert done.status >= 0, f"ended by signal {-done.status}"
    if row.refused:
        assert done.status > 0, "was not refused"
        # of a link that long LAMMPS may say first that no rank has both of its particles
        other = "Bond atoms" if row.refused.startswith("its singular length") else row.refused
        assert row.refused in done.error or other in done.error
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
