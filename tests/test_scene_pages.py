"""The pages on scenes have the keys, defaults, sets and built-in scenes that there are."""

import inspect
import json
import re
from typing import Any

import numpy as np
from lammps_skin.model import parameters, potentials
from lammps_skin.model.accuracy import LEVELS
from lammps_skin.model.cell_kinds import ROWS, CellKind
from lammps_skin.model.interventions import (
    NEEDS,
    RESERVED,
    SETTABLE,
    SETTABLE_OF_KINDS,
    Intervention,
    Region,
)
from lammps_skin.model.parts import KindKeys
from lammps_skin.model.scene import Scene
from lammps_skin.model.scenes import BUILT_IN
from lammps_skin.model.stiffness import FOLDS
from lammps_skin.model.terms import Terms
from lammps_skin.start.packing import FORCE_TOLERANCE, dermal_count
from pages import codes, rows, section
from pydantic import BaseModel


def fields(model: type[BaseModel], prefix: str = "") -> dict[str, dict[str, Any]]:
    """JSON schema of every key of a scene."""
    schema = model.model_json_schema()["properties"]
    found = {}
    for name, field in model.model_fields.items():
        if inspect.isclass(field.annotation) and issubclass(field.annotation, BaseModel):
            found |= fields(field.annotation, f"{name}.")
        elif name not in ("kinds", "interventions"):  # which have pages of their own
            found[prefix + name] = schema[name]
    return found


def allowed(schema: dict[str, Any]) -> str:
    """What a schema allows, in the words of the page."""
    if "anyOf" in schema:
        choices = [choice for choice in schema["anyOf"] if choice.get("type") != "null"]
        return ", ".join(map(allowed, choices))
    if "enum" in schema:
        return ", ".join(f'`"{value}"`' for value in schema["enum"])
    if schema["type"] == "array":
        return f"{schema['maxItems']} of {allowed(schema['prefixItems'][0])}"
    if schema["type"] in ("string", "boolean"):
        return {"string": "text", "boolean": "`true`, `false`"}[schema["type"]]
    signs = {"exclusiveMinimum": ">", "minimum": ">=", "exclusiveMaximum": "<", "maximum": "<="}
    limits = [f"{sign} {schema[key]}" for key, sign in signs.items() if key in schema]
    whole = ["integer"] if schema["type"] == "integer" else []
    return ", ".join(whole + [limit for limit in limits if limit != f"<= {1e12}"])


def value_of(scene: BaseModel, key: str) -> str:
    """Value of a dotted key, as the page writes it."""
    value: Any = scene
    for part in key.split("."):
        value = value.get(part, KindKeys()) if isinstance(value, dict) else getattr(value, part)
    return "none" if value is None else f"`{json.dumps(value)}`"


def test_keys_of_a_scene() -> None:
    table = {row[0].strip("`"): row[1:3] for row in rows(section("scene.md", "Keys"))}
    default = Scene.from_dict({})
    assert table == {
        key: [value_of(default, key), allowed(schema)] for key, schema in fields(Scene).items()
    }


def test_keys_of_a_kind_of_cells() -> None:
    table = {row[0].strip("`"): row[1:3] for row in rows(section("kinds.md", "Keys"))}
    plain = KindKeys()
    written = {"type": "string", "pattern": "#rrggbb"}
    assert table == {
        key: [
            value_of(plain, key),
            '`"#rrggbb"`' if written in schema["anyOf"] else allowed(schema),
        ]
        for key, schema in ((key, {"anyOf": [one], **one}) for key, one in fields(KindKeys).items())
    }


