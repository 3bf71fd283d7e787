"""The named parameter sets: what each changes in the numbers printed in the paper.

The printed numbers themselves are the defaults of the scene's fields (`lammps_skin.model.scene`).
"""

from __future__ import annotations

from typing import Any

DEFAULT = "papilla"

SETS: dict[str, dict[str, Any]] = {
    "printed": {},
    "papilla": {"cells": {"division_spring": "length", "adhesion_range": 1.2}},
    "weak5": {"cells": {"division_spring": "length", "adhesion_stiffness": 5.0}},
    "direct5": {
        "force_scale": "direct",
        "cells": {"division_spring": "length", "adhesion_stiffness": 5.0},
    },
}

SUMMARIES = {
    "printed": "the paper's numbers with only the repairs that make them defined; runs away",
    "papilla": "printed, length spring, adhesion range 1.2 (the default)",
    "weak5": "printed, length spring, adhesion stiffness 5",
    "direct5": "weak5 with direct forces, closest to the authors' older code",
}
