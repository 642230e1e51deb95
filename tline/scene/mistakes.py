"""What the validator found wrong, as sentences that name the element and the nearest valid word."""

from collections.abc import Mapping
from difflib import get_close_matches
from typing import Any

from pydantic import BaseModel, ValidationError

from tline.errors import InputError


def mistakes(error: ValidationError, models: Mapping[str, type[BaseModel]]) -> list[InputError]:
    """One InputError per finding.

    Parameters
    ----------
    error : ValidationError
        All findings of one validation.
    models : mapping
        The model behind each section and behind each word that tells kinds apart; "" is the scene itself. Such words
        stand in the validator's locations and are left out of the sentence.
    """
    return [_sentence(finding, models) for finding in error.errors()]


def _sentence(finding: Any, models: Mapping[str, type[BaseModel]]) -> InputError:
    location = [str(part) for part in finding["loc"]]
    tags = [k for k, part in enumerate(location) if part in models and k >= 2]
    where = ".".join(part for k, part in enumerate(location) if k not in tags)
    got, context = repr(finding["input"]), finding.get("ctx", {})
    match finding["type"]:
        case "missing":
            return InputError(where, "is missing")
        case "extra_forbidden":
            owner = location[tags[-1]] if tags else location[0] if len(location) > 1 else ""
            return InputError(where, "unknown key", nearest(location[-1], keys(models[owner])))
        case "union_tag_not_found":
            return InputError(f"{where}.{context['discriminator'].strip(chr(39))}", "is missing")
        case "union_tag_invalid":
            word, known = context["tag"], [tag.strip("' ") for tag in context["expected_tags"].split(",")]
            return InputError(
                f"{where}.{context['discriminator'].strip(chr(39))}",
                "unknown",
                nearest(word, known),
                f"'{word}'",
            )
        case "literal_error":
            return InputError(where, "unknown", context["expected"], got)
        case "value_error" if isinstance(context.get("error"), InputError):
            inner = context["error"]
            return InputError(
                ".".join(part for part in (where, inner.where) if part),
                inner.problem,
                inner.expected,
                inner.got,
            )
        case "value_error":
            return InputError(where, str(context["error"]))
        case _:
            return InputError(
                where,
                finding["msg"][0].lower() + finding["msg"][1:],
                got=got if len(got) < 60 else got[:50] + "…",
            )


def keys(model: type[BaseModel]) -> list[str]:
    """The keys a table of this model may have."""
    return [field.alias or name for name, field in model.model_fields.items()]


def nearest(word: str, known: list[str]) -> str:
    """The known word a user probably meant; all of them if none is near."""
    close = get_close_matches(word, known, n=1)
    return f"'{close[0]}'" if close else "one of " + ", ".join(f"'{name}'" for name in known)
