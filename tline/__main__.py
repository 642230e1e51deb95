"""Run ``tline`` as ``python -m tline``."""

from tline.cli.main import program

program()
