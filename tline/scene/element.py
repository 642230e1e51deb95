"""What all elements of a scene share: unknown keys are refused, numbers carry units, nothing changes afterwards."""

from typing import Any

from pydantic import BaseModel, ConfigDict


class Element(BaseModel):
    """A table of a scene file."""

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        populate_by_name=True,
        revalidate_instances="always",
        validate_default=True,
    )

    def model_post_init(self, context: Any) -> None:
        """Count the word that tells kinds apart as given, so that it is always written to a file."""
        self.model_fields_set.update(type(self).model_fields.keys() & {"kind", "shape"})

    def table(self) -> dict[str, Any]:
        """The element as it stands in a scene file: what was given, as it was typed."""
        return self.model_dump(by_alias=True, exclude_unset=True)


class AtNode(Element):
    """An element between a node and the reference (earth, or zero pressure)."""

    at: str