def test_keys_of_an_intervention() -> None:
    shapes = [f"within.{key}" for key in Region.model_fields]
    table = {row[0].strip("`"): row[1:] for row in rows(section("interventions.md", "Keys"))}
    assert sorted(table) == sorted([*Intervention.model_fields, *shapes])
    for key, others in NEEDS.items():
        assert codes(table[key][0]) == list(others), key
    assert codes(table["name"][1])[-len(RESERVED) :] == list(RESERVED)
    settable = [codes(row[0]) for row in rows(section("interventions.md", "What can be set"))]
    assert [key for keys in settable[:-1] for key in keys] == list(SETTABLE)
    assert settable[-1] == list(SETTABLE_OF_KINDS)


def test_rows_of_the_kinds_of_cells() -> None:
    def words(row: CellKind) -> list[str]:
        generations = "`cells.generations`" if row.generations == 10 else "-"
        return [
            f"`{row.label}`", str(int(row.kind)), f"`{row.adhesion}`",
            "yes" if row.detaches else "no", f"`{row.daughter}`" if row.daughter else "-",
            "endless" if row.daughter and row.generations is None else generations,
            f"`{row.after_last}`" if row.after_last else "-",
        ]  # fmt: skip

    kinds = Scene.from_dict({}).cell_table.values()
    assert rows(section("kinds.md", "The four rows")) == [words(row) for row in kinds]


def test_folds_of_each_parameter_set() -> None:
    table = rows(section("stability.md", "Before a run"))
    assert {name.strip("`"): float(value) for name, value in table} == FOLDS
    assert list(FOLDS) == list(parameters.SETS)


def test_levels_of_accuracy() -> None:
    scenes = [Scene.from_dict({"numerics": {"accuracy": level}}) for level in LEVELS]
    table = rows(section("scene.md", "Accuracy"))
    assert {row[0] for row in table} == {key for level in LEVELS.values() for key in level}
    for key, *values in table:
        assert values == [value_of(scene, f"numerics.{key}") for scene in scenes], key


def test_parameter_sets() -> None:
    markdown = section("scene.md", "Parameter sets")
    names = re.findall(r"`([\w-]+)`", markdown.split("| --- |")[0].splitlines()[-1])
    assert names == list(parameters.SETS)
    scenes = [Scene.from_dict({"parameters": name}) for name in names]
    of_kinds = [f"cells.kinds.{row}.{key}" for row in ROWS for key in fields(KindKeys)]
    differing = [
        key for key in [*fields(Scene), *of_kinds]
        if key != "parameters" and len({value_of(scene, key) for scene in scenes}) > 1
    ]  # fmt: skip
    table = {row[0].strip("`"): row[1:] for row in rows(markdown)}
    assert table == {key: [value_of(scene, key) for scene in scenes] for key in differing}

    x = np.linspace(1.0, 2.0, 10_001)
    pulls = [
        Terms.of(scene).adhesion / scene.contact
        * potentials.adhesion_slope(x, scene.cells.adhesion_range).max()
        for scene in scenes
    ]  # fmt: skip
    said = re.search(r"particle is ([\d., and]+), in this", markdown.replace("\n", " "))
    assert said
    assert re.findall(r"[\d.]+\d", said[1]) == [f"{pull:.2f}" for pull in pulls]


def test_built_in_scenes() -> None:
    table = rows(section("scene.md", "Built-in scenes"))
    scenes = [(name, Scene.load(name)) for name in BUILT_IN]
    assert table == [
        [
            f"`{name}`", "{} x {}".format(*scene.membrane.lattice), str(scene.cells.stem),
            str(scene.cells.nd), f"`{scene.cells.arrangement}`", f"{scene.end_time:g}",
        ]
        for name, scene in scenes
    ]  # fmt: skip
    prose = " ".join(section("scene.md", "Built-in scenes").split())
    for name in ("paper-ring", "quarter-ring"):
        scene = Scene.load(name)
        lx, ly, _ = scene.box_sides
        assert f"{lx:g} x {ly:.3f}" in prose
        assert f"{dermal_count(scene):,}" in prose
    prose = " ".join(section("scene.md", "The initial state").split())
    assert f"force component is below {FORCE_TOLERANCE:g} " in prose
