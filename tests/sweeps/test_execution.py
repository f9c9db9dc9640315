"""Chunks on workers: all rows come, once, whatever happens to workers, folder and patience."""

import errno
import json
import os
import socket
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Thread

import psutil
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from motionsync_fmu import __version__
from motionsync_fmu.errors import Interrupted, UserError
from motionsync_fmu.sweeps import worker_pool
from motionsync_fmu.sweeps.execution import _chunk_size, execute
from motionsync_fmu.sweeps.part_files import LOCK, Parts
from tests.support.project.command_line import Command
from tests.sweeps.conftest import Computers, worker
from tests.sweeps.tiny import Tiny, squares

SLOW = Tiny(60, 10, pace=0.02)  # six chunks of 0.2 s


def table(folder: Path) -> pa.Table:
    """All rows, by the numbers of the runs."""
    return pa.concat_tables(map(pq.read_table, sorted(folder.glob("part-*.parquet"))))


def contents(folder: Path) -> dict[str, bytes]:
    return {file.name: file.read_bytes() for file in sorted(folder.iterdir()) if file.name != LOCK}


def assert_squares(folder: Path, plan: Tiny) -> None:
    """Every run has its row, which is computed here once more."""
    rows = table(folder)
    assert rows["run"].to_pylist() == list(range(plan.runs))
    assert rows["square"].to_pylist() == [plan.seed**2 * run**2 for run in range(plan.runs)]


def test_every_run_has_a_row_and_every_chunk_a_part(tmp_path: Path) -> None:
    reported: list[tuple[int, int]] = []
    plan = execute(
        Tiny(25, 10), tmp_path / "new" / "folder", squares, workers=1, progress=lambda *done: reported.append(done)
    )
    folder = tmp_path / "new" / "folder"
    assert plan.chunk == 10
    assert reported == [(0, 25), (10, 25), (20, 25), (25, 25)]
    assert list(contents(folder)) == [*(f"part-{i:06}.parquet" for i in range(3)), "plan.toml"]
    assert pq.read_metadata(folder / "part-000002.parquet").num_rows == 5
    assert_squares(folder, plan)


def test_only_what_is_missing_is_done(tmp_path: Path) -> None:
    execute(Tiny(25, 10), tmp_path, squares, workers=1)
    before = contents(tmp_path)
    (tmp_path / "part-000001.parquet").unlink()
    (tmp_path / "part-000001.parquet.0123.part").write_bytes(b"a worker was killed here")
    reported: list[tuple[int, int]] = []
    execute(Tiny(25), tmp_path, squares, workers=1, progress=lambda *done: reported.append(done))
    assert reported == [(15, 25), (25, 25)]
    assert contents(tmp_path) == before
    execute(Tiny(25), tmp_path, squares, scheduler="tcp://127.0.0.1:1")  # nothing is missing, so nobody is asked
    assert contents(tmp_path) == before


def test_the_size_of_a_chunk_is_found_by_a_trial(tmp_path: Path) -> None:
    """A run takes 10 ms, and a chunk at least 1 s: at most 100 runs, and not much less."""
    plan = execute(Tiny(130, pace=0.01), tmp_path, squares, workers=1)
    assert 50 <= plan.chunk <= 100
    assert Tiny.read(tmp_path).chunk == plan.chunk
    assert_squares(tmp_path, plan)


@pytest.mark.parametrize(
    ("one", "runs", "workers", "chunk"),
    [
        (1e-3, 10**6, 2, 5000),  # 5 s
        (1e-3, 20_000, 2, 2500),  # four chunks for each worker
        (1e-3, 4000, 2, 1000),  # 1 s
        (1e-3, 300, 2, 300),
        (20.0, 100, 2, 1),
        (1e-6, 10**9, 2, 50_000),  # not more than memory takes
    ],
)
def test_a_chunk_lasts_some_seconds(one: float, runs: int, workers: int, chunk: int) -> None:
    assert _chunk_size(one, runs, workers) == chunk


