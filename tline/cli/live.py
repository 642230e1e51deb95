"""`tline live`: a scene as a page with sliders."""

import click

from tline.cli.from_signature import command


@command(epilog="\b\nExamples:\n  tline live cable_rc\n  tline live valve.toml --no-browser\n")
def live(scene: str, *, no_browser: bool = False, confined: bool = False) -> None:
    """Open a page on this machine that runs SCENE, a file or a name of `tline examples`, as its numbers are moved.

    It shows network, traces, extremes, and for a chain the effort over place and time, and gives the scene out as TOML
    and as Python. Only this machine can open it, by the address that is printed, until Ctrl-C, or
    until nobody has used it for an hour.

    Parameters
    ----------
    no_browser
        Print the address alone.
    """
    import webbrowser

    import tline as tl
    from tline.live.desk import Desk
    from tline.live.server import Server

    if scene in tl.examples:
        desk = Desk(tl.examples[scene], f'tl.examples["{scene}"]')
    else:
        desk = Desk(tl.read(scene, confined=confined), f"tl.read({scene!r})")
    with Server(desk) as server:
        click.echo(f"{server.address}  (Ctrl-C ends it)")
        if not no_browser:
            webbrowser.open(server.address)
        server.serve()
