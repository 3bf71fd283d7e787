"""Versions of all that a result depends on beside its scene."""

from __future__ import annotations

import hashlib
from functools import cache
from importlib.metadata import version
from pathlib import Path

from lammps_skin.plugin import folder


@cache
def versions() -> dict[str, str]:
    """Versions of LAMMPS and of the package, and a hash of the plugin: stored results name them."""
    plugin = b"".join(path.read_bytes() for path in sorted(Path(folder()).glob("*.so")))
    return {
        "lammps": version("lammps"),
        "lammps-skin": version("lammps-skin"),
        "plugin": hashlib.sha256(plugin).hexdigest()[:12],
    }
