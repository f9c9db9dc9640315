"""FMPy's check of an FMU."""

from functools import cache
from pathlib import Path
from unittest.mock import patch

from fmpy.validation import validate_fmu
from lark import Lark


class Parser:
    """Lark's parser, which parses a text once in a process: FMPy parses the name of each variable, which takes most of
    its time, and the FMUs of a block have the same names."""

    def __init__(self, grammar: str, start: str) -> None:
        self.grammar, self.start = grammar, start

    def parse(self, text: str) -> object:
        return _parse(self.grammar, self.start, text)


@cache
def _parse(grammar: str, start: str, text: str) -> object:
    return _parser(grammar, start).parse(text)


@cache
def _parser(grammar: str, start: str) -> Lark:
    return Lark(grammar, start=start)


def faults_by_fmpy(fmu: str | Path) -> list[str]:
    """What FMPy finds wrong with an FMU, or with the modelDescription.xml in a folder."""
    with patch("lark.Lark", Parser):
        result: list[str] = validate_fmu(str(fmu))
    return result
