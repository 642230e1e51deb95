"""What links share: they stand between two nodes without a delay of their own."""

from typing import Annotated, ClassVar

from pydantic import BeforeValidator, Field, model_validator

from tline.errors import InputError
from tline.scene.element import Element, Name
from tline.scene.line import two_nodes
from tline.words.wording import shown


class Between(Element):
    """An element between two different nodes; flow counts positive from the first to the second."""

    section: ClassVar[str] = "links"
    nodes: Annotated[tuple[Name, Name], BeforeValidator(two_nodes)] = Field(description="first node, second node")

    @property
    def terminals(self) -> tuple[str, str]:
        """Its nodes."""
        return self.nodes

    @model_validator(mode="after")
    def _apart(self):
        if self.nodes[0] == self.nodes[1]:
            raise InputError("nodes", "both ends are at one node", "two different nodes", shown(self.nodes[0]))
        return self
