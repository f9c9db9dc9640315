"""The command line; each command is a module of `commands`.

A command imports what it needs when it runs, since the libraries of all commands take a second to load.
"""

import io
import sys
from collections.abc import Callable
from typing import Annotated, Any

import typer

from . import __version__
from .commands.build import build
from .commands.describe import describe
from .commands.error import error
from .commands.explore import explore
from .commands.export_crosscheck import export_crosscheck
from .commands.line import line
from .commands.list import list_all
from .commands.new import new
from .commands.plan_line import plan_line
from .commands.run import run
from .commands.search import search
from .commands.sweep import sweep
from .commands.sweep_plot import sweep_plot
from .errors import Interrupted, UserError
from .pages.console import err

app = typer.Typer(
    name="motionsync",
    help="FMI co-simulation units of master/slave motion synchronisation.",
    epilog="""Start with:\n
    motionsync list\n
    motionsync build Synchronizer\n
    motionsync run Synchronizer\n
    motionsync line""",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
COMMANDS: dict[
    str, tuple[Callable[..., None], str]
] = {  # each with its line in the help, which typer would cut off at 45 characters
    "list": (list_all, "List the blocks, and what can be run by name."),
    "build": (build, "Build FMUs."),
    "describe": (describe, "Show variables, enumerations, fault codes."),
    "new": (new, "Write a first scenario of your own."),
    "run": (run, "Run scenarios, check them, write reports."),
    "explore": (explore, "Write a page to move a block by hand."),
    "line": (line, "Run a production line of several FMUs."),
    "plan-line": (plan_line, "Show how fast a cutting line may run, and why."),
    "sweep": (sweep, "Run a scenario with many values: a row per run."),
    "sweep-plot": (sweep_plot, "Write a page about a sweep's rows."),
    "search": (search, "Find where in a range a run starts to succeed."),
    "error": (error, "Explain a fault code."),
    "export-crosscheck": (export_crosscheck, "Write models for the FMI cross-check."),
}
for name, (command, help_line) in COMMANDS.items():
    app.command(name, short_help=help_line)(command)


def _print_version(requested: bool) -> None:
    if requested:
        print(f"motionsync {__version__}")
        raise typer.Exit


@app.callback()
def accept_global_options(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    """Accept the options that need no command."""


USAGE: Any = typer.BadParameter.__base__  # what typer raises at wrong usage; it has no public name


def main() -> None:
    """The console script. A mistake of the user is reported in one line, with exit status 2."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a console without ± still prints the rest
    try:
        sys.exit(app(standalone_mode=False))  # the status that a command gives to typer.Exit; else None, which is 0
    except USAGE as e:
        text = e.format_message().replace("Value error, ", "")  # if no argument was given, this text is the help
        if text.startswith("No such command"):
            text += f" There is {', '.join(COMMANDS)}."
        err.print(text if len(sys.argv) == 1 else f"motionsync: {' '.join(text.split())}")
        sys.exit(2)
    except UserError as e:
        err.print(f"motionsync: {' '.join(str(e).split())}")
        sys.exit(2)
    except OSError as e:  # a folder that cannot be written, a full disk
        err.print(f"motionsync: {e.filename}: {e.strerror}" if e.filename else f"motionsync: {e}")
        sys.exit(2)
    except Interrupted as e:
        err.print(f"motionsync: {e}")
        sys.exit(130)
    except (KeyboardInterrupt, typer.Abort):
        err.print("motionsync: interrupted")
        sys.exit(130)


if __name__ == "__main__":
    main()
