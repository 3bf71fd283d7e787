"""Frames as skin.h5 keeps them: in chunks of slots, shuffled and deflated.

They are packed here and not by HDF5, since the recorder writes each frame to two files.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from lammps_skin.arrays import Floats, Ints
from lammps_skin.kinds import is_cell
from lammps_skin.trajectory.frame import ABSENT, WHOLE, Frame

SLOTS_PER_CHUNK = 4096
FILTERS = {"compression": "gzip", "compression_opts": 1, "shuffle": True}


class PackedFrame(NamedTuple):
    """A frame whose elements are packed.

    Attributes
    ----------
    slots : int
        The highest id.
    chunks : dict
        Of each element: first slots and bytes of the chunks that hold particles.
    """

    step: int
    time: float
    edges: Floats
    next_id: int
    slots: int
    chunks: dict[str, list[tuple[int, bytes]]]


def element_type(name: str) -> tuple[np.dtype[Any], float]:
    """Numbers of an element in the file, and the one of slots without a particle."""
    whole = name in ("id", "species", *WHOLE)
    return (np.dtype("i4"), ABSENT) if whole else (np.dtype("f8"), np.nan)


def pack(frame: Frame) -> PackedFrame:
    """Pack a frame; state is that of cells alone."""
    values = {"position": frame.positions, "id": frame.ids, "species": frame.kinds}
    chunks = {name: list(_chunks(name, frame.ids, column)) for name, column in values.items()}
    cells = is_cell(frame.kinds)
    for name, column in frame.state.items():
        chunks[name] = list(_chunks(name, frame.ids[cells], column[cells]))
    slots = int(frame.ids.max(initial=0))
    return PackedFrame(frame.step, frame.time, frame.edges, frame.next_id, slots, chunks)


def _chunks(name: str, ids: Ints, values: Any) -> Iterator[tuple[int, bytes]]:
    """Chunks of an element in which there are values, those of ids (n,) in increasing order."""
    kind, fill = element_type(name)
    slots = ids - 1
    for begin in np.unique(slots // SLOTS_PER_CHUNK) * SLOTS_PER_CHUNK:
        first, last = np.searchsorted(slots, [begin, begin + SLOTS_PER_CHUNK])
        rows = np.full((SLOTS_PER_CHUNK, *values.shape[1:]), fill, kind)
        rows[slots[first:last] - begin] = values[first:last]
        # runs of equal bytes alone: half the time of level 1, and 4 % more bytes
        deflate = zlib.compressobj(1, strategy=zlib.Z_RLE)
        shuffled = rows.view(np.uint8).reshape(-1, kind.itemsize).T.tobytes()
        yield int(begin), deflate.compress(shuffled) + deflate.flush()


def write_chunks(dataset: Any, frame: int, chunks: list[tuple[int, bytes]]) -> None:
    """Write the chunks of an element for a frame, unpacked where the file has its own filters."""
    inner = dataset.shape[2:]
    if _is_packed_like_ours(dataset):
        for begin, packed in chunks:
            dataset.id.write_direct_chunk((frame, begin, *(0 for _ in inner)), packed)
        return
    for begin, packed in chunks:
        end = min(begin + SLOTS_PER_CHUNK, dataset.shape[1])
        shuffled = np.frombuffer(zlib.decompress(packed), np.uint8)
        rows = shuffled.reshape(dataset.dtype.itemsize, -1).T.copy().view(dataset.dtype)
        dataset[frame, begin:end] = rows.reshape(SLOTS_PER_CHUNK, *inner)[: end - begin]


def _is_packed_like_ours(dataset: Any) -> bool:
    kept = dataset.chunks, dataset.shuffle, dataset.compression
    ours = (1, SLOTS_PER_CHUNK, *dataset.shape[2:]), FILTERS["shuffle"], FILTERS["compression"]
    return kept == ours and dataset.id.get_create_plist().get_nfilters() == 2
