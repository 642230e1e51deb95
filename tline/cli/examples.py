"""`tline examples`: the scenes that come with tline, listed or copied."""

from tline.cli.from_signature import Output, command

EXAMPLES = """\b
Examples:
  tline examples
  tline examples water_pipe && tline run water_pipe.toml --plot pressure.png
"""


@command(epilog=EXAMPLES)
def examples(name: str | None = None, *, output: str = ".") -> Output:
    """List the scenes that come with tline; with a NAME copy one, and the files it names, to start from.

    Parameters
    ----------
    output : FOLDER
        Where to; if not given, into the working folder.
    as_json
        Print titles, or what was written, as JSON.
    """
    from tline import shipped

    if name is None:
        return Output([repr(shipped.examples)], shipped.examples.titles)
    written = [str(path) for path in shipped.examples.copy(name, output)]
    return Output([*(f"wrote {path}" for path in written), f"now: tline run {written[0]}"], lambda: written)
