"""The WebAssembly component that `--wasm` adds, in wasmtime: the bits and messages of the native unit."""

from pathlib import Path
from typing import Any

import fmpy
import pytest
from lxml import etree
from wasmtime import Engine, Store
from wasmtime.component import Component, Linker

from motionsync_fmu.fmus.guid import compute_guid
from motionsync_fmu.interface.recipe import Fmi, Recipe
from motionsync_fmu.native.instance_sources import c_sources
from motionsync_fmu.native.wasm.component import component_files
from motionsync_fmu.scenario.run.fmu_instance import FmuInstance
from tests.support.blocks.random_runs import draw_accepted_run
from tests.support.hosts.native_host import saved

RESOURCE = "co-simulation-instance"
TYPES = {"Float64": "float64", "Int32": "int32", "Int64": "int64", "Boolean": "boolean"}
RECIPE = Recipe("Synchronizer")


class Unit:
    """One instance of a component's unit; the methods have the names of the draft's interface.

    Attributes:
        messages: what it has logged, each as status, category and text.
    """

    def __init__(self, component: bytes, token: str, **options: bool) -> None:
        engine = Engine()
        self.store = Store(engine)
        self.messages: list[tuple[str, str, str]] = []
        linker = Linker(engine)
        with linker.root() as root, root.add_instance("fmi:fmi3/callbacks@3.0.0") as callbacks:
            callbacks.add_func("log-message", self._log)
        code = Component(engine, component)
        linker.define_unknown_imports_as_traps(code)
        self.instance = linker.instantiate(self.store, code)
        self.interface = self.instance.get_export_index(self.store, "fmi:fmi3/co-simulation@3.0.0")
        chosen = {"visible": False, "logging": True, "events": False, "early": False} | options
        make = self._function(f"[static]{RESOURCE}.instantiate-co-simulation")
        self.handle = make(self.store, "unit", token, "", *chosen.values(), [])

    def _log(self, store: Any, name: str, status: Any, category: str, text: str) -> None:
        assert name == "unit"
        self.messages.append((str(status), category, text))

    def _function(self, name: str) -> Any:
        result = self.instance.get_func(self.store, self.instance.get_export_index(self.store, name, self.interface))
        assert result is not None, name
        return result

    def call(self, name: str, *arguments: Any) -> Any:
        function = self._function(f"[method]{RESOURCE}.{name}")
        answer = function(self.store, self.handle, *arguments)
        return answer


@pytest.fixture(scope="module")
def files() -> dict[str, bytes]:
    return component_files(RECIPE.name, c_sources(RECIPE.block(), compute_guid(RECIPE), fmi=Fmi.THREE))


@pytest.fixture(scope="module")
def component(files: dict[str, bytes]) -> bytes:
    return files["binaries/wasm32-wasip2/Synchronizer.wasm"]


def bits(unit: Unit, host: FmuInstance) -> tuple[dict[str, Any], dict[str, Any]]:
    """All values of the component, and those of the native unit."""
    result: dict[str, Any] = {}
    for kind, name in TYPES.items():
        group = [n for n, (_, k) in host.kinds.items() if k == kind]
        result |= zip(group, unit.call(f"get-{name}", host.references(group)), strict=True)
    return shown(result), shown(host.get())


def shown(values: dict[str, Any]) -> dict[str, Any]:
    return {name: v.hex() if isinstance(v, float) else int(v) for name, v in values.items()}


def test_a_run_gives_the_bits_of_the_native_unit(component: bytes, fmi3: Path) -> None:
    """All values and the whole state; the state comes back in another component."""
    run = draw_accepted_run("Synchronizer", 2.0**-7, 300)
    unit = Unit(component, compute_guid(RECIPE))
    with FmuInstance(fmi3) as host:

        def put(values: dict[str, Any]) -> None:
            host.set(values)
            for name, value in values.items():
                reference, kind = host.kinds[name]
                assert (
                    unit.call(f"set-{TYPES[kind]}", [reference], [bool(value) if kind == "Boolean" else value]) == "ok"
                )

        host.unit.enterInitializationMode()
        assert unit.call("enter-initialization-mode", None, 0.0, None) == "ok"
        put(run.start)
        host.unit.exitInitializationMode()
        assert unit.call("exit-initialization-mode") == "ok"
        for h, values in run.steps:
            put(values)
            host.step(h)
            reached = unit.call("do-step", host.time - h, h, True)
            assert getattr(reached, "last-successful-time") == host.time
            assert len(set(map(str, bits(unit, host)))) == 1
        assert unit.call("get-fmu-state") == saved(host)
        assert [message for *_, message in unit.messages] == host.messages
        other = Unit(component, compute_guid(RECIPE))
        assert other.call("set-fmu-state", saved(host)) == "ok"
        assert len(set(map(str, bits(other, host)))) == 1


def test_what_is_refused_has_its_status_and_message(component: bytes) -> None:
    unit = Unit(component, compute_guid(RECIPE))
    assert unit.call("do-step", 0.0, 0.1, True) == "error"
    assert unit.call("enter-initialization-mode", None, 0.0, None) == "ok"
    assert unit.call("exit-initialization-mode") == "ok"
    assert unit.call("do-step", 0.0, -0.1, True) == "discard"
    assert unit.call("get-float64", [10000]) == "error"
    assert unit.call("set-float64", [0], [1.0, 2.0]) == "error"
    assert unit.call("enter-event-mode") == "error"
    assert unit.call("get-string", [0]) == "error"
    assert unit.call("set-fmu-state", b"no state") == "error"
    assert unit.call("reset") == "ok"
    assert [line[:2] for line in unit.messages] == [
        ("discard", "logStatusDiscard") if i == 1 else ("error", "logStatusError") for i in range(7)
    ]
    assert unit.messages[1][2] == "step size = -0.1 is not allowed: it must be > 0 and <= 1e+06"
    assert Unit(component, "{other}").handle is None
    assert Unit(component, compute_guid(RECIPE), events=True).handle is None


def test_memory_is_used_again(component: bytes) -> None:
    """Restored states, which are copied on the way, would not fit four pages of memory one beside the other."""
    unit = Unit(component, compute_guid(RECIPE))
    unit.store.set_limits(memory_size=4 * 65536)
    state = unit.call("get-fmu-state")
    assert 400 * len(state) > 4 * 65536
    for _ in range(400):
        assert unit.call("set-fmu-state", state) == "ok"
    assert unit.call("get-fmu-state") == state


def test_the_manifest_follows_the_schema(files: dict[str, bytes]) -> None:
    schema = Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3LayeredStandardManifest.xsd"
    checker = etree.XMLSchema(etree.parse(str(schema)))
    root = etree.fromstring(files["extra/org.modelica.fmi-ls-wasm/manifest.xml"])
    space = "{http://fmi-standard.org/fmi-ls-manifest}"
    assert root.get(f"{space}fmi-ls-name") == "org.modelica.fmi-ls-wasm"
    assert checker.validate(root), checker.error_log