@contextmanager
def without_leftovers() -> Iterator[set[psutil.Process]]:
    """Processes that were there before; none more is there after."""
    before = set(psutil.Process().children(recursive=True))
    yield before
    for process in set(psutil.Process().children(recursive=True)) - before:
        with suppress(psutil.NoSuchProcess):
            process.wait(10)


@pytest.mark.slow
def test_a_worker_that_is_killed_costs_its_chunk_alone(tmp_path: Path) -> None:
    killed: list[int] = []
    with without_leftovers() as before:

        def kill_one(done: int, runs: int) -> None:
            if done and not killed:
                started = set(psutil.Process().children(recursive=True)) - before
                victim = min((p for p in started if "spawn_main" in " ".join(p.cmdline())), key=lambda p: p.pid)
                killed.append(victim.pid)
                victim.kill()

        execute(SLOW, tmp_path / "a", squares, workers=2, progress=kill_one)
    assert len(killed) == 1
    execute(SLOW, tmp_path / "b", squares, workers=1)
    assert contents(tmp_path / "a") == contents(tmp_path / "b")


@pytest.mark.slow
def test_no_other_computer_reaches_what_a_sweep_of_this_one_listens_to(tmp_path: Path) -> None:
    heard: set[str] = set()

    def look(done: int, runs: int) -> None:
        processes = [psutil.Process(), *psutil.Process().children(recursive=True)]
        sockets = [c for process in processes for c in process.net_connections("inet")]
        heard.update(c.laddr.ip for c in sockets if c.status == psutil.CONN_LISTEN)

    execute(SLOW, tmp_path, squares, workers=2, progress=look)
    assert heard == {"127.0.0.1"}


@pytest.mark.slow
def test_a_chunk_that_ends_its_workers_does_not_stop_the_others(tmp_path: Path) -> None:
    """Dask also gives up a chunk that waited for the worker that ended; none of those that came later."""
    import dask  # noqa: PLC0415 (a moment that other tests need not wait)

    (tmp_path / "trap-20").touch()
    plan = Tiny(100, 10, trap=str(tmp_path))
    folder = tmp_path / "out"
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 0}),
        without_leftovers(),
        pytest.raises(UserError, match="chunks ended every worker that had them, the first one with the runs") as error,
    ):
        execute(plan, folder, squares, workers=2)
    assert "of 100 runs are in" in str(error.value)
    there = set(contents(folder))
    assert "part-000002.parquet" not in there
    assert there >= {f"part-{number:06}.parquet" for number in (6, 7, 8, 9)}
    (tmp_path / "trap-20").unlink()
    execute(plan, folder, squares, workers=1)
    assert_squares(folder, plan)


