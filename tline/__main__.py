"""``python -m tline`` is ``tline``."""

from tline.cli.main import main

main()
