"""`tline schema`: the JSON schema of scene files, with which editors complete and check them."""

import json

from tline.cli.from_signature import command
from tline.cli.options import print_or_write

EXAMPLES = """\b
Examples:
  tline schema -o scene.schema.json
  tline schema | head
"""


@command(epilog=EXAMPLES)
def schema(*, output: str | None = None) -> None:
    """Print the JSON schema of scene files.

    An editor with TOML support completes and checks scenes with it; the first line of the scene names it:
    `#:schema scene.schema.json`.

    Parameters
    ----------
    output : FILE
        Write to a file instead of printing.
    """
    from tline.scene.file import schema as describe

    print_or_write(json.dumps(describe(), indent=2, ensure_ascii=False) + "\n", output)
