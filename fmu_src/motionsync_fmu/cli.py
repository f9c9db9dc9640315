"""The console script.

It imports next to nothing before `main`: loading the commands takes a second, and Ctrl-C then is no traceback either.
"""

import sys


def main() -> None:
    """Run the command of this process's arguments, and exit with its status."""
    try:
        from .commands.app import run_command  # noqa: PLC0415 (see above)

        status = run_command()
    except KeyboardInterrupt:
        sys.stderr.write("motionsync: interrupted\n")
        status = 130
    sys.exit(status)


if __name__ == "__main__":
    main()
