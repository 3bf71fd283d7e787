"""Wrong arguments and settings of fix skin/cells: each gives one error that says what is wrong."""

from collections.abc import Iterator
from typing import Any

import pytest
from lammps_skin.engine.engine import lammps_message, open_lammps

PROPERTIES = (
    "i_divisions_left i_divisions_done i_parent i_pair "
    "d_next_division d_birth_time d_pair_start d_detached_time"
)
# one membrane particle below each of three cells: stem, TA, exhausted
SETTING = {
    "style": "atom_style molecular",
    "newton": "newton on",
    "boundary": "boundary p p f",
    "region": "region box block 0 12 0 12 0 20",
    "box": "create_box 5 box",
    "state": f"fix state all property/atom {PROPERTIES}",
    "sheet": "create_atoms 1 single 3 3 5",
    "stem": "create_atoms 2 single 3 3 7.4",
    "ta": "create_atoms 3 single 4 3 7",
    "mass": "mass * 1",
    "pair": "pair_style zero 4.0 nocoeff",
    "coefficients": "pair_coeff * *",
    "neighbor": "neighbor 0.3 bin",
    "rebuild": "neigh_modify every 1 delay 0 check yes",
    "reach": "comm_modify cutoff 5.0",
    "schedule": "set type 2*3 d_next_division -1 d_detached_time -1",
    "generation": "set type 2*3 i_divisions_left 3",
    "group": "group cells type 2:5",
}
ARGUMENTS = {
    "membrane": "1", "contact": "2.4",
    "kind stem": "type 2 law bound 25 cycle 36 0.083 48 daughter ta",
    "kind ta": "type 3 law adhesive 25 1.2 detach 1.2 cycle 36 0.083 48 daughter ta "
    "generations 10 last exhausted",
    "kind exhausted": "type 4 law none detach 1.2", "kind nd": "type 5 law bound 25",
    "spring": "5 0.014 0.14 2.8", "offset": "0.007", "every": "10",
}  # fmt: skip
REQUIRED = ["membrane", "contact", "spring", "offset"]


@pytest.fixture
def lammps() -> Iterator[Any]:
    engine = open_lammps(["-log", "none"])
    yield engine
    engine.close()


def start(lammps: Any, setting: dict[str, str], arguments: dict[str, str], seed: str = "1") -> None:
    """A run of no steps; a keyword with the value - is left out."""
    for command in {**SETTING, **setting}.values():
        lammps.commands_string(command)
    words = [f"{key} {value}" for key, value in {**ARGUMENTS, **arguments}.items() if value != "-"]
    lammps.command(f"fix cells cells skin/cells {seed} " + " ".join(words))
    lammps.command("run 0 post no")


def error_of(lammps: Any, *arguments: Any, **more: Any) -> str:
    with pytest.raises(Exception) as error:
        start(lammps, *arguments, **more)
    return lammps_message(str(error.value))


def test_setting_is_right(lammps: Any) -> None:
    """What the other tests spoil one by one runs as it is."""
    start(lammps, {}, {})
    assert [lammps.extract_fix("cells", 0, 1, n, 0) for n in (3, 4, 5, 6)] == [1, 1, 0, 0]


@pytest.mark.parametrize("keyword", REQUIRED)
def test_required_keyword(lammps: Any, keyword: str) -> None:
    assert error_of(lammps, {}, {keyword: "-"}) == f"Fix skin/cells needs the keyword {keyword}"


NUMBER = "Expected floating point parameter instead of"
INTEGER = "Expected integer parameter instead of"


