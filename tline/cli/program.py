"""Command `tline` as a program: it loads no plugins, and exits without destroying its objects."""

import atexit
import os
import sys
from threading import active_count


def program() -> None:
    """Run `tline`, and exit.

    When all is written the system frees memory at once; clearing every module and collecting garbage before would
    take a tenth of the time of a small scene. While threads are alive, Python waits for them as usual.
    """
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # else pydantic reads the metadata of all packages
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # threads wait for each other longer than small matrices take
    from tline.cli.main import main

    try:
        main()
    except SystemExit as end:
        if not isinstance(end.code, int) or active_count() > 1:
            raise
        code = end.code
    else:
        return
    atexit._run_exitfuncs()
    try:
        sys.stdout.flush()
        sys.stderr.flush()
    finally:
        os._exit(code)
