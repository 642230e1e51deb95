"""`tline export`: a scene for another program."""

from tline.cli.from_signature import command
from tline.cli.options import print_or_write
from tline.errors import InputError

EXAMPLES = """\b
Examples:
  tline export cable.toml -o cable.cir
  tline export cable.toml --rise "1 ps" | head
"""


@command(epilog=EXAMPLES)
def export(scene: str, *, output: str | None = None, rise: str | None = None, confined: bool = False) -> None:
    """Turn an electrical scene into a SPICE netlist.

    Lines become T elements, sources V or I with their resistors, loads R, L and C, probes .save, all values exact. What
    a netlist cannot say is refused, and the element is named.

    Parameters
    ----------
    output : FILE.cir
        Write the netlist to a file instead of printing it.
    rise : TIME
        What a jump takes in the netlist, such as '1 ps': SPICE has no jumps.
    """
    from tline.interchange.any_file import read as read_any
    from tline.interchange.netlist_text import spice_text
    from tline.units import to_si

    if output is not None and not output.lower().endswith(".cir"):
        raise InputError("--output", "unknown kind of file", ".cir", f"'{output}'")
    seconds = None if rise is None else to_si(rise, "s", "--rise")
    if seconds is not None and not seconds > 0:
        raise InputError("--rise", "not above zero", "a time such as '1 ps'", rise or "")
    print_or_write(spice_text(read_any(scene, confined=confined), seconds), output)
