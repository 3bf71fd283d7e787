"""The numbers that the page on experiments compares are those of the table that it names."""

import re

from lammps_skin import read_table
from lammps_skin.study.ensemble import window_mean

from tests.pages import ROOT, rows, section, text


def test_numbers_are_those_of_the_table() -> None:
    name = re.search(r'read_table\("(.*?)"\)', text("experiments.md"))
    assert name
    table = read_table(ROOT / name[1])
    stated = rows(section("experiments.md", "How the two are measured"))
    assert len(stated) >= 8
    for column, value in stated:
        mean = window_mean(table, column.strip("`"), 400, 1000)
        assert mean.n == 8
        assert value == f"{mean.value:.2f} [{mean.low:.2f}, {mean.high:.2f}]", column
