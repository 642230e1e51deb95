"""`tline schema`: the JSON schema of scene files, with which editors complete and check them."""

import json

import click


@click.command(
    "schema",
    epilog="""\b
Examples:
  tline schema -o scene.schema.json
  tline schema | head
""",
)
@click.option("-o", "--output", metavar="FILE", help="Write to a file instead of printing.")
def schema(output: str | None) -> None:
    """Print the JSON schema of scene files.

    An editor with TOML support completes and checks scenes with it; the first line of the scene names it:
    `#:schema scene.schema.json`.
    """
    from tline.scene.file import schema as describe

    text = json.dumps(describe(), indent=2, ensure_ascii=False)
    if output is None:
        click.echo(text)
        return
    from tline.solver.result.atomic import replacing

    with replacing(output) as temporary:
        temporary.write_text(text + "\n", encoding="utf-8")
    click.echo(f"wrote {output}")
