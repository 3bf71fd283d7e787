"""What observables are called in words."""

from __future__ import annotations

import re

import pytest
from lammps_skin.analysis.labels import label
from lammps_skin.analysis.observables import COLUMNS, columns
from lammps_skin.model.scene import Scene


def test_all_observables_have_words_of_their_own() -> None:
    """No label is that of another column, or has the underscores of a name in a table."""
    for names in (COLUMNS, columns(Scene.load("mutant").kinds_of_cells)):
        texts = [label(name).text for name in names[1:]]
        assert len(set(texts)) == len(texts)
        assert not [text for text in texts if "_" in re.sub(r"χ_[HG]|R_c", "", text)]


@pytest.mark.parametrize(
    ("column", "text", "group"),
    [
        ("exhausted", "exhausted TA cells", "Cells"),
        ("mutant", "mutant cells", "Cells"),
        ("deaths", "removals since the start", "Cells"),
        ("nd_tips_p", "ND cells on tips, p-value", "Cells on tips of papillae"),
        ("chi_H_mutant", "χ_H: mutant cells on convex places", "Order parameters"),
        (
            "stem_on_tips-stem_tips_expected", "stem cells on tips, more than by chance",
            "Cells on tips of papillae",
        ),
        (
            "papillae-births", "number of papillae less births since the start", "Papillae",
        ),
        ("papillae>9", "time until number of papillae exceeds 9", "Papillae"),
    ],
)  # fmt: skip
def test_words(column: str, text: str, group: str) -> None:
    assert label(column) == (text, group)