@pytest.mark.parametrize(
    ("keyword", "value", "message"),
    [
        ("membrane", "9", "Fix skin/cells membrane = 9: there are atom types 1 to 5"),
        ("membrane", "0", "Fix skin/cells membrane = 0: there are atom types 1 to 5"),
        ("membrane", "2", "Fix skin/cells: atom type 2 is both membrane and kind stem"),
        ("contact", "0", "Fix skin/cells contact = 0: must be a number > 0"),
        ("contact", "-2.4", "Fix skin/cells contact = -2.4: must be a number > 0"),
        ("contact", "wide", f"{NUMBER} 'wide'"),
        ("contact", "nan", f"{NUMBER} 'nan'"),
        ("contact", "1e999", "Floating point number 1e999"),
        ("spring", "-5 0.014 0.14 2.8", "Fix skin/cells spring K = -5: must be a number >= 0"),
        ("spring", "5 -1 0.14 2.8", "Fix skin/cells spring start = -1: must be a number >= 0"),
        ("spring", "5 0.014 0 2.8", "Fix skin/cells spring rate = 0: must be a number > 0"),
        (
            "spring", "5 2.8 0.14 2.8",
            "Fix skin/cells spring: its end 2.8 must be longer than its start 2.8",
        ),
        ("offset", "0", "Fix skin/cells offset = 0: must be a number > 0"),
        ("every", "0", "Fix skin/cells every = 0: must be an integer >= 1"),
        ("every", "0.5", f"{INTEGER} '0.5'"),
        ("every", "", "Fix skin/cells every needs 1 value(s) but got 0"),
        ("spring", "5 0.014", f"{NUMBER} 'offset'"),
        ("colour", "red", "Unknown fix skin/cells keyword: colour"),
    ],
)  # fmt: skip
def test_value(lammps: Any, keyword: str, value: str, message: str) -> None:
    assert error_of(lammps, {}, {keyword: value}).startswith(message)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("", "needs 1 value(s) but got 0"),
        ("a,b at 1 change", "a,b: a name has letters, digits, _ and - only"),
        ("grown at 1 change", "grown: this name is that of another cause in the event log"),
        ("a at 1 change intervene a at 2 change", "a: there are two interventions of this name"),
        ("a remove all", "a needs at and a time after its name"),
        ("a at -1 change", "a at = -1: must be a number >= 0"),
        ("a at 1 every 0 change", "a every = 0: must be a number > 0"),
        ("a at 2 every 1 until 1 change", "a until = 1: must be >= 2, its first time"),
        ("a at 1 until 3 change", "a needs remove, convert, add or change after its times"),
        ("a at 1 destroy all", "a needs remove, convert, add or change after its times"),
        ("a at 1 remove nerve", "a kind = nerve: there is no such kind"),
        ("a at 1 remove ta,nerve", "a kind = nerve: there is no such kind"),
        ("a at 1 convert all all", "a kind = all: there is no such kind"),
        ("a at 1 convert ta", "a convert needs 2 value(s) but got 1"),
        ("a at 1 remove all fraction 0", "a fraction = 0: must be a number > 0"),
        ("a at 1 remove all fraction 1.5", "a fraction = 1.5: must be <= 1"),
        ("a at 1 remove all cylinder 13 3 2",
         "a cylinder x = 13: must be within the box, from 0 to 12"),
        ("a at 1 remove all cylinder 3 3 0", "a cylinder R = 0: must be a number > 0"),
        ("a at 1 remove all half_space 1 0 0 12",
         "a half_space = 1 0 0 12: no place in the box is in it"),
        ("a at 1 remove all half_space 0 0 0 0",
         "a half_space = 0 0 0 0: no place in the box is in it"),
        ("a at 1 add ta 3 3 21", "a add z = 21: must be within the box, from 0 to 20"),
        ("a at 1 add ta 3 3", "a add needs 3 value(s) but got 2"),
        ("a at 1 add ta 3 3 nearest 4 4", "a add needs 3 value(s) but got 2"),
    ],
)  # fmt: skip
def test_intervention(lammps: Any, words: str, message: str) -> None:
    error = error_of(lammps, {}, {"intervene": words})
    assert error == f"Fix skin/cells intervene {message}"


def test_two_actions(lammps: Any) -> None:
    error = error_of(lammps, {}, {"intervene": "a at 1 remove all convert all ta"})
    assert error == "Unknown fix skin/cells keyword: convert"


CYCLE = "cycle 36 0.083 48"


