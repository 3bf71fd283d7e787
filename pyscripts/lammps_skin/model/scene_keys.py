"""Nested keys of a scene: merged, as TOML, and what is wrong with them in plain words."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path
from types import UnionType
from typing import Any, get_args, get_origin

from pydantic import BaseModel, ValidationError

PATHS = (("start", "from"), ("membrane", "heights"))  # keys of a scene that name files


def merged(base: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    """Nested dictionaries merged, `over` winning; both are left as they are."""
    both: dict[str, Any] = {
        key: merged({}, value) if isinstance(value, Mapping) else value
        for key, value in base.items()
    }
    for key, value in over.items():
        if isinstance(value, Mapping):
            below = both.get(key)
            both[key] = merged(below if isinstance(below, Mapping) else {}, value)
        else:
            both[key] = value
    return both


def value_of(model: BaseModel, key: str) -> Any:
    """Value of a dotted key."""
    found: Any = model
    for part in key.split("."):
        found = getattr(found, part)
    return found


def entry(place: Any, part: str) -> Any:
    """What a key leads to, in an array of tables the one of that name; an empty table if new."""
    if isinstance(place, dict):
        return place.setdefault(part, {})
    tables = (table for table in place if isinstance(table, dict))
    return next((table for table in tables if table.get("name") == part), None)


def no_entry(place: Any, part: str) -> str | None:
    """What to say if an array of tables has none of that name; None of what is no array."""
    if not isinstance(place, list):
        return None
    names = [str(table["name"]) for table in place if isinstance(table, dict) and "name" in table]
    there = f"there are {', '.join(names)}" if names else "there are none"
    return f"no intervention has the name {part}; {there}{near(part, names)}"


def to_toml(given: dict[str, Any], prefix: str = "") -> str:
    """Nested keys as TOML; tables in an array of tables are inline."""
    tables = {key: value for key, value in given.items() if isinstance(value, dict)}
    arrays = {key: value for key, value in given.items() if _holds_tables(value)}
    lines = [
        f"{key} = {_toml_value(value)}"
        for key, value in given.items()
        if key not in tables and key not in arrays
    ]
    for key, value in tables.items():
        lines += ["", f"[{prefix}{key}]", to_toml(value, f"{prefix}{key}.").rstrip("\n")]
    for key, value in arrays.items():
        for table in value:
            rows = (f"{inner} = {_toml_value(item)}" for inner, item in table.items())
            lines += ["", f"[[{prefix}{key}]]", *rows]
    return "\n".join(lines).lstrip("\n") + "\n"


def _holds_tables(value: Any) -> bool:
    is_array = isinstance(value, (list, tuple))
    return is_array and len(value) > 0 and all(isinstance(item, dict) for item in value)


def _toml_value(value: Any) -> str:
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_toml_value(item) for item in value) + "]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {_toml_value(one)}" for key, one in value.items()) + "}"
    if isinstance(value, float):
        return repr(value)
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def with_absolute_paths(given: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """The same keys; paths are absolute, those that were not have been relative to a folder."""
    keys = merged({}, given)
    for part, key in PATHS:
        table = keys.get(part)
        if isinstance(table, dict) and isinstance(table.get(key), str) and table[key]:
            table[key] = os.path.abspath(folder / table[key])
    return keys


def as_tuples(given: Mapping[str, Any]) -> dict[str, Any]:
    """TOML has arrays where the scene has tuples."""
    return {key: _as_tuple(value) for key, value in given.items()}


def _as_tuple(value: Any) -> Any:
    if isinstance(value, Mapping):
        return as_tuples(value)
    return tuple(map(_as_tuple, value)) if isinstance(value, list) else value


def first_line(model: type[BaseModel], error: ValidationError, validated: Any = None) -> str:
    """First problem of a validation as `key = value: what is allowed`.

    Parameters
    ----------
    model : type
    error : ValidationError
    validated : mapping, optional
        The keys, of which entries of arrays of tables are told by their `name`.
    """
    problem = error.errors(include_url=False)[0]
    parts = list(_named(problem["loc"], validated))
    given = f"{dotted(parts)} = {shown(problem['input'])}"
    if problem["type"] == "value_error":
        return str(problem["msg"]).removeprefix("Value error, ")
    if problem["type"] == "missing" and isinstance(problem["loc"][-1], str):
        return f"{dotted(parts[:-1])}: needs the key `{parts[-1]}`"
    if problem["type"] == "extra_forbidden":
        beside = list(_part(model, parts[:-1]).model_fields)
        in_array = any(isinstance(part, int) for part in problem["loc"])
        return f"{given}: unknown key; allowed: {', '.join(beside)}" + _near_key(
            parts[-1], beside, () if in_array else keys_of(model)
        )
    what = _EXPECTED.get(problem["type"]) or str(problem["msg"]).replace("Input should", "must")
    guess = ""
    if problem["type"] == "tuple_type" and _is_model(_below(_annotation(model, parts))):
        what = "must be an array of tables of keys"
    value = problem["input"]
    if problem["type"] == "float_type" and isinstance(value, str) and _QUANTITY.fullmatch(value):
        what = "must be a number, in the reduced units of the model"
    if problem["type"] == "literal_error":
        annotation = _annotation(model, parts)
        inner = [get_args(one) for one in get_args(annotation)]  # of a key without a default
        guess = near(problem["input"], next(filter(None, inner), get_args(annotation)))
    return f"{given}: {what}{guess}"


def _named(loc: Iterable[int | str], validated: Any) -> Iterator[str]:
    """Keys of a place in what was validated, with names for the numbers of tables in arrays."""
    for part in loc:
        try:
            validated = validated[part]
        except (LookupError, TypeError):
            validated = None
        if isinstance(part, str):
            yield part
        elif isinstance(validated, Mapping):
            name = validated.get("name")
            yield name if isinstance(name, str) else str(part + 1)


def _near_key(word: str, beside: Sequence[str], elsewhere: Iterable[str]) -> str:
    """As `near`: a key of the same table, else one of others."""
    names = {key.rpartition(".")[2]: key for key in elsewhere}
    if (meant := _SYNONYMS.get(word)) in beside:
        return f"; did you mean {meant}?"
    return near(word, beside) or near(word, names, names)


def near(word: Any, allowed: Iterable[str], names: Mapping[str, str] | None = None) -> str:
    """The end of an error that offers the word that may have been meant; nothing without one.

    Parameters
    ----------
    word : what was given
    allowed : words that there are
    names : mapping, optional
        What to call them.
    """
    text = word[:100].lower() if isinstance(word, str) else ""
    found = get_close_matches(text, list(allowed), n=1)
    return f"; did you mean {(names or {}).get(found[0], found[0])}?" if found else ""


def dotted(parts: Iterable[str]) -> str:
    """Nested keys with dots between them, in quotes what is empty or has a dot of its own."""
    return ".".join(json.dumps(part) if "." in part or not part else part for part in parts)


_SYNONYMS = {
    "time": "at", "when": "at", "start": "at", "end": "until", "interval": "every",
    "kill": "remove", "delete": "remove", "kinds": "remove", "region": "within", "where": "within",
    "positions": "places", "disk": "cylinder", "disc": "cylinder", "circle": "cylinder",
    "plane": "half_space",
}  # fmt: skip
_QUANTITY = re.compile(r"\s*[-+]?\d[\d.eE+-]*\s*[^\W\d].*", re.DOTALL)  # a number and a unit

# in the words of TOML instead of Python's
_EXPECTED = {
    "missing": "must be an array of two values",
    "too_long": "must be an array of two values",
    "tuple_type": "must be an array of two values",
    "model_type": "must be a table of keys",
    "dict_type": "must be a table of kinds, each a table of keys",
    "string_pattern_mismatch": "must be up to 64 letters, digits, '.', '_', '-', not '.' at first",
}


def shown(value: Any) -> str:
    """A value in an error: as Python writes it, shortened."""
    try:
        text = repr(list(value) if isinstance(value, tuple) else value)
    except ValueError:  # Python does not write whole numbers of more than 4300 digits
        return "a number of very many digits"
    return text if len(text) <= 60 else f"{text[:57]}..."


def _part(model: type[BaseModel], parts: Iterable[str]) -> type[BaseModel]:
    """The part of a model that is reached by keys."""
    part = _annotation(model, parts)
    assert _is_model(part)
    found: type[BaseModel] = part
    return found


def _annotation(model: type[BaseModel], parts: Iterable[str]) -> Any:
    """The annotation of what is reached by keys; of an optional part that of the part."""
    annotation: Any = model
    for key in parts:
        below = _below(annotation)
        annotation = below if _is_model(below) else annotation.model_fields[key].annotation
        if get_origin(annotation) is UnionType:
            annotation = next(filter(_is_model, get_args(annotation)), annotation)
    return annotation


def _is_model(annotation: Any) -> bool:
    return isinstance(annotation, type) and issubclass(annotation, BaseModel)


def _below(annotation: Any) -> Any:
    """The model of each entry of a table whose names are free, or of an array; None of others."""
    places: dict[Any, int] = {dict: 1, tuple: 0}
    place = places.get(get_origin(annotation))
    return None if place is None else get_args(annotation)[place]


def keys_of(model: type[BaseModel], prefix: str = "") -> Iterator[str]:
    """All dotted keys of a model, those of the top last."""
    for key, field in model.model_fields.items():
        below = _below(field.annotation)
        part: Any = below or field.annotation
        if _is_model(part):
            yield from keys_of(part, f"{prefix}{key}." + ("NAME." if below else ""))
    for key in model.model_fields:
        yield f"{prefix}{key}"
