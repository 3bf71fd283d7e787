"""Where LAMMPS finds the plugin: imported by every ``import lammps``, so nothing heavy here."""

from pathlib import Path

import lammps_skin


def folder() -> str:
    """Folder of ``skinplugin.so``, the value of the entry point ``lammps.plugins``."""
    return str(installed("plugins"))


def installed(name: str) -> Path:
    """Folder of the package that its installation filled: ``plugins`` or ``lammps_inputs``.

    An editable installation keeps these folders in site-packages and the modules elsewhere.
    Nothing is raised if no such folder exists, since every ``import lammps`` comes here.
    """
    folders = [Path(place).resolve() / name for place in lammps_skin.__path__]
    return next((folder for folder in folders if folder.is_dir()), folders[0])