@pytest.mark.parametrize(
    ("name", "row", "message"),
    [
        ("stem", "type 6", "stem type = 6: there are atom types 1 to 5"),
        ("nd", "type", "nd type needs 1 value(s) but got 0"),
        ("nd", "law bound 25", "nd needs the keyword type"),
        ("nd", "type 4", "nd: atom type 4 is that of kind exhausted"),
        ("nd", "type 5 number 0", "nd number = 0: must be an integer >= 1"),
        ("nd", "type 5 number 3", "nd number = 3: is that of kind stem"),
        ("nd", "type 5 kind ta type 3", "ta: there are two kinds of this name"),
        ("nd", "type 5 kind all type 3", "all: its name must not be empty or all"),
        ("nd", "type 5 kind a,b type 3", "a,b: its name must not be empty or all"),
        ("nd", "type 5 law sticky 3", "nd law = sticky: must be bound, adhesive or none"),
        ("nd", "type 5 law bound -25", "nd law bound K = -25: must be a number >= 0"),
        ("nd", "type 5 law adhesive -1 1.2", "nd law adhesive K = -1: must be a number >= 0"),
        ("nd", "type 5 law adhesive 25 1", "nd law adhesive lambda = 1: must be > 1"),
        ("nd", "type 5 law adhesive 25", "nd law needs 2 value(s) but got 1"),
        ("nd", "type 5 detach 0.9", "nd detach lambda = 0.9: must be > 1"),
        ("nd", "type 5 cycle -1 0.1 48", "nd cycle T0 = -1: must be a number >= 0"),
        ("nd", "type 5 cycle 36 0 48", "nd cycle gamma = 0: must be a number > 0"),
        ("nd", "type 5 cycle 36 0.1 -1", "nd cycle first phase = -1: must be a number >= 0"),
        ("nd", "type 5 generations -1", "nd generations = -1: must be an integer >= 0"),
        ("nd", "type 5 daughter nerve", "nd daughter = nerve: there is no such kind"),
        ("nd", "type 5 last nerve", "nd last = nerve: there is no such kind"),
        ("nd", "type 5 daughter ta", "nd: daughter needs cycle"),
        ("nd", f"type 5 {CYCLE}", "nd: cycle needs daughter"),
        ("nd", "type 5 generations 3", "nd: generations needs daughter"),
        ("nd", "type 5 last ta", "nd: last needs daughter"),
        ("nd", f"type 5 {CYCLE} daughter nd generations 3", "nd generations = 3: needs last"),
        (
            "nd", f"type 5 {CYCLE} daughter nd generations 0 last nd",
            "nd: a cell that enters it has 0 generations in it and in all kinds that follow",
        ),
        ("ta", "-", "stem daughter = ta: there is no such kind"),
        ("exhausted", "-", "ta last = exhausted: there is no such kind"),
    ],
)  # fmt: skip
def test_kind(lammps: Any, name: str, row: str, message: str) -> None:
    last = {f"kind {name}": "-", **({f" kind {name}": row} if row != "-" else {})}
    assert error_of(lammps, {}, last).startswith(f"Fix skin/cells kind {message}")


def test_no_kind(lammps: Any) -> None:
    none = dict.fromkeys((key for key in ARGUMENTS if key.startswith("kind")), "-")
    assert error_of(lammps, {}, none) == "Fix skin/cells needs the keyword kind"


@pytest.mark.parametrize("seed", ["0", "-7"])
def test_seed(lammps: Any, seed: str) -> None:
    message = f"Fix skin/cells seed = {seed}: must be an integer > 0"
    assert error_of(lammps, {}, {}, seed=seed) == message


