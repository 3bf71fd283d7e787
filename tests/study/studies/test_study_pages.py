"""What pages of studies say is what their tables tell."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import Answer
from tests.pages import BY_NAME, ROOT, blocks, commands, text

COMPARED = [
    (page, words)
    for page, words in commands("skin")
    if page.startswith("studies/") and words[0] == "compare" and "--plot" not in words
]


@pytest.mark.parametrize(("page", "words"), COMPARED, ids=[page for page, _ in COMPARED])
def test_tables(
    page: str, words: list[str], skin: Callable[..., Answer], tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """Each row of each table below a command of `skin compare`."""
    monkeypatch.chdir(ROOT)
    told = tmp_path / "told.md"
    answer = skin(*words, "-o", told)
    assert answer.code == 0, answer.err
    rows = [line for line in told.read_text("utf-8").splitlines() if line.startswith("| ")]
    assert len(rows) > 3
    missing = [row for row in rows if row not in text(page).splitlines()]
    assert not missing


def test_pictures_are_shown() -> None:
    """Each page that compares shows the picture of its study."""
    assert COMPARED
    for page in {page for page, _ in COMPARED}:
        name = page.removeprefix("studies/").removesuffix(".md")
        assert f"/figures/studies/{name}.png)" in text(page)
        assert any(f"skin study {name}" in block for _, block in blocks(page))


def test_the_list_of_studies_leads_to_their_pages() -> None:
    there = {page for page in BY_NAME if page.startswith("studies/")}
    assert there <= set(re.findall(r"\]\((studies/[\w-]+\.md)\)", text("studies.md")))
