"""Run ``tline`` as ``python -m tline``."""

from tline.cli.program import program

program()
