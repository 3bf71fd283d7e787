"""Keys and words that are misspelt: what may have been meant; keys that hold dots; byte order."""

import pytest
from lammps_skin.errors import SceneError
from lammps_skin.model.scene import Scene
from lammps_skin.model.scene_keys import near

KEYS = {
    '"a.b" = 1': ('"a.b" = 1: unknown key; allowed: name, ', None),
    '"seed.x" = 1': ('"seed.x" = 1: unknown key; allowed: name, ', "seed"),
    '"" = 1': ('"" = 1: unknown key; allowed: name, ', None),
    '"a\\nb" = 1': ("a b = 1: unknown key; ", None),
    '[cells]\n"stem.x" = 1': ('cells."stem.x" = 1: unknown key; allowed: stem, ', "stem"),
    '[membrane]\n"a.b".c = 1': ("membrane.\"a.b\" = {'c': 1}: unknown key; allowed: latt", None),
    "[cells.seed]\nx = 1": ("cells.seed = {'x': 1}: must be a valid integer", None),
    "sed = 2": ("sed = 2: unknown key; ", "seed"),
    "[cels]\nstem = 2": ("cels = {'stem': 2}: unknown key; ", "cells"),
    "[cells]\nstems = 2": ("cells.stems = 2: unknown key; ", "stem"),
    "[numerics]\ntimestp = 0.1": ("numerics.timestp = 0.1: unknown key; ", "timestep"),
    "stem = 2": ("stem = 2: unknown key; ", "cells.stem"),
    "timestep = 0.1": ("timestep = 0.1: unknown key; ", "numerics.timestep"),
    '[cells]\narrangement = "rings"': ("cells.arrangement = 'rings': must be 'ring', ", "ring"),
    '[numerics]\naccuracy = "balansed"': ("numerics.accuracy = 'balansed': must be ", "balanced"),
    '[numerics]\nintegrator = "Euler"': ("numerics.integrator = 'Euler': must be ", "euler"),
    'parameters = "papila"': ("parameters = 'papila': must be one of printed, ", "papilla"),
    '[dermis]\npresent = "True"': ("dermis.present = 'True': must be a valid boolean", None),
    'end_time = "10 min"': ("end_time = '10 min': must be a number, in the reduced units", None),
    '[dermis]\nstiffness = "12.5 pN"': ("dermis.stiffness = '12.5 pN': must be a number, in", None),
    'end_time = "long"': ("end_time = 'long': must be a valid number", None),
    "qqqqqqq = 1": ("qqqqqqq = 1: unknown key; ", None),
}


@pytest.mark.parametrize("text", KEYS)
def test_keys_and_values(text, refused, tmp_path):
    expected, meant = KEYS[text]
    (tmp_path / "x.toml").write_text(text)
    said = refused("check", "x.toml").removeprefix("scene file x.toml: ")
    assert said.startswith(expected)
    assert said.partition("; did you mean ")[2] == (f"{meant}?" if meant else "")


@pytest.mark.parametrize(
    ("arguments", "meant"),
    [
        (("check", "quater-ring"), "quarter-ring"),
        (("check", "Demo"), "demo"),
        (("run", "dmo"), "demo"),
        (("ensemble", "one_stem"), "one-stem"),
        (("check", "demo", "--set", "cells.arangement=ring"), "arrangement"),
        (("check", "demo", "--set", "cells.arrangement=rnig"), "ring"),
        (("check", "demo", "--set", "seeds=3"), "seed"),
        (("check", "demo", "--set", "numerics.pair_form=skins"), "skin"),
        (("check", "demo", "--accuracy", "fst"), "fast"),
        (("check", "demo", "--parameters", "week5"), "weak5"),
        (("stability", "demo", "--vary", "bendin"), "bending"),
        (("stability", "demo", "--methods", "eulr"), "euler"),
        (("snapshot", "nowhere", "--view", "sction"), "section"),
        (("export", "nowhere", "--to", "vtx"), "vtk"),
    ],
    ids=lambda value: value if isinstance(value, str) else " ".join(value),
)
def test_words_of_the_command_line(arguments, meant, refused):
    assert refused(*arguments).endswith(f"; did you mean {meant}?")


def test_far_words_are_not_offered_and_long_ones_take_no_time():
    assert near("xyz", ["demo", "ring"]) == near("", ["demo"]) == ""
    assert near("ring" * 10**6, ["ring"]) == ""


@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"])
def test_a_byte_order_mark_is_no_part_of_the_text(mark, tmp_path):
    path = tmp_path / "x.toml"
    path.write_bytes(mark + b'name = "marked"\n')
    assert Scene.load(path).name == "marked"


def test_other_encodings_are_named(tmp_path):
    path = tmp_path / "x.toml"
    path.write_bytes('name = "x"'.encode("utf-16"))
    with pytest.raises(SceneError, match="not text in UTF-8"):
        Scene.load(path)