@pytest.mark.slow
def test_two_computers_work_and_one_does_not_see_the_folder(
    computers: Computers, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What the far one makes is sent back, and is written by the client; the near one writes its parts itself."""
    plan = Tiny(80, 10, pace=0.01)
    reported: list[str] = []
    sent_back: list[int] = []
    write = Parts.write
    monkeypatch.setattr(Parts, "write", lambda s, number, text: (sent_back.append(number), write(s, number, text)))
    execute(plan, computers.seen / "out", squares, scheduler=computers.address, notify=reported.append)
    assert_squares(computers.seen / "out", plan)
    assert 0 < len(sent_back) < 8
    assert len([line for line in reported if line.startswith("dashboard: http://127.0.0.1:")]) == 1


@pytest.mark.slow
def test_a_worker_of_another_version_is_refused(computers: Computers, tmp_path: Path) -> None:
    other = tmp_path / "other.py"
    other.write_text("import motionsync_fmu\nmotionsync_fmu.__version__ = '0.0.1'\n", "utf-8")
    from distributed import Client  # noqa: PLC0415

    with worker(computers.address, tmp_path, "--preload", str(other)):
        with Client(computers.address) as client:
            client.wait_for_workers(3, timeout=60)
        with pytest.raises(UserError, match=rf"has motionsync 0\.0\.1, and this computer has {__version__}$"):
            execute(Tiny(40, 10), tmp_path / "out", squares, scheduler=computers.address)
    with Client(computers.address) as client:
        deadline = time.monotonic() + 60.0
        while len(client.nthreads()) > 2 and time.monotonic() < deadline:  # the worker that was ended above
            time.sleep(0.05)


def test_an_interruption_keeps_what_is_done(tmp_path: Path) -> None:
    def interrupt(done: int, runs: int) -> None:
        if done == 20:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted, match=r"^interrupted: 20 of 60 runs are in .*, and the same command goes on"):
        execute(SLOW, tmp_path / "a", squares, workers=1, progress=interrupt)
    execute(SLOW, tmp_path / "a", squares, workers=1)
    execute(SLOW, tmp_path / "b", squares, workers=1)
    assert contents(tmp_path / "a") == contents(tmp_path / "b")


def test_a_full_disk_is_reported_and_finished_rows_are_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    written = 0

    def sync(descriptor: int) -> None:
        nonlocal written
        written += 1
        if written == 3:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", sync)
        with pytest.raises(UserError, match=r"part-000002.parquet cannot be written: No space left .*; 20 of 60 runs"):
            execute(Tiny(60, 10), tmp_path, squares, workers=1)
    assert list(contents(tmp_path)) == ["part-000000.parquet", "part-000001.parquet", "plan.toml"]
    execute(Tiny(60, 10), tmp_path, squares, workers=1)
    assert_squares(tmp_path, Tiny(60))


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="folders of Windows are not read-only")
def test_a_read_only_folder_is_reported() -> None:
    """root may write anywhere: the test is nobody for a moment."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        execute(Tiny(20, 10), folder, squares, workers=1)
        (folder / "part-000001.parquet").unlink()
        before = contents(folder)
        folder.chmod(0o555)
        nobody = 65534 if os.geteuid() == 0 else os.geteuid()
        me = os.geteuid()
        os.seteuid(nobody)
        try:
            for output in (folder, folder / "new"):
                with pytest.raises(UserError, match=r"cannot be (written|made): Permission denied"):
                    execute(Tiny(20, 10), output, squares, workers=1)
        finally:
            os.seteuid(me)
        assert contents(folder) == before


def truncated(file: Path) -> None:
    file.write_bytes(file.read_bytes()[:-20])


def flipped(file: Path) -> None:
    """One bit of the data, which is behind the four letters at the beginning and the first page's header."""
    text = bytearray(file.read_bytes())
    text[60] ^= 4
    file.write_bytes(bytes(text))


def emptied(file: Path) -> None:
    file.write_bytes(b"")


def of_another_sweep(file: Path) -> None:
    parts = Parts(file.parent, "another", 30, 10)
    file.write_bytes(parts.encode(1, squares(Tiny(30), 10, 20)))


def of_another_chunk(file: Path) -> None:
    """A whole part of the same plan, under another part's name."""
    file.write_bytes(file.with_name("part-000002.parquet").read_bytes())


@pytest.mark.parametrize("damage", [truncated, flipped, emptied, of_another_sweep, of_another_chunk])
def test_a_damaged_part_is_named(tmp_path: Path, damage: Callable[[Path], None]) -> None:
    execute(Tiny(30, 10), tmp_path, squares, workers=1)
    part = tmp_path / "part-000001.parquet"
    damage(part)
    with pytest.raises(
        UserError, match=r"part-000001.parquet (is damaged|belongs to another sweep).*: delete"
    ) as error:
        execute(Tiny(30, 10), tmp_path, squares, workers=1)
    assert "\n" not in str(error.value)
    part.unlink()  # as the message asks
    execute(Tiny(30, 10), tmp_path, squares, workers=1)
    assert_squares(tmp_path, Tiny(30))


def test_a_folder_takes_one_sweep_at_a_time(tmp_path: Path) -> None:
    """The second is refused while the first measures the size of a chunk, and while it works; then it goes on."""
    refused: list[str] = []

    def interfere(*_: object) -> None:
        with pytest.raises(UserError) as error:
            execute(Tiny(30, 10, seed=2), tmp_path, squares, workers=1)
        refused.append(str(error.value))

    execute(Tiny(30, 10), tmp_path, squares, workers=1, progress=interfere)
    assert set(refused) == {f"{tmp_path}: another sweep is at work in this folder; wait for it, or choose another"}
    assert_squares(tmp_path, execute(Tiny(30, 10), tmp_path, squares, workers=1))


def test_another_plan_is_refused(tmp_path: Path) -> None:
    execute(Tiny(30, 10), tmp_path, squares, workers=1)
    before = contents(tmp_path)
    for other, words in [
        (Tiny(30, 10, seed=2), "has another sweep: seed = 2, not 1; choose another folder"),
        (Tiny(30, 15), "has chunks of 10 runs, not 15"),
    ]:
        with pytest.raises(UserError, match=words):
            execute(other, tmp_path, squares, workers=1)
    (tmp_path / "plan.toml").unlink()
    with pytest.raises(UserError, match=r"has parts of a sweep, but no plan\.toml"):
        execute(Tiny(30, 10), tmp_path, squares, workers=1)
    del before["plan.toml"]
    assert contents(tmp_path) == before


def test_who_is_to_work_is_given_once(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"workers = 0 is not allowed: it must be >= 1"):
        execute(Tiny(30), tmp_path, squares, workers=0)
    with pytest.raises(UserError, match=r"workers = 2 is not allowed with a scheduler"):
        execute(Tiny(30), tmp_path, squares, workers=2, scheduler="tcp://127.0.0.1:1")


def test_a_scheduler_that_does_not_answer_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert worker_pool.REACH_TIME == 10.0
    monkeypatch.setattr(worker_pool, "REACH_TIME", 0.3)
    with pytest.raises(UserError, match=r"no scheduler answers at tcp://127\.0\.0\.1:1, for 0\.3 s$"):
        execute(Tiny(30, 10), tmp_path, squares, scheduler="tcp://127.0.0.1:1")
    with pytest.raises(UserError, match=r"nowhere is no address of a scheduler, such as tcp://"):
        execute(Tiny(30, 10), tmp_path, squares, scheduler="nowhere")


@pytest.mark.parametrize("answer", [b"", b"HTTP/1.1 400 Bad Request\r\nConnection: close\r\n\r\n"])
def test_what_is_no_scheduler_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, answer: bytes) -> None:
    monkeypatch.setattr(worker_pool, "REACH_TIME", 0.3)
    with socket.create_server(("127.0.0.1", 0)) as server:
        if answer:
            Thread(target=lambda: server.accept()[0].sendall(answer), daemon=True).start()
        address = f"tcp://127.0.0.1:{server.getsockname()[1]}"
        with pytest.raises(UserError, match=f"{address}"):
            execute(Tiny(30, 10), tmp_path, squares, scheduler=address)


@pytest.mark.slow
def test_two_computers_compile_once_each_and_make_one_table(computers: Computers, motionsync: Command) -> None:
    """One of them does not see the folder: it sends its rows back."""
    sweep = ("sweep", "Synchronizer/polynomial", "--set", "master.velocity=80:100:21", "--chunk", "1")
    done = motionsync(*sweep, "--scheduler", computers.address, "--output", computers.seen / "real", "--json")
    assert done.status == 0, done.err
    assert "dashboard: http://127.0.0.1:" in done.err
    assert json.loads(done.out)["now"] == 21
    motionsync(*sweep, "--workers", "1", "--output", "out")
    assert contents(computers.seen / "real") == contents(Path("out"))
    for cache in computers.caches:
        assert len(list(cache.glob("motionsync/blocks/Synchronizer-*"))) == 1
