"""Opens files in HDF5, also where they cannot be locked and while a run changes them."""

from __future__ import annotations

import errno
import time
from pathlib import Path

import h5py

NO_LOCKS = {errno.ENOLCK, errno.ENOTSUP, errno.EOPNOTSUPP, errno.ENOSYS, errno.EBADF}
PATIENCE = 5.0  # seconds for a run to be done with the file that had this name a moment ago


def open_hdf5(path: str | Path, mode: str = "r") -> h5py.File:
    """An open file; locked by HDF5, unless its file system knows no locks.

    A run that writes has the file that was skin.h5 a moment ago to itself: who meets it there
    tries again, and finds the one that has taken its place.

    Raises
    ------
    OSError
        With its `errno` where the system could not do it, and without where the file is damaged.
    """
    deadline = time.monotonic() + PATIENCE
    while True:
        try:
            return h5py.File(path, mode)
        except BlockingIOError:
            if mode != "r" or time.monotonic() > deadline:
                raise
            time.sleep(0.01)
        except OSError as error:
            if error.errno not in NO_LOCKS:
                raise
            return h5py.File(path, mode, locking=False)
