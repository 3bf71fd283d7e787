"""What a shell is told when a user presses the tabulator."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from lammps_skin.cli import COMMANDS

from tests.conftest import Answer

TYPED = {
    "skin ": list(COMMANDS),
    "skin sta": ["stats", "stability"],
    "skin check --par": ["--parameters"],
    "skin check --parameters earlier-": ["earlier-stiff", "earlier-full"],
    "skin run quarter-nd-": [f"quarter-nd-{place}" for place in "abcd"],
    "skin ensemble two": ["two-cells", "two-ta"],
    "skin run demo --set cells.see": ["cells.seed="],
    "skin run demo --accuracy b": ["balanced"],
    "skin stats runs/": [],  # the shell completes files
}


@pytest.mark.parametrize("typed", TYPED)
def test_what_is_offered(
    typed: str, skin: Callable[..., Answer], monkeypatch: pytest.MonkeyPatch
) -> None:
    place = len(typed.split()) - (not typed.endswith(" "))
    monkeypatch.setenv("COMP_WORDS", typed)
    monkeypatch.setenv("COMP_CWORD", str(place))
    monkeypatch.setenv("_SKIN_COMPLETE", "complete_bash")
    answer = skin()
    assert (answer.out.split(), answer.err) == (TYPED[typed], "")


def test_bash_completes() -> None:
    """With the script that `skin --show-completion` prints for bash."""
    command = Path(sys.executable).parent / "skin"
    script = f"""
        PATH={command.parent}:$PATH
        source <(_SKIN_COMPLETE=source_bash skin)
        COMP_WORDS=(skin run quarter-r) COMP_CWORD=2
        _skin_completion skin
        echo "${{COMPREPLY[@]}}"
    """
    ended = subprocess.run(["bash", "-c", script], capture_output=True, text=True, check=True)
    assert ended.stdout == "quarter-ring quarter-random\n"
