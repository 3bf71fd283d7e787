"""Epidermal stem cells on a deformable basement membrane and dermis, on stock LAMMPS."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from lammps_skin.errors import SkinError
    from lammps_skin.model.scene import Scene
    from lammps_skin.run.simulation import Simulation
    from lammps_skin.start.configuration import Configuration
    from lammps_skin.trajectory.universe import open_trajectory

__all__ = ["Configuration", "Scene", "Simulation", "SkinError", "open_trajectory"]

# loaded at first use: every ``import lammps`` imports this package for `lammps_skin.plugin`
_MODULES = {
    "Configuration": "start.configuration",
    "Scene": "model.scene",
    "Simulation": "run.simulation",
    "SkinError": "errors",
    "open_trajectory": "trajectory.universe",
}


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
