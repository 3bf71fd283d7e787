"""The table of the kinds of cells in a scene: what it says, what is refused, where cells start."""

from __future__ import annotations

import re

import numpy as np
import pytest
from lammps_skin.analysis.observables import COLUMNS
from lammps_skin.errors import SceneError
from lammps_skin.kinds import KINDS, Kind, is_cell
from lammps_skin.model.cell_kinds import NAME, RESERVED, ROWS, divisions_left
from lammps_skin.model.parameters import SETS
from lammps_skin.model.remarks import remarks
from lammps_skin.model.scene import Scene
from lammps_skin.model.scene_keys import to_toml
from lammps_skin.model.stiffness import stiffest
from lammps_skin.model.terms import Terms
from lammps_skin.start.arrangements import place_cells
from lammps_skin.trajectory.attributes import NOTHING
from MDAnalysis.analysis.results import Results

FREE = {"dermis.present": False, "membrane.lattice": [24, 28], "cells.stem": 2}
OWN = {
    "cells.kinds.mutant": {"like": "stem", "count": 1, "daughter": "ta2", "color": "#ff0080"},
    "cells.kinds.ta2": {"like": "ta", "stiffness": 5.0, "generations": 3},
}


def scene(**changes: object) -> Scene:
    return Scene.from_dict({"name": "own"}).replace(**{**FREE, **changes})


# ---- what the table says


@pytest.mark.parametrize("name", SETS)
def test_rows_follow_the_keys_of_cells(name: str) -> None:
    plain = scene(parameters=name, **{"cells.cycle_delay": 7.0, "cells.generations": 4})
    stem, ta, exhausted, nd = plain.cell_table.values()
    cells = plain.cells
    assert stem.stiffness == nd.stiffness == cells.binding_stiffness
    assert (ta.stiffness, ta.range) == (cells.adhesion_stiffness, cells.adhesion_range)
    assert exhausted.stiffness == 0 and exhausted.range == cells.adhesion_range
    assert {row.cycle_delay for row in (stem, ta)} == {7.0}
    assert (stem.generations, ta.generations, stem.count) == (None, 4, 2)
    assert plain.kinds == (Kind.MEMBRANE, Kind.STEM, Kind.TA, Kind.EXHAUSTED)


def test_further_kinds_have_the_numbers_after() -> None:
    own = scene(**OWN)
    mutant, other = (own.cell_table[label] for label in ("mutant", "ta2"))
    assert [int(mutant.kind), int(other.kind)] == [7, 8]
    assert mutant.kind.colour == pytest.approx((1.0, 0.0, 128 / 255))
    assert len({kind.colour for kind in own.all_kinds}) == len(own.all_kinds)
    assert [kind.label for kind in own.kinds] == [
        "membrane", "stem", "ta", "exhausted", "mutant", "ta2",
    ]  # fmt: skip
    assert (mutant.adhesion, mutant.stiffness, mutant.detaches) == ("bound", 25.0, False)
    assert (other.daughter, other.after_last) == ("ta2", "exhausted")
    assert [divisions_left(row, own.cell_table) for row in (mutant, other)] == [3, 3]
    assert Scene.from_dict(own.given()).all_kinds == own.all_kinds
    text = to_toml(own.model_dump(exclude_none=True))
    assert text.index("[cells.kinds.mutant]") < text.index("[cells.kinds.ta2]")


def test_a_kind_without_cells_is_no_type() -> None:
    own = scene(**OWN, **{"cells.kinds.mutant.count": 0, "cells.generations": "endless"})
    assert [kind.label for kind in own.kinds] == ["membrane", "stem", "ta"]
    assert own.divides and not scene(**{"cells.kinds.stem.daughter": "none"}).divides
    assert not scene(**{"cells.kinds.stem.daughter": "none"}).rounding


