"""The console script.

It imports next to nothing before `main`: loading the commands takes a second, and Ctrl-C then is no traceback either.
"""

import sys
from _thread import allocate_lock, interrupt_main, start_new_thread
from contextlib import suppress
from time import sleep
from types import FrameType

MOMENT = 0.05  # s
IMPORTS = "<frozen importlib"  # how the names of the files begin whose code imports
REPEATING = allocate_lock()  # held while an interruption waits for its repetition: several become one


def main() -> None:
    """Run the command of this process's arguments, and exit with its status."""
    usual, sys.unraisablehook = sys.unraisablehook, _interrupt_again
    try:
        status = _run_command()
    except KeyboardInterrupt:
        sys.stderr.write("motionsync: interrupted\n")
        status = 130
    finally:
        sys.unraisablehook = usual
    sys.exit(status)


def _run_command() -> int:
    """Run the command, and return its status.

    Raises:
        KeyboardInterrupt: the user interrupted it, and nothing is reported yet.
    """
    import signal  # noqa: PLC0415 (see above)

    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # a shell may have switched it off
        with suppress(ValueError):  # not in the main thread, which gets all signals
            signal.signal(signal.SIGINT, _interrupt)
    try:
        from .commands.app import run_command  # noqa: PLC0415 (see above)

        return run_command()
    finally:
        if signal.getsignal(signal.SIGINT) is _interrupt:
            signal.signal(signal.SIGINT, signal.default_int_handler)


def _interrupt(_number: int, frame: FrameType | None) -> None:
    """Raise KeyboardInterrupt, in an import as soon as that has ended: libraries in C that are interrupted while they
    are loaded drop it, or make another error of it.

    Raises:
        KeyboardInterrupt: no import is at work.
    """
    while frame:
        if frame.f_code.co_filename.startswith(IMPORTS):
            _repeat()
            return
        frame = frame.f_back
    raise KeyboardInterrupt


def _interrupt_again(unraisable: "sys.UnraisableHookArgs") -> None:
    """Repeat a Ctrl-C that came in a callback of the interpreter, an import's, say: Python prints it and drops it."""
    if unraisable.exc_type is KeyboardInterrupt:
        _repeat()
    else:
        sys.__unraisablehook__(unraisable)


def _repeat() -> None:
    """Interrupt once more in a moment, however often that is asked for meanwhile."""
    if REPEATING.acquire(blocking=False):
        start_new_thread(_interrupt_soon, ())


def _interrupt_soon() -> None:
    sleep(MOMENT)  # here an interruption would be dropped again
    REPEATING.release()
    interrupt_main()


if __name__ == "__main__":
    main()
