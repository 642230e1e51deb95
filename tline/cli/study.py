"""`tline study`: many scenarios of a water network from one file, and what comes of them."""

import sys
from typing import Any

from tline.cli.from_signature import FileKind, Output, command
from tline.cli.options import check_readable

FILES = {
    "report": FileKind((".html",), "All in one page: tables, maps, profiles"),
    "csv": FileKind((".csv",), "A row for each scenario"),
}
EXAMPLES = """\b
Example:
  tline study scenes/town_study.toml --folder out/town --report out/town.html
"""


@command("tline.surge.study:surge_study", files=FILES, omit=("executor",), epilog=EXAMPLES)
def study(study: str, *, files: dict[str, str], **given: Any) -> Output:
    """Operate a water network in many ways, in variants of it, and compare what comes of them.

    STUDY is a TOML file with the network, what is operated (in turn for each pump, valve, pipe or node, if wanted) and
    variants, such as protections. The exit status is 1 if no class of pressure can be told for a scenario.
    """
    from tline.surge.study import surge_study

    check_readable(study)
    found = surge_study(study, progress=sys.stderr.isatty(), **given)
    return Output(
        str(found).splitlines(), found.to_dict, dict.fromkeys(FILES, found.save), (), 1 if found.unsigned else 0
    )
