"""The built-in scenes: what each gives, on top of the defaults of `lammps_skin.model.scene`."""

from __future__ import annotations

from typing import Any

# lattice and number of stem cells: the same density of stem cells in both sizes
SIZES: dict[str, dict[str, Any]] = {
    "quarter": {"lattice": [100, 114], "stem": 16, "words": "a quarter of the paper's scene"},
    "paper": {"lattice": [200, 230], "stem": 64, "words": "the paper's scene"},
}

# arrangement, with ND cells or without, what it looks like
ARRANGEMENTS: dict[str, tuple[str, bool, str]] = {
    "ring": ("ring", False, "stem cells on a ring"),
    "cluster": ("cluster", False, "stem cells in a cluster"),
    "random": ("random", False, "stem cells at random"),
    "nd-a": ("random", True, "stem and ND cells at random"),
    "nd-b": ("core", True, "ND cells in a cluster, stem cells on a ring around it"),
    "nd-c": ("alternating", True, "stem and ND cells alternating on a ring"),
    "nd-d": ("halves", True, "stem cells clustered in one half, ND cells in the other"),
}


def _arranged(size: str, name: str) -> dict[str, Any]:
    arrangement, with_nd, words = ARRANGEMENTS[name]
    stem = SIZES[size]["stem"]
    return {
        "description": f"{SIZES[size]['words']}: {words}",
        "membrane": {"lattice": SIZES[size]["lattice"]},
        "cells": {"stem": stem, "nd": stem if with_nd else 0, "arrangement": arrangement},
    }


def _of_kinds(words: str, stem: int, kinds: dict[str, dict[str, Any]]) -> dict[str, Any]:
    """A scene of the size of demo, and of as many cells, with kinds of cells of its own."""
    return {
        "description": words,
        "end_time": 320.0,
        "membrane": {"lattice": [40, 46]},
        "cells": {"stem": stem, "arrangement": "ring", "kinds": kinds},
    }


def _with(
    words: str, intervention: dict[str, Any], end_time: float = 400.0, **cells: Any
) -> dict[str, Any]:
    """A scene like demo, but longer, with an intervention."""
    return {
        "description": words,
        "end_time": end_time,
        "membrane": {"lattice": [40, 46]},
        "cells": {"stem": 6, "arrangement": "ring", **cells},
        "interventions": [intervention],
    }


BUILT_IN: dict[str, dict[str, Any]] = {
    "demo": {
        "description": "a small patch of skin, from a few stem cells to crowding and removal",
        "end_time": 320.0,
        "membrane": {"lattice": [40, 46]},
        "cells": {"stem": 6, "arrangement": "ring"},
    },
    **{f"{size}-{name}": _arranged(size, name) for size in SIZES for name in ARRANGEMENTS},
    "bare-membrane": {
        "description": "the membrane alone, roughened, relaxing to a flat sheet",
        "end_time": 50.0,
        "dermis": {"present": False},
        "membrane": {"lattice": [40, 46], "noise": 0.05},
    },
    "no-dermis": {
        "description": "cells on a free membrane, without a dermis below",
        "end_time": 200.0,
        "dermis": {"present": False},
        "membrane": {"lattice": [40, 46]},
        "cells": {"stem": 6, "arrangement": "ring"},
    },
    "two-cells": {
        "description": "two stem cells side by side on a free membrane",
        "end_time": 100.0,
        "dermis": {"present": False},
        "membrane": {"lattice": [24, 28]},
        "cells": {"stem": 2, "arrangement": "cluster"},
    },
    "one-stem": {
        "description": "one stem cell and its lineage on a membrane over a dermis",
        "end_time": 200.0,
        "membrane": {"lattice": [24, 28]},
        "cells": {"stem": 1, "arrangement": "cluster"},
    },
    "mutant": _of_kinds(
        "one stem cell whose descendants adhere half as strongly again as those of five others",
        5,
        {
            "mutant": {"like": "stem", "count": 1, "daughter": "mutantta"},
            "mutantta": {"like": "ta", "stiffness": 7.5},
        },
    ),
    "two-ta": _of_kinds(
        "stem cells of two kinds, whose TA cells divide ten and three times",
        3,
        {
            "stem2": {"like": "stem", "count": 3, "daughter": "ta2"},
            "ta2": {"like": "ta", "generations": 3},
        },
    ),
    "slow-stem": _of_kinds(
        "three stem cells, and three others that divide half as often",
        3,
        {
            "slow": {
                "like": "stem",
                "count": 3,
                "cycle_delay": 72.0,
                "cycle_rate": 0.0415,
                "first_phase": 96.0,
            },
        },
    ),
    "loose-stem": _of_kinds(
        "stem cells that adhere like TA cells, and may detach as these do",
        6,
        {"stem": {"adhesion": "adhesive"}},
    ),
    "wound": _with(
        "all cells but the stem cells are removed from a round patch, which closes again",
        {
            "name": "wound",
            "at": 300.0,
            "remove": ["ta", "exhausted"],
            "within": {"cylinder": [10.0, 9.96, 7.0]},
        },
    ),
    "stiffening": _with(
        "the dermis becomes ten times as stiff when papillae begin to form, and flattens them",
        {
            "name": "stiffening",
            "at": 400.0,
            "set": {"dermis": {"stiffness": 0.4, "membrane_stiffness": 0.4}},
        },
        end_time=800.0,
    ),
    "thinning": _with(
        "every 60 time units a quarter of the stem cells is lost, until nothing renews the tissue",
        {"name": "thinning", "at": 120.0, "every": 60.0, "remove": "stem", "fraction": 0.25},
        end_time=500.0,
        generations=4,
    ),
}
