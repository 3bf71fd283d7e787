"""Arrays in few bytes, as the page unpacks them (unpack.js)."""

from __future__ import annotations

import gzip
import json
from collections.abc import Collection, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lammps_skin.arrays import Floats

LEVEL = 6  # of gzip


def quantised(values: Floats, low: Floats | float, high: Floats | float, kind: str) -> NDArray[Any]:
    """Whole numbers of a kind, 0 for `low` to the largest of them for `high`."""
    most = np.iinfo(kind).max
    span = np.where(np.asarray(high) > low, np.asarray(high) - low, 1.0)
    share = np.clip((np.asarray(values) - low) / span, 0.0, 1.0)
    return np.rint(share * most).astype(kind)


def pack(arrays: Mapping[str, NDArray[Any]], steady: Collection[str] = ()) -> bytes:
    """Compressed bytes of arrays, little-endian.

    The head, one line of JSON, has the name, type and shape of each. Bytes of the same rank in
    their numbers stand together. Whole numbers that change little along the first axis, those
    named in `steady`, are kept as differences along it, which wrap around.
    """
    head, body = [], []
    for name, values in arrays.items():
        kept = np.ascontiguousarray(values)
        if name in steady:
            kept = np.concatenate([kept[:1], kept[1:] - kept[:-1]])
        plain = kept.astype(kept.dtype.newbyteorder("<"))
        planes = np.frombuffer(plain.tobytes(), np.uint8).reshape(-1, plain.dtype.itemsize).T
        head.append({
            "name": name, "type": plain.dtype.str[1:], "shape": plain.shape,
            "steady": name in steady,
        })  # fmt: skip
        body.append(planes.tobytes())
    return gzip.compress(json.dumps(head).encode() + b"\n" + b"".join(body), LEVEL, mtime=0)
