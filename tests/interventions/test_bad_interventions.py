"""Interventions that cannot be: one line that names the key, its value and what is allowed."""

import re
import tomllib
from pathlib import Path

import pytest
from lammps_skin.errors import SceneError
from lammps_skin.model.interventions import RESERVED
from lammps_skin.model.remarks import remarks
from lammps_skin.model.scene import Scene
from lammps_skin.model.scene_keys import to_toml

ROOT = Path(__file__).resolve().parents[2]
SCENE = """
end_time = 400.0
[membrane]
lattice = [24, 28]
[cells]
stem = 2
[numerics]
timestep = 0.25
event_interval = 0.5
"""
AT = 'name = "w"\nat = 5.0\n'
REMOVE = AT + 'remove = "all"\n'
ADD = AT + 'add = "stem"\n'
NEXT = "[[interventions]]\n"


def scene_with(*tables: str) -> Scene:
    return Scene.from_dict(tomllib.loads(SCENE + "".join(f"{NEXT}{table}\n" for table in tables)))


FAULTS = {
    # who, when
    'at = 3.0\nremove = "ta"': "1: needs the key `name`",
    'name = 3\nat = 2\nremove = "ta"': "1.name = 3: must be a valid string",
    'name = "w x"\nat = 1\nremove = "ta"': "name = 'w x': must be up to 32 letters, digits",
    'name = "detached"\nat = 1\nremove = "ta"': "name = 'detached': is the cause of other events",
    f"{REMOVE}{NEXT}{REMOVE}": "name = 'w': is the name of two",
    'name = "w"\nremove = "ta"': "w: needs the key `at`, a time, or `every`",
    'name = "w"\nat = 0\nremove = "ta"': "w.at = 0: must be greater than 0",
    'name = "w"\nat = "x"\nremove = "ta"': "w.at = 'x': must be a valid number",
    f'{REMOVE}{NEXT}name = "x"\nat = 1\nremove = "ta"': (
        "x.at = 1: must be in the order of times, not before w, which stands above it, at 5"
    ),
    f"{REMOVE}until = 9.0": "w.until = 9.0: goes with every",
    f"{REMOVE}every = 1.0\nuntil = 4.0": "w.until = 4: must be 5, the first time, or later",
    f"{REMOVE}every = 0.1": "w.every = 0.1: must be at least the timestep, 0.25",
    # what
    AT: "w: does nothing, must have one of remove, convert, add, set",
    f'{REMOVE}add = "ta"\nplaces = [[1, 1]]': "w: has remove and add, must have one of",
    f"{AT}every = 1.0\nset = {{seed = 3}}": "w.every = 1.0: goes with remove or convert or add",
    f"{REMOVE}fracton = 0.5": "w.fracton = 0.5: unknown key; allowed: name, at, .*mean fraction",
    f"{REMOVE}radius = 3": "w.radius = 3: unknown key; allowed: [^;]*$",  # no key of other tables
    'name = "w"\ntime = 10\nremove = "ta"': "w.time = 10: unknown .*within; did you mean at\\?$",
    f"{REMOVE}within = {{disk = [5, 5, 2]}}": "allowed: cylinder, half_space; did .* cylinder\\?$",
    f"{REMOVE}fraction = 0": "w.fraction = 0: must be greater than 0",
    f"{REMOVE}fraction = 1.5": "w.fraction = 1.5: must be less than or equal to 1",
    f'{AT}remove = "tas"': "w.remove = 'tas': must be a kind of cells, one of .*did you mean ta?",
    f"{AT}remove = []": "w.remove = \\[\\]: must be a kind of cells, an array of kinds, or 'all'",
    f'{AT}remove = "nd"': "w.remove = 'nd': there can be no cells of this kind; .* stem, ta, exh",
    f'{AT}convert = "stem"': "w.convert = \\['stem'\\]: needs the key `to`, the kind that the",
    f'{AT}convert = "stem"\nto = "stem"': "w.to = 'stem': is what they are",
    f'{REMOVE}to = "stem"': "w.to = 'stem': goes with convert",
    # where
    f"{REMOVE}within = {{}}": "w.within: must have cylinder or half_space, or both",
    f"{REMOVE}within = {{cylindr = [1, 2, 3]}}": "w.within.cylindr = .*did you mean cylinder?",
    f"{REMOVE}within = {{cylinder = [1, 2]}}": (
        "w.within.cylinder = \\[1, 2\\]: must be \\[x, y, radius\\]"
    ),
    f"{REMOVE}within = {{cylinder = [99, 2, 3]}}": "w.within.cylinder = .*: must be inside the box",
    f"{REMOVE}within = {{half_space = [0, 0, 0, 1]}}": "half_space = .*: must be .* n not 0",
    f"{REMOVE}within = {{half_space = [1, 0, 0, 12]}}": "no place in the box is in it; .* below 12",
    ADD: "w.add = 'stem': needs the key `places`, where the new cells are",
    f"{ADD}places = [1, 2]": "w.places = \\[1, 2\\]: must be an array of places",
    f"{ADD}places = [[1, 200]]": "w.places = \\[1.0, 200.0\\]: must be inside the box, 12 x 12.12",
    f"{ADD}places = {[[1.0, 1.0]] * 1001}": "w.places: there are 1,001, must be 1,000 at most",
    f"{ADD}places = [[1, 1], [11.5, 1]]": "w.places: .* are 1.5 apart, must be at least 2.8",
    # keys that are set
    f"{AT}set = {{}}": "w.set = {}: must be a table of keys",
    f"{AT}set = {{seed = 3}}": "w.set.seed = 3: cannot change in a run; can: dermis.stiffness, ",
    f'{AT}set = {{"dermis.stifness" = 3}}': "cannot change .*; did you mean dermis.stiffness?",
    f'{AT}set = {{"cells.kinds.ta.daughter" = "ta"}}': "cannot change in a run; can: adhesion, ",
    f'{AT}set = {{"cells.kinds.taa.range" = 2}}': "'taa' is no kind of cells; .*did you mean ta?",
    f'{AT}set = {{"dermis.stiffness" = -1}}': (
        "w.set: dermis.stiffness = -1: must be greater than or equal to 0"
    ),
    f'{AT}set = {{"dermis.stiffness" = 0}}': (
        "w.set.dermis.stiffness = 0: must be greater than 0, since this force keeps particles apart"
    ),
    f'{AT}set = {{"cells.kinds.stem.generations" = 3}}': "kinds.stem.generations = 3: needs aft",
}  # fmt: skip


