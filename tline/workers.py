"""Worker processes of this one, which ignore Ctrl-C from their start, although a terminal sends it to all."""

import signal
from collections.abc import Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from threading import current_thread, main_thread
from typing import Any


class Workers(ProcessPoolExecutor):
    """Pool of worker processes, each started when there is work for it."""

    def __init__(self, count: int):
        super().__init__(count, get_context("spawn"), _ignore_interrupts)

    def submit(self, *task: Any, **named: Any) -> "Future[Any]":
        """Submit a task to a process; processes started by this inherit that interrupts are blocked."""
        with interrupts_deferred():
            return super().submit(*task, **named)

    def end(self) -> None:
        """End all processes at once, and the thread that listens to them.

        If the thread continued, it might close its pipe while Python, about to end, writes into that.
        """
        with interrupts_deferred():
            processes = list((self._processes or {}).values())
            results: Any = self._result_queue
            listener: Any = self._executor_manager_thread
            self.shutdown(wait=False, cancel_futures=True)
            for process in processes:
                process.terminate()
            if results is not None:
                results._writer.close()  # else the thread waits for the rest of what a process had half written
            if listener is not None:
                listener.join()


@contextmanager
def interrupts_deferred() -> Iterator[None]:
    """Defer Ctrl-C until the block ends, and block it in processes started meanwhile."""
    caught: list[int] = []
    handler = signal.getsignal(signal.SIGINT)
    ours = handler is not None and current_thread() is main_thread()  # no other thread is interrupted
    if ours:
        signal.signal(signal.SIGINT, lambda number, _: caught.append(number))
    block = getattr(signal, "pthread_sigmask", None)  # not on Windows
    mask = block(signal.SIG_BLOCK, [signal.SIGINT]) if block else set()
    try:
        yield
    finally:
        if block:
            block(signal.SIG_SETMASK, mask)
        if ours:
            signal.signal(signal.SIGINT, handler)
        if caught:
            signal.raise_signal(signal.SIGINT)


def _ignore_interrupts() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
