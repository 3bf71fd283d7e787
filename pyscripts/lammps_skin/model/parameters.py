"""The named parameter sets: what each changes in the numbers printed in the paper.

The printed numbers themselves are the defaults of the scene's fields (`lammps_skin.model.scene`).
"""

from __future__ import annotations

from typing import Any, Final

DEFAULT: Final = "earlier"

EARLIER_CELLS = {"division_spring": "length", "adhesion_stiffness": 5.0, "adhesion_range": 1.2}

SETS: dict[str, dict[str, Any]] = {
    "printed": {},
    "papilla": {"cells": {"division_spring": "length", "adhesion_range": 1.2}},
    "weak5": {"cells": {"division_spring": "length", "adhesion_stiffness": 5.0}},
    "direct5": {
        "force_scale": "direct",
        "cells": {"division_spring": "length", "adhesion_stiffness": 5.0},
    },
    "earlier": {"force_scale": "direct", "cells": EARLIER_CELLS},
    "earlier-stiff": {
        "force_scale": "direct",
        "cells": EARLIER_CELLS,
        "membrane": {"bending_stiffness": 10.0},
    },
    "earlier-full": {
        "force_scale": "direct",
        "dermis": {"packing": "cubic"},
        "membrane": {"bending_form": "diverging"},
        "cells": {
            **EARLIER_CELLS,
            "ring_radius": 0.25,
            "first_phase": 0.0,
            "removal_in_pair": False,
            "division_distance": 0.9,
            "kinds": {"ta": {"paired_with": "stem", "paired_stiffness": 25.0}},
        },
    },
}

SUMMARIES = {
    "printed": "the paper's numbers with only the repairs that make them defined; runs away",
    "papilla": "printed, length spring, adhesion range 1.2: the stiff case, cells heap",
    "weak5": "printed, length spring, adhesion stiffness 5",
    "direct5": "weak5 with direct forces",
    "earlier": "direct5, adhesion range 1.2, as in the authors' earlier program (the default)",
    "earlier-stiff": "earlier, bending stiffness 10: that of later work of the authors' group",
    "earlier-full": "earlier, and that program's fold term, rules of dividing pairs and start",
}