def test_reserved_names_are_what_outputs_call_otherwise() -> None:
    labels = {kind.label for kind in KINDS if not is_cell(kind)}
    columns = {name for name in COLUMNS if NAME.fullmatch(name)} - set(ROWS)
    attributes = {name for name in dir(Results()) if NAME.fullmatch(name)}
    assert labels | columns | attributes | {NOTHING, "seed", "rows", "table"} <= RESERVED


# ---- what is refused

REFUSED: dict[str, tuple[dict[str, object], str]] = {
    "unknown key": ({"ta.stifness": 5.0}, r"ta.stifness = 5.0: unknown key; .* mean stiffness?"),
    "no table": ({"ta": 5}, "ta = 5: must be a table of keys"),
    "law": ({"ta.adhesion": "boud"}, "ta.adhesion = 'boud': must be .*; did you mean bound?"),
    "misspelt kind": ({"stm.stiffness": 5.0}, "stm: needs adhesion, or like, .* mean stem?"),
    "daughter": ({"stem.daughter": "ta2"}, "stem.daughter = 'ta2': must be a kind of cells, one "),
    "after the last": ({"ta.after_last": "exhaustd"}, ".* mean exhausted?"),
    "no cell": ({"nd.like": "dermal"}, "nd.like = 'dermal': must be a kind of cells, one of stem"),
    "pair": ({"ta.paired_with": "stm"}, "ta.paired_with = 'stm': must be .* mean stem?"),
    "reserved": ({"membrane.adhesion": "bound"}, "membrane: is reserved"),
    "type label": ({"2nd.adhesion": "bound"}, "'2nd': the name must be up to 32 lower-case"),
    "blank": ({"a b.adhesion": "bound"}, "'a b': the name must be up to 32 lower-case"),
    "capital": ({"Stem.stiffness": 5.0}, "'Stem': the name must be .*; did you mean stem?"),
    "no last": ({"stem.generations": 3}, "stem.generations = 3: needs after_last"),
    "no daughter": ({"nd.generations": 3}, "nd.generations = 3: needs daughter"),
    "endless": ({"stem.after_last": "nd"}, "stem.after_last = 'nd': needs generations"),
    "generations": ({"ta.generations": 1.5}, "ta.generations = 1.5: must be an integer from 0"),
    "circle": ({"a.like": "b", "b.like": "a"}, "a.like: is circular, a -> b -> a"),
    "none divides": (
        {"a": {"like": "ta", "generations": 0, "after_last": "b"},
         "b": {"like": "a", "after_last": "a"}},
        "a.after_last = 'b': no one divides in a -> b -> a",
    ),
    "no divisions": ({"ta": {"generations": 0, "count": 1}}, "ta.count = 1: has no divisions"),
    "colour": ({"ta.color": "red"}, "ta.color = 'red': must be \"#rrggbb\""),
    "count": ({"stem.count": 3}, "stem.count = 3: must be cells.stem = 2, or left out"),
    "no adhesion": ({"exhausted.stiffness": 1.0}, "exhausted.stiffness = 1: its adhesion is"),
    "no range": ({"stem.range": 1.5}, "stem.range = 1.5: it has no adhesion that ends"),
    "no pair": ({"ta.paired_stiffness": 1.0}, "ta.paired_stiffness = 1: needs paired_with"),
    "no stiffness": ({"ta.paired_with": "stem"}, "ta.paired_with = 'stem': needs paired_stiffness"),
}  # fmt: skip


def test_what_a_set_says_of_pairs_can_be_taken_away() -> None:
    plain, full = scene(parameters="earlier"), scene(parameters="earlier-full")
    alone = full.replace(**{"cells.kinds.ta.paired_with": "none"})
    assert full.cell_table["ta"].paired_with == "stem"
    assert alone.cell_table["ta"].paired_with is None
    said = [Terms.of(one).kind(one.cell_table["ta"], ["stem", "ta"]) for one in (plain, alone)]
    assert said[0] | {"cycle": said[1]["cycle"]} == said[1]  # whose first phases are 0
    softer = full.replace(**{"cells.kinds.ta.paired_stiffness": 9.0})
    assert softer.cell_table["ta"].paired_with == "stem"
    assert softer.cell_table["ta"].paired_stiffness == 9.0


