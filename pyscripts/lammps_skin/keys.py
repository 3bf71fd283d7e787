"""Nested keys of a scene: merging them, and the first problem of a validation in plain words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel, ValidationError


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
    key = ".".join(str(part) for part in problem["loc"] if isinstance(part, str))
    if problem["type"] == "value_error":
        return str(problem["msg"]).removeprefix("Value error, ")
    if problem["type"] == "extra_forbidden":
        allowed = _keys_beside(model, key)
        return f"{key} = {shown(problem['input'])}: unknown key; allowed: {allowed}"
    what = _EXPECTED.get(problem["type"]) or str(problem["msg"]).replace("Input should", "must")
    return f"{key} = {shown(problem['input'])}: {what}"


# in the words of TOML instead of Python's
_EXPECTED = {
    "missing": "must be an array of two values",
    "too_long": "must be an array of two values",
    "tuple_type": "must be an array of two values",
    "model_type": "must be a table of keys",
    "string_pattern_mismatch": "must be up to 64 letters, digits, '.', '_', '-', not '.' at first",
}


def shown(value: Any) -> str:
    """A value in an error: as Python writes it, shortened."""
    try:
        text = repr(list(value) if isinstance(value, tuple) else value)
    except ValueError:  # Python does not write whole numbers of more than 4300 digits
        return "a number of very many digits"
    return text if len(text) <= 60 else f"{text[:57]}..."


def _keys_beside(model: type[BaseModel], key: str) -> str:
    """The known keys of the part in which an unknown key stands."""
    for part in key.split(".")[:-1]:
        annotation = model.model_fields[part].annotation
        assert isinstance(annotation, type) and issubclass(annotation, BaseModel)
        model = annotation
    return ", ".join(model.model_fields)
