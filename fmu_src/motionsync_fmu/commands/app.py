"""The command line as a whole: all commands, and how their errors are reported."""

import io
import re
import sys
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from ..about import __version__
from ..errors import Interrupted, UserError
from ..native.compiler_process import end_compilers

COMMANDS = {  # each with its line in the help; its module in this package has the same name, with _ for -
    "list": "List the blocks, and what can be run by name.",
    "build": "Build FMUs.",
    "describe": "Show variables, enumerations, fault codes.",
    "new": "Write a first scenario of your own.",
    "run": "Run scenarios, check them, write reports.",
    "explore": "Write a page to move a block by hand.",
    "line": "Run a production line of several FMUs.",
    "plan-line": "Show how fast a cutting line may run, and why.",
    "sweep": "Run a scenario with many values: a row per run.",
    "sweep-plot": "Write a page about a sweep's rows.",
    "search": "Find where in a range a run starts to succeed.",
    "error": "Explain a fault code.",
}


@dataclass(frozen=True)
class Conversion:
    """Makes a text, a path or a flag of an argument. In its place typer loads pydantic, which takes a third of the time
    of `motionsync list`."""

    kind: type[str] | type[Path] | type[bool]

    def coerce(self, value: Any, param: Any, ctx: Any) -> Any:
        """The value of an argument; None: it is not given."""
        return value if value is None else self.kind(value)


def _convert_by_itself(parameters: list[Any]) -> list[Any]:
    """Parameters of typer's, with a Conversion where one is enough. The attributes for it are private: where another
    version of typer has others, commands are only slower."""
    for parameter in parameters:
        kind = getattr(getattr(parameter, "type_descriptor", None), "annotation", None)
        if kind in (str, Path, bool):
            parameter._runtime_param = Conversion(kind)
    return parameters


class Command(TyperCommand):
    """A command that loads no more than it needs."""

    def get_params(self, ctx: Any) -> list[Any]:
        """Its parameters, with --help."""
        return _convert_by_itself(super().get_params(ctx))


class Commands(TyperGroup):
    """The commands, each of which is imported when it is used: the libraries of all of them take a second to load."""

    def __init__(self, **attributes: Any) -> None:
        super().__init__(**attributes)
        self.commands: Any = dict.fromkeys(COMMANDS)

    def get_params(self, ctx: Any) -> list[Any]:
        """The parameters before the command, with --help."""
        return _convert_by_itself(super().get_params(ctx))

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """The command of this name; None: there is none."""
        if cmd_name not in COMMANDS:
            return None
        module = import_module(f".{cmd_name.replace('-', '_')}", __package__)
        alone = typer.Typer(rich_markup_mode=None, add_completion=False)
        alone.command(cmd_name, cls=Command, short_help=COMMANDS[cmd_name])(module.command)
        return typer.main.get_command(alone)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the list of commands in the help, without importing any of them."""
        with formatter.section("Commands"):
            formatter.write_dl([*COMMANDS.items()])


app = typer.Typer(
    name="motionsync",
    cls=Commands,
    help="FMI co-simulation units of master/slave motion synchronisation.",
    epilog="""Start with:\n
    motionsync run CutToLength/cyclic_orders --open\n
    motionsync explore CutToLength --open\n
    motionsync list""",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


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
INTERRUPTED = 130  # the exit status after Ctrl-C, of typer and of shells
LONGEST_WORD, LONGEST_MESSAGE = 200, 6000  # characters of a message that are shown; a value may be a whole file


def run_command() -> int:
    """Run the command of this process's arguments, and return the exit status.

    A mistake of the user is reported in one line, with exit status 2.

    Raises:
        KeyboardInterrupt: the user interrupted it, and nothing is reported yet.
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a console without ± still prints the rest
    status = 2
    try:
        status = app(standalone_mode=False) or 0  # what a command gives to typer.Exit; else None
        if status == INTERRUPTED:  # typer's, in place of the exception
            raise KeyboardInterrupt
        return int(status)
    except USAGE as e:
        message = e.format_message().replace("Value error, ", "")  # if no argument was given, this text is the help
        if len(sys.argv) == 1:
            _report(message)
            return status
        if message.startswith("No such command"):
            message += f" There is {', '.join(COMMANDS)}."
    except UserError as e:
        message = str(e)
    except UnicodeEncodeError as e:  # the name of a folder or an argument that is not UTF-8
        name = next(m[0] for m in re.finditer(r'[^\s"<>]+', e.object) if m.start() <= e.start < m.end())
        message = f"{name!r} is no text in UTF-8: choose another name"
    except OSError as e:  # a folder that cannot be written, a full disk
        message = f"{e.filename}: {e.strerror}" if e.filename else f"a file cannot be written or read: {e}"
    except Interrupted as e:
        message, status = str(e), INTERRUPTED
    except typer.Abort:
        raise KeyboardInterrupt from None
    finally:
        end_compilers()
    line = " ".join(_shorten(word, LONGEST_WORD) for word in message.split())
    _report(f"motionsync: {_shorten(line, LONGEST_MESSAGE)}")
    return status


def _report(message: str) -> None:
    """Print a message to the user; only here is the console needed, whose library takes as long as the rest."""
    from ..pages.console import err

    err.print(message)


def _shorten(text: str, longest: int) -> str:
    """The text, of a long one its begin and its end."""
    return text if len(text) <= longest else f"{text[: longest // 2]} ... {text[-longest // 4 :]}"
