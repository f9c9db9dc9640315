"""The notebook of examples/ runs from top to bottom, and shows what its text says."""

import re
from itertools import pairwise
from typing import Any

import pytest

from tests import ROOT

FILE = ROOT / "examples" / "order_list_to_saw.ipynb"
LENGTHS = ("6000", "3000", "1500", "900")


def read_notebook() -> Any:
    import nbformat  # noqa: PLC0415 (a moment that other tests need not wait)

    return nbformat.read(FILE, 4)


@pytest.fixture(scope="module")
def executed(tmp_path_factory: pytest.TempPathFactory) -> list[Any]:
    """The code cells with their outputs."""
    from nbclient import NotebookClient  # noqa: PLC0415

    notebook = read_notebook()
    folder = {"metadata": {"path": str(tmp_path_factory.mktemp("notebook"))}}
    NotebookClient(notebook, timeout=300, kernel_name="python3", resources=folder).execute()
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def shown(cell: Any, kind: str = "text/plain") -> str:
    """What a cell prints or shows."""
    texts = [o.text if o.output_type == "stream" else str(o.data.get(kind, "")) for o in cell.outputs]
    return "".join(texts)


def test_no_output_is_stored() -> None:
    cells = [cell for cell in read_notebook().cells if cell.cell_type == "code"]
    assert [(cell.outputs, cell.execution_count) for cell in cells] == [([], None)] * len(cells)


def cell_with(executed: list[Any], text: str) -> Any:
    (cell,) = [cell for cell in executed if text in cell.source]
    return cell


def test_a_stronger_saw_is_faster_and_a_shorter_piece_slower(executed: list[Any]) -> None:
    """Three lines: a saw, and its greatest line velocity in m/min for each length."""
    lines = shown(cell_with(executed, "limits = {")).splitlines()
    assert [line[0] for line in lines] == ["A", "B", "C"]
    rows = [[float(re.search(rf"'{n} mm': '([\d.]+) m/min'", line)[1]) for n in LENGTHS] for line in lines]  # type: ignore[index]
    for row in rows:
        assert row == sorted(row, reverse=True)
    for weaker, stronger in pairwise(rows):
        assert all(a <= b for a, b in zip(weaker, stronger, strict=True))


def test_the_chosen_saw_is_the_cheapest_that_is_able_to(executed: list[Any]) -> None:
    text = shown(cell_with(executed, "chosen = min("))
    durations = {name: float(hours) for name, hours in re.findall(r"^saw (\w): ([\d.]+) h", text, re.M)}
    able = [name for name in "ABC" if durations[name] <= 8.0]  # the prices rise from A to C
    assert durations["A"] > 8.0
    assert f"saw {able[0]} is the cheapest" in text


def test_the_prediction_is_what_the_runs_found(executed: list[Any]) -> None:
    """The search is as exact as a thousandth, and both print a tenth of a m/min."""
    cell = cell_with(executed, "plan = plan_line(")
    predicted = {
        n: float(v) for n, v in re.findall(r"^(\d+) mm: cuts are lost above ([\d.]+) m/min", shown(cell), re.M)
    }
    (saw,) = re.findall(r"saw (\w) is the cheapest", shown(cell_with(executed, "chosen = min(")))
    (line,) = [line for line in shown(cell_with(executed, "limits = {")).splitlines() if line.startswith(saw)]
    searched = {n: float(v) for n, v in re.findall(r"'(\d+) mm': '([\d.]+) m/min'", line)}
    assert set(LENGTHS) == set(predicted)
    assert predicted == pytest.approx(searched, rel=1e-3, abs=0.1)
    assert "<iframe srcdoc=" in shown(cell, "text/html")


def test_the_result_of_the_run_is_the_moving_machine(executed: list[Any]) -> None:
    page = shown(cell_with(executed, "result = run("), "text/html")
    assert page.startswith("<iframe srcdoc=")
    assert "motionsync-machine" in page
    assert ": as expected" in page
    lengths = shown(executed[-1])
    assert lengths.startswith("[1500.0, 1500.0, 1500.0, 900.0")


def test_the_plot_has_a_curve_for_each_saw(executed: list[Any]) -> None:
    (output,) = cell_with(executed, "plt.plot").outputs
    assert "image/png" in output.data
