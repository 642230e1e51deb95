"""Run ``tline`` as ``python -m tline``."""

from tline.cli.terminal import program

program()
