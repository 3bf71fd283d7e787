"""The command line as its user meets it: arguments in; output, error and exit code out."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from lammps_skin.start import lattice

from tests.conftest import Answer


@pytest.fixture
def refused(skin: Callable[..., Answer]) -> Callable[..., str]:
    """Call ``skin`` with what it must refuse; the text of its one line of error."""

    def call(*arguments: object) -> str:
        answer = skin(*arguments)
        assert answer.code == 2
        first, *more = answer.err.splitlines()
        assert first.startswith("error: ") and not more
        return first.removeprefix("error: ")

    return call


@pytest.fixture(scope="session")
def text_file() -> list[str]:
    """Lines of a configuration: a flat membrane of 12 x 14, and S, T, T at 174, 175, 176."""
    sheet = lattice.positions((12, 14), 0.5, 10.0)
    lines = [f"lattice 12 14 6 {7 * np.sqrt(3) / 2:.17g} 5.0"]
    lines += ["M {:.17g} {:.17g} {:.17g}".format(*place) for place in sheet]
    return [*lines, "S 1.5 1.5 12.5", "T 4.5 4.5 12.6 3", "T 4.52 4.5 12.6 3", "pair 169 170 0.1"]