SETTINGS = [
    ({"newton": "newton off"}, "Fix skin/cells needs newton on"),
    (
        {"boundary": "boundary p p p"},
        "Fix skin/cells removes cells through the top of the box: it needs boundary p p f",
    ),
    ({"boundary": "boundary p p s"}, "Fix skin/cells removes cells through the top of the box"),
    (
        {"rebuild": "neigh_modify every 1 delay 5 check yes"},
        "Fix skin/cells needs neigh_modify every 1 delay 0 check yes once no, or the nearest "
        "membrane particle would not be exact; it got every 1 delay 5 check yes once no",
    ),
    ({"rebuild": "neigh_modify every 2 delay 0 check yes"}, "Fix skin/cells needs neigh_modify"),
    ({"rebuild": "neigh_modify every 1 delay 0 check no"}, "Fix skin/cells needs neigh_modify"),
    ({"once": "neigh_modify once yes"}, "Fix skin/cells needs neigh_modify"),
    (
        {
            "style": "atom_style molecular\natom_modify map yes",
            "include": "group cells type 2:5\natom_modify first cells\nneigh_modify include cells",
        },
        "Fix skin/cells does not work with neigh_modify include",
    ),
    (
        {"neighbor": "neighbor 0.3 multi", "mode": "comm_modify mode multi"},
        "Fix skin/cells needs one communication cutoff for all",
    ),
    (
        {"style": "atom_style atomic\natom_modify map yes"},
        "Fix skin/cells needs an atom style with ",
    ),
    (
        {"special": "special_bonds lj/coul 0.5 1.0 1.0"},
        "Fix skin/cells needs special_bonds with weights 0.0 of 1-2 neighbors",
    ),
    (
        {"respa": "run_style respa 2 2"},
        "Fix skin/cells does not work with run_style respa",
    ),
    (
        {"pair": "pair_style zero 2.0 nocoeff", "reach": "comm_modify cutoff 3.4"},
        "Fix skin/cells needs a communication cutoff of at least 3.48 but has 3.4",
    ),
    (
        {"generation": "set type 2*3 i_divisions_left 0"},
        "Fix skin/cells: cell 3 is of kind ta and has 0 divisions left",
    ),
    (
        {
            "ta": "create_atoms 3 single 4 3 7\ncreate_atoms 4 single 6 3 7",
            "generation": "set type 2*4 i_divisions_left 3",
        },
        "Fix skin/cells: cell 4 is of kind exhausted and has 3 divisions left",
    ),
    (
        {"generation": "set type 2*3 i_divisions_left -2"},
        "Fix skin/cells: cell 2 is of kind stem and has -2 divisions left",
    ),
    (
        {"paired": "set atom 2 i_pair 2"},
        "Fix skin/cells: cell 2 is paired with 2, which is no other cell",
    ),
    (
        {"paired": "set atom 2 i_pair 77"},
        "Fix skin/cells: cell 2 is paired with 77, which is no other cell",
    ),
    (
        {"paired": "create_atoms 5 single 9 9 5\nset atom 2 i_pair 4"},
        "Fix skin/cells: cell 2 is paired with 4, which is no cell that is paired with it",
    ),
    (
        {"paired": "set atom 2 i_pair 1"},
        "Fix skin/cells: cell 2 is paired with 1, which is no cell that is paired with it",
    ),
    (
        {"paired": "set atom 2 i_divisions_done -5"},
        "Fix skin/cells: divisions_done = -5 of cell 2 must be >= 0",
    ),
    (
        {"paired": "set atom 2 i_parent -9"},
        "Fix skin/cells: parent = -9 of cell 2 must be >= 0",
    ),
    (
        {"paired": "set atom 2 i_parent 2"},
        "Fix skin/cells: parent = 2 of cell 2 must be another cell, or 0 for none",
    ),
    (
        {"stem": "create_atoms 2 single 3 3 12"},
        "Fix skin/cells: stem cell 2 has lost the membrane on step 0",
    ),
]


@pytest.mark.parametrize(("setting", "message"), SETTINGS, ids=lambda value: str(value)[:60])
def test_setting(lammps: Any, setting: dict[str, str], message: str) -> None:
    assert error_of(lammps, setting, {}).startswith(message)


def test_no_properties(lammps: Any) -> None:
    message = error_of(lammps, {"state": "", "schedule": "", "generation": ""}, {})
    assert message.startswith("Fix skin/cells needs the per-atom property i_divisions_left")


@pytest.mark.parametrize("missing", PROPERTIES.split())
def test_property_of_cells(lammps: Any, missing: str) -> None:
    rest = PROPERTIES.replace(missing, "")
    setting = {"state": f"fix state all property/atom {rest}", "schedule": "", "generation": ""}
    assert error_of(lammps, setting, {}) == (
        f"Fix skin/cells needs the per-atom property {missing}: define fix ID all property/atom "
        f"{PROPERTIES} first"
    )


def test_event_log_that_cannot_be_written(lammps: Any) -> None:
    message = error_of(lammps, {}, {"log": "/nowhere/events.csv"})
    assert message == (
        "Fix skin/cells: cannot create the event log /nowhere/events.csv: No such file or directory"
    )
