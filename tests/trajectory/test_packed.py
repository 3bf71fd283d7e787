"""Packed frames: what they are in datasets of our own layout and of any other."""

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from lammps_skin.trajectory.packed import FILTERS, SLOTS_PER_CHUNK, element_type, pack, write_chunks

LAYOUTS: dict[str, dict[str, Any]] = {
    "ours": {"chunks": (1, SLOTS_PER_CHUNK), **FILTERS},
    "other level": {"chunks": (1, SLOTS_PER_CHUNK), **FILTERS, "compression_opts": 9},
    "other chunks": {"chunks": (2, 100), **FILTERS},
    "one more filter": {"chunks": (1, SLOTS_PER_CHUNK), **FILTERS, "fletcher32": True},
    "not packed": {"chunks": (1, SLOTS_PER_CHUNK)},
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_values_are_those_of_the_frame(layout: str, run: Any, tmp_path: Path) -> None:
    frame = run.frames[-1]
    slots = int(frame.ids.max()) + 3
    kept = LAYOUTS[layout]
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for name, chunks in pack(frame).chunks.items():
            inner = (3,) if name == "position" else ()
            kind, fill = element_type(name)
            more = {**kept, "chunks": (*kept["chunks"], *inner), "maxshape": (None, None, *inner)}
            dataset = file.create_dataset(name, (2, slots, *inner), kind, fillvalue=fill, **more)
            write_chunks(dataset, 1, chunks)
    with h5py.File(tmp_path / "a.h5") as file:
        for name, values in frame.over_slots(slots).items():
            np.testing.assert_array_equal(file[name][1], values)
            np.testing.assert_array_equal(file[name][0], np.full_like(values, file[name].fillvalue))
