"""What is wrong with a scenario, said so that its author can mend it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, get_args

from pydantic import BaseModel
from pydantic_core import ErrorDetails

from datmo.errors import nearest
from scenarios.read import Source
from scenarios.spec import Scenario

Place = tuple[int | str, ...]

_TYPES = {
    "float_type": "a number",
    "float_parsing": "a number",
    "int_type": "a whole number",
    "int_parsing": "a whole number",
    "int_from_float": "a whole number",
    "string_type": "text",
    "bool_type": "true or false",
    "bool_parsing": "true or false",
    "tuple_type": "a list",
    "dict_type": "a mapping",
    "model_type": "a mapping",
    "model_attributes_type": "a mapping",
    "finite_number": "a finite number",
}


def sentences(errors: Sequence[ErrorDetails], chain: Sequence[Source]) -> list[str]:
    """One line a problem: file, key, value, rule and remedy.

    Args:
        errors: what pydantic found in the merged mapping.
        chain: the sources, the one that counts most first.
    """
    return [f"{_origin(e['loc'], chain)}: {_dotted(e['loc'])}{_sentence(e)}" for e in errors]


def _sentence(error: ErrorDetails) -> str:
    place, kind, value = error["loc"], error["type"], error["input"]
    ctx = error.get("ctx", {})
    meaning = _description(place)
    if kind == "extra_forbidden":
        known = _fields(place[:-1])
        return f" = {_short(value)}: there is no such key; {nearest(str(place[-1]), known)}"
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        name = str(ctx["discriminator"]).strip("'")
        known = [part.strip(" '") for part in str(ctx.get("expected_tags", "")).split(",") if part]
        if not known:
            return f".{name} is missing; add it"
        rule = f"it must be one of {', '.join(known)}"
        return f".{name} = {_short(ctx['tag'])}: {rule}; {nearest(ctx['tag'], known)}"
    if kind == "missing":
        return f" is missing{meaning}; add it"
    if kind == "literal_error":
        choices = [str(c) for c in get_args(_annotation(place))] or [str(ctx.get("expected"))]
        hint = nearest(str(value), choices)
        remedy = hint if hint.startswith("did") else "choose one of them"
        return f" = {_short(value)}: it must be one of {', '.join(choices)}; {remedy}"
    if kind in _TYPES:
        bare = "; write the number alone, without a unit" if "number" in _TYPES[kind] else "; write it so"
        return f" = {_short(value)}: it must be {_TYPES[kind]}{meaning}{bare}"
    if kind == "value_error":
        return f": {ctx.get('error', error['msg'])}"
    rule = error["msg"].replace("Input should", "it must").replace("String should", "it must")
    return f" = {_short(value)}: {rule}{meaning}; change it"


def _origin(place: Place, chain: Sequence[Source]) -> str:
    """The source that says what stands at `place`, or, where none does, the first."""
    for length in range(len(place), 0, -1):
        for source in chain:
            if _says(source.says, place[:length]):
                return source.where
    return chain[0].where


def _says(value: Any, place: Place) -> bool:
    for key in place:
        in_list = isinstance(value, list) and isinstance(key, int) and key < len(value)
        if not in_list and not (isinstance(value, dict) and key in value):
            return False
        value = value[key]
    return True


def _annotation(place: Place) -> Any:
    """The type annotation at `place` of a scenario, or None."""
    kind: Any = Scenario
    for key in place:
        model = _model(kind)
        if isinstance(key, str) and model is not None and key in model.model_fields:
            kind = model.model_fields[key].annotation
        elif isinstance(key, str) and _tagged(kind, key) is not None:
            kind = _tagged(kind, key)
        elif get_args(kind):
            kind = get_args(kind)[-1] if isinstance(key, str) else get_args(kind)[0]
        else:
            return None
    return kind


def _tagged(kind: Any, tag: str) -> type[BaseModel] | None:
    """The model of a union, told apart by their `kind`, that a tag names."""
    for member in get_args(kind):
        model = _model(member)
        if model is None:
            found = _tagged(member, tag)
            if found is not None:
                return found
        elif "kind" in model.model_fields and tag in get_args(model.model_fields["kind"].annotation):
            return model
    return None


def _model(kind: Any) -> type[BaseModel] | None:
    return kind if isinstance(kind, type) and issubclass(kind, BaseModel) else None


def _fields(place: Place) -> list[str]:
    model = _model(_annotation(place))
    return list(model.model_fields) if model else []


def _description(place: Place) -> str:
    model = _model(_annotation(place[:-1])) if place else None
    field = model.model_fields.get(str(place[-1])) if model else None
    return f" ({field.description})" if field and field.description else ""


def _dotted(place: Place) -> str:
    return ".".join(str(key) for key in place) or "the scenario"


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
