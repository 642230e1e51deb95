"""`tline examples`: the scenes that come with tline, listed or copied."""

import click

EXAMPLES = """\b
Examples:
  tline examples
  tline examples water_pipe && tline run water_pipe.toml --plot pressure.png
"""


@click.command("examples", epilog=EXAMPLES)
@click.argument("name", required=False)
@click.option("-o", "--output", metavar="FOLDER", default=".", help="Where to; if not given, into the working folder.")
@click.option("--json", "as_json", is_flag=True, help="Print titles, or what was written, as JSON.")
def examples(name: str | None, output: str, as_json: bool) -> None:
    """List the scenes that come with tline; with a NAME copy one, and the files it names, to start from."""
    import json

    from tline import shipped

    if name is None:
        told = shipped.examples.titles()
        click.echo(json.dumps(told, indent=2, ensure_ascii=False) if as_json else repr(shipped.examples))
        return
    written = [str(path) for path in shipped.examples.copy(name, output)]
    if as_json:
        click.echo(json.dumps(written))
        return
    for path in written:
        click.echo(f"wrote {path}")
    click.echo(f"now: tline run {written[0]}")
