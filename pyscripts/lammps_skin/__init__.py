"""Epidermal stem cells on a deformable basement membrane and dermis, on stock LAMMPS."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from lammps_skin.analysis.energies import read_energies
    from lammps_skin.analysis.lineage import read_events
    from lammps_skin.analysis.observables import read_table
    from lammps_skin.errors import (
        ConfigurationError,
        DamagedError,
        FigureError,
        MembraneError,
        SceneError,
        SimulationError,
        SkinError,
    )
    from lammps_skin.model.scene import Scene
    from lammps_skin.run.simulation import Simulation
    from lammps_skin.start.configuration import Configuration
    from lammps_skin.trajectory.universe import open_trajectory

__all__ = [
    "Configuration",
    "ConfigurationError",
    "DamagedError",
    "FigureError",
    "MembraneError",
    "Scene",
    "SceneError",
    "Simulation",
    "SimulationError",
    "SkinError",
    "open_trajectory",
    "read_energies",
    "read_events",
    "read_table",
]

# loaded at first use: every ``import lammps`` imports this package for `lammps_skin.plugin`
_MODULES = {
    "Configuration": "start.configuration",
    "Scene": "model.scene",
    "Simulation": "run.simulation",
    "open_trajectory": "trajectory.universe",
    "read_energies": "analysis.energies",
    "read_events": "analysis.lineage",
    "read_table": "analysis.observables",
}


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_MODULES.get(name, 'errors')}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
