"""The kinds of the model in few words are those of the rows that say the same."""

from pathlib import Path

import pytest

from tests.cells.scripts import busy, error_of, fix_line, kind_rows, run_script, snapshots, told

TYPES = {"stem": "stem", "ta": "ta", "exhausted": "exhausted", "nd": "nd"}
SHARED = {
    "adhesion": "25 1.2", "binding": "25", "cycle": "2.0 0.5 2.0", "generations": "10",
}  # fmt: skip
REPORT = "OUT " + " ".join(f"$(f_cells[{n}]:%.15g)" for n in range(1, 12))


def words(**changes: str) -> str:
    """The keywords; one that is changed to nothing is left out."""
    given = {**TYPES, **SHARED, **changes}
    return " ".join(f"{keyword} {values}" for keyword, values in given.items() if values)


def test_they_do_the_same_as_rows(tmp_path: Path) -> None:
    """Births, energies, counts and places, to the last bit; cells that are lifted leave."""
    lifted = [
        "group lifted type ta", "set group lifted type/fraction exhausted 0.5 1",
        "set type exhausted i_divisions_left 0 d_next_division -1",
        "displace_atoms lifted move 0 0 1.0", "run 8 post no",
    ]  # fmt: skip
    runs = []
    for name, kinds in (("rows", kind_rows()), ("words", words())):
        fix = fix_line(busy()).replace(kind_rows(), kinds)
        lines = [
            f"fix cells cells {fix} log events.csv", "run 32 post no", f'print "{REPORT}"',
            "write_dump all custom x.dump id type x y z modify sort id format float %.17g",
            *lifted,
        ]  # fmt: skip
        (tmp_path / name).mkdir()
        counts = told(run_script(tmp_path / name, *lines, scene=busy()))
        runs.append((counts, snapshots(tmp_path / name / "x.dump")[0]["x"].tolist()))
    assert runs[0] == runs[1]
    events = (tmp_path / "words" / "events.csv").read_text()
    assert events == (tmp_path / "rows" / "events.csv").read_text()
    assert events.count(",birth,") >= 5
    gone = {row.split(",")[4] for row in events.splitlines() if ",death," in row}
    assert gone == {"4", "5"}  # TA and exhausted


def test_further_kinds_may_be_given_before_and_after(tmp_path: Path) -> None:
    """They are number 7 in the log and entry 12 of the vector."""
    mutant = "kind mutant type mutant law bound 75 cycle 2.0 0.5 2.0 daughter mutant"
    scene = busy(**{"cells.kinds.mutant.like": "stem", "cells.kinds.mutant.count": 1})
    runs = []
    for name, kinds in (("before", f"{mutant} {words()}"), ("after", f"{words()} {mutant}")):
        fix = fix_line(scene).replace(kind_rows(), kinds)
        lines = ["unfix cells", "unfix skin_cells_record", f"fix cells cells {fix} log events.csv"]
        count = 'print "OUT $(f_cells[12])"'
        (tmp_path / name).mkdir()
        ((mutants,),) = told(run_script(tmp_path / name, *lines, "run 32", count, scene=scene))
        births = (tmp_path / name / "events.csv").read_text()
        assert sum(row.split(",")[4] == "7" for row in births.splitlines()) >= mutants - 1 >= 1
        runs.append(births)
    assert runs[0] == runs[1]


@pytest.mark.parametrize(
    ("kinds", "said"),
    [
        ({"binding": ""}, "needs the keyword binding with the keyword exhausted"),
        ({"ta": ""}, "kind stem daughter = ta: there is no such kind"),
        ({"exhausted": ""}, "kind ta last = exhausted: there is no such kind"),
        ({"nd": "stem"}, "kind nd: atom type 2 is that of kind stem"),
        ({"adhesion": "25 1.0"}, "adhesion lambda = 1.0: must be > 1"),
        ({"generations": "-1"}, "generations = -1: must be an integer >= 0"),
        (dict.fromkeys(TYPES, ""), "adhesion: is for the kinds stem, ta, exhausted and nd"),
        ({name: "" for name in (*TYPES, *SHARED)}, "needs the keyword kind"),
        ({"nd": "nd kind nd type nd law bound 25"}, "kind nd: there are two kinds of this name"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_them(kinds: dict[str, str], said: str, built: Path) -> None:
    fix = fix_line(busy()).replace(kind_rows(), words(**kinds))
    assert f"Fix skin/cells {said}" in error_of(run_script(built, f"fix cells cells {fix}"))


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    directory = tmp_path_factory.mktemp("built")
    run_script(directory, "run 0", scene=busy())
    return directory