@pytest.mark.parametrize("table", FAULTS)
def test_faults(table: str) -> None:
    with pytest.raises(SceneError, match=rf"^interventions\..*{FAULTS[table]}") as error:
        scene_with(table)
    assert "\n" not in str(error.value)


def test_they_are_an_array_of_tables() -> None:
    for wrong in (3, [3], {"name": "w"}):
        with pytest.raises(SceneError, match=r"interventions = .*: must be a.* tables? of keys"):
            Scene.from_dict({"interventions": wrong})


def test_remarks_on_times() -> None:
    """What does not happen, or happens later, is told, since the end may be another for one run."""
    scene = scene_with(REMOVE, 'name = "s"\nat = 5.1\nset = {"dermis.stiffness" = 0.05}')
    assert list(remarks(scene)) == [
        "interventions.s.at = 5.1: is no whole number of steps of 0.25, and becomes 5.25"
    ]
    assert "interventions.w.at = 5: is not before end_time = 5, and does not happen" in list(
        remarks(scene.replace(end_time=5.0))
    )
    forked = scene.replace(**{"start.from": "run", "start.time": 5.0})
    assert "interventions.w.at = 5: is not after start.time = 5, and it is not done again" in list(
        remarks(forked)
    )
    assert list(remarks(forked.replace(**{"interventions.w.at": 4.75, "start.time": 4.75}))) == [
        "interventions.s.at = 5.1: is no whole number of steps of 0.25, and becomes 5.25"
    ]  # the wound is made on the event step at t = 5
    later = forked.replace(**{"start.time": 6.0})
    assert (
        "interventions.s.at = 5.1: is not after start.time = 6, and its values hold from the start"
        in list(remarks(later))
    )
    idle = scene.replace(**{"dermis.present": False, "interventions.s.at": 6.0})
    assert list(remarks(idle)) == [
        "interventions.s.set: changes nothing, for the scene has nothing that it concerns"
    ]
    again = scene_with(f"{REMOVE}every = 0.5\nuntil = 6.0").replace(
        **{"start.from": "run", "start.time": 5.5}
    )
    assert not list(remarks(again))
    assert "is not after start.time = 6" in next(remarks(again.replace(**{"start.time": 6.0})))


def test_keys_are_changed_by_names(tmp_path) -> None:
    """And a scene that is written is read as it was."""
    scene = scene_with(
        f"{REMOVE}within = {{cylinder = [1.0, 2.0, 3.0]}}",
        'name = "s"\nat = 6.0\nset = {"dermis.stiffness" = 0.05, cells.kinds.ta.range = 2.0}',
    )
    changed = scene.replace(
        **{"interventions.w.at": 4.0, "interventions.s.set.dermis.stiffness": 0.06}
    )
    assert [one.first for one in scene.interventions] == [5.0, 6.0]
    assert [one.first for one in changed.interventions] == [4.0, 6.0]
    assert changed.later_stages[0].dermis.stiffness == 0.06
    assert changed.later_stages[0].cell_table["ta"].range == 2.0
    assert Scene.from_dict(tomllib.loads(to_toml(changed.given()))) == changed


@pytest.mark.parametrize(
    ("names", "key", "said"),
    [
        (["disk", "s"], "disc.at", "no intervention has the name disc; there are disk, s; "
         "did you mean disk?"),
        (["disk"], "x.at", "no intervention has the name x; there are disk"),
        ([], "x.at", "no intervention has the name x; there are none"),
        (["disk"], "disk", "is no key; one is interventions.disk.at"),
    ],
)  # fmt: skip
def test_keys_of_interventions_that_are_not_there(names, key, said) -> None:
    scene = scene_with(*(REMOVE.replace("w", name) for name in names))
    with pytest.raises(SceneError) as error:
        scene.replace(**{f"interventions.{key}": 3})
    assert str(error.value) == f"interventions.{key} = 3: {said}"


def test_kinds_that_are_made_can_occur() -> None:
    """And all that comes of them."""
    labels = [kind.label for kind in scene_with(f'{AT}convert = "stem"\nto = "nd"').kinds]
    assert labels == ["dermal", "membrane", "stem", "ta", "exhausted", "nd"]
    bare = scene_with(f"{ADD}places = [[1, 1]]").replace(**{"cells.stem": 0})
    assert bare.has_cells and [row.label for row in bare.cell_kinds] == ["stem", "ta", "exhausted"]


def test_causes_that_are_no_names_are_those_of_the_fix() -> None:
    code = (ROOT / "plugins/skin_interventions.cpp").read_text()
    found = re.search(r"OTHER_CAUSES\[\] = \{(.*?)\}", code, re.DOTALL)
    assert found
    assert sorted(re.findall(r"\w+", found[1])) == sorted(RESERVED)
