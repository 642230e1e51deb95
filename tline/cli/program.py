"""The command `tline` as a program of its own: it loads no plugins, and ends without taking apart what it has made."""

import atexit
import os
import sys
from threading import active_count


def program() -> None:
    """Run `tline`, and exit.

    Once all is written the system takes back memory at once; emptying every module and looking for garbage before would
    take a tenth of the time of a small scene. Where threads are left, Python waits for them as usual.
    """
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # else pydantic reads what all packages say of theirs
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
