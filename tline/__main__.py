"""``python -m tline`` is ``tline``."""

from tline.cli.program import program

program()
