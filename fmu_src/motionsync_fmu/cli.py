"""The console script.

It imports next to nothing before `main`: loading the commands takes a second, and Ctrl-C then is no traceback either.
"""

import sys
from _thread import interrupt_main, start_new_thread
from time import sleep

MOMENT = 0.05  # s


def main() -> None:
    """Run the command of this process's arguments, and exit with its status."""
    usual, sys.unraisablehook = sys.unraisablehook, _interrupt_again
    try:
        from .commands.app import run_command  # noqa: PLC0415 (see above)

        status = run_command()
    except KeyboardInterrupt:
        sys.stderr.write("motionsync: interrupted\n")
        status = 130
    finally:
        sys.unraisablehook = usual
    sys.exit(status)


def _interrupt_again(unraisable: "sys.UnraisableHookArgs") -> None:
    """Repeat a Ctrl-C that came in a callback of the interpreter, an import's, say: Python prints it and drops it."""
    if unraisable.exc_type is KeyboardInterrupt:
        start_new_thread(_interrupt_soon, ())
    else:
        sys.__unraisablehook__(unraisable)


def _interrupt_soon() -> None:
    sleep(MOMENT)  # here an interruption would be dropped again
    interrupt_main()


if __name__ == "__main__":
    main()