@pytest.mark.parametrize("fault", REFUSED)
def test_refused(fault: str) -> None:
    changes, text = REFUSED[fault]
    with pytest.raises(SceneError) as error:
        scene(**{f"cells.kinds.{key}": value for key, value in changes.items()})
    line = str(error.value)
    assert "\n" not in line
    assert re.match(f"cells\\.kinds\\..*{text.replace('?', '[?]')}", line), line


def test_the_longest_table() -> None:
    chain = {f"k{n}": {"like": f"k{n + 1}"} for n in range(99)} | {"k99": {"like": "stem"}}
    assert scene(**{"cells.kinds": chain}).cell_table["k0"].daughter == "ta"
    with pytest.raises(SceneError, match="has 101 kinds, must have at most 100"):
        scene(**{"cells.kinds": {**chain, "one": {"like": "stem"}}})


# ---- what follows from the table


def test_the_fastest_cycle_sets_the_steps() -> None:
    fast = {"cells.kinds.ta.cycle_delay": 0.4, "cells.kinds.ta.cycle_rate": 10.0}
    own = scene(parameters="earlier-stiff", **fast)
    assert own.shortest_cycle == pytest.approx(0.5)
    assert own.numerics.timestep == 0.05 and own.numerics.event_interval == pytest.approx(0.05)
    assert not list(remarks(own))
    with pytest.raises(SceneError, match=r"event_interval = 0\.6: .* a cell cycle, 0.5"):
        own.replace(**{"numerics.event_interval": 0.6})


def test_the_stiffest_kind_counts() -> None:
    plain, own = scene(), scene(**{"cells.kinds.nd.stiffness": 1e6})
    assert stiffest(own) == stiffest(plain)  # there are no ND cells
    own = scene(**{"cells.kinds.ta.stiffness": 1e6})
    assert stiffest(own) == ("adhesion", pytest.approx(2e6 / own.contact))  # of direct forces
    wide = scene(**{"cells.kinds.ta.range": 1.9})
    assert Terms(wide).cutoffs["adhesion"] == pytest.approx(1.9 * wide.contact)


# ---- where cells start


@pytest.mark.parametrize("arrangement", ["ring", "cluster", "random", "core", "halves"])
def test_cells_of_all_kinds_share_the_places(arrangement: str) -> None:
    """The places are those of as many stem cells, and ND cells have theirs."""
    wide = {"membrane.lattice": [60, 70], "cells.nd": 2, "cells.arrangement": arrangement}
    own = place_cells(scene(**wide, **OWN, **{"cells.kinds.ta.count": 3}))
    plain = place_cells(scene(**wide, **{"cells.stem": 6}))
    assert [(kind.label, len(places)) for kind, places in own.items()] == [
        ("stem", 2), ("ta", 3), ("nd", 2), ("mutant", 1),
    ]  # fmt: skip
    np.testing.assert_array_equal(own[Kind.ND], plain[Kind.ND])
    others = np.concatenate([places for kind, places in own.items() if kind != Kind.ND])
    assert set(map(tuple, others)) == set(map(tuple, plain[Kind.STEM]))


def test_kinds_alternate_where_there_are_as_many() -> None:
    """On a ring, places of one kind are those of every second cell."""
    changes = {"membrane.lattice": [60, 70], "cells.stem": 3, "cells.kinds.b.count": 3}
    stem, other = place_cells(scene(**changes, **{"cells.kinds.b.like": "stem"})).values()
    (both,) = place_cells(scene(**{**changes, "cells.stem": 6, "cells.kinds": {}})).values()
    np.testing.assert_array_equal(stem, both[::2])
    np.testing.assert_array_equal(other, both[1::2])
