"""Nested keys of a scene: merged, as TOML, and what is wrong with them in plain words."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator, Mapping
from difflib import get_close_matches
from pathlib import Path
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


def to_toml(given: dict[str, Any], prefix: str = "") -> str:
    """Nested keys as TOML."""
    lines = [f"{key} = {_toml_value(v)}" for key, v in given.items() if not isinstance(v, dict)]
    for key, value in given.items():
        if isinstance(value, dict):
            lines += ["", f"[{prefix}{key}]", to_toml(value, f"{prefix}{key}.").rstrip("\n")]
    return "\n".join(lines).lstrip("\n") + "\n"


def _toml_value(value: Any) -> str:
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_toml_value(item) for item in value) + "]"
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
    """TOML has arrays where the scene has pairs."""
    return {
        key: tuple(value)
        if isinstance(value, list)
        else as_tuples(value)
        if isinstance(value, Mapping)
        else value
        for key, value in given.items()
    }


def first_line(model: type[BaseModel], error: ValidationError) -> str:
    """First problem of a validation as `key = value: what is allowed`."""
    problem = error.errors(include_url=False)[0]
    parts = [part for part in problem["loc"] if isinstance(part, str)]
    given = f"{dotted(parts)} = {shown(problem['input'])}"
    if problem["type"] == "value_error":
        return str(problem["msg"]).removeprefix("Value error, ")
    if problem["type"] == "extra_forbidden":
        beside = list(_part(model, parts[:-1]).model_fields)
        everywhere = {key.rpartition(".")[2]: key for key in _keys(model)}
        guess = near(parts[-1], beside) or near(parts[-1], everywhere, everywhere)
        return f"{given}: unknown key; allowed: {', '.join(beside)}{guess}"
    what = _EXPECTED.get(problem["type"]) or str(problem["msg"]).replace("Input should", "must")
    guess = ""
    if problem["type"] == "literal_error":
        annotation = _part(model, parts[:-1]).model_fields[parts[-1]].annotation
        inner = [get_args(one) for one in get_args(annotation)]  # of a key without a default
        guess = near(problem["input"], next(filter(None, inner), get_args(annotation)))
    return f"{given}: {what}{guess}"


def near(word: Any, allowed: Iterable[str], names: Mapping[str, str] | None = None) -> str:
    """The end of an error that offers the word that may have been meant; nothing without one.

    Parameters
    ----------
    word : what was given
    allowed : words that there are
    names : mapping, optional
        What to call them.
    """
    found = get_close_matches(str(word)[:100].lower(), list(allowed), n=1)
    return f"; did you mean {(names or {}).get(found[0], found[0])}?" if found else ""


def dotted(parts: Iterable[str]) -> str:
    """Nested keys with dots between them, in quotes what is empty or has a dot of its own."""
    return ".".join(json.dumps(part) if "." in part or not part else part for part in parts)


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
    annotation: Any = model
    for key in parts:
        below = _below(annotation)
        annotation = below if isinstance(below, type) else annotation.model_fields[key].annotation
    assert isinstance(annotation, type) and issubclass(annotation, BaseModel)
    return annotation


def _below(annotation: Any) -> Any:
    """The model of each entry of a table whose names are free; None if it is no such table."""
    return get_args(annotation)[1] if get_origin(annotation) is dict else None


def _keys(model: type[BaseModel], prefix: str = "") -> Iterator[str]:
    """All dotted keys of a model, those of the top last."""
    for key, field in model.model_fields.items():
        below = _below(field.annotation)
        part: Any = below or field.annotation
        if isinstance(part, type) and issubclass(part, BaseModel):
            yield from _keys(part, f"{prefix}{key}." + ("NAME." if below else ""))
    for key in model.model_fields:
        yield f"{prefix}{key}"
