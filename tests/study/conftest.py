"""Many runs without processes of their own."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Sequence
from typing import Any

import pytest
from lammps_skin.study.runner import Job, _attempt


@pytest.fixture
def in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """As copies, like those that other processes get, which take longer to start than to run."""

    def run_share(
        todo: Sequence[Job], keep: bool = False, progress: Callable[..., None] | None = None
    ) -> dict[Job, str]:
        failures = {}
        for job in todo:
            error = _attempt(pickle.loads(pickle.dumps(job)), keep, _of(job, progress))
            if error:
                failures[job] = error
        return failures

    monkeypatch.setattr("lammps_skin.study.runner.find_spec", lambda name: None)  # no dask
    monkeypatch.setattr("lammps_skin.study.runner.run_share", run_share)


def _of(job: Job, progress: Callable[..., None] | None) -> Any:
    return progress and (lambda reached: progress(job, reached))
