"""Special files are refused without waiting; files with unusual names are read."""

from __future__ import annotations

import os
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path

import pytest
from input_checks import (
    RMS_N,
    Capture,
    accepted,
    compared,
    csv_text,
    raises_one_line,
    refused,
)
from jbf import read_map, read_rig, read_run
from jbf.cli import main, parser
from jbf.models.model import Model
from jbf.records.folder import campaigns_in, read_campaign


@contextmanager
def unprivileged() -> Iterator[None]:
    """Run as a user without rights on other files, because root may read and write everything."""
    if os.geteuid() != 0:
        yield
        return
    # Import now what a command imports on demand, possibly from a folder that only root can read.
    parser()
    b"".decode("utf-8-sig")
    for module in ("comparison.comparison", "importing.import_files", "demo"):
        import_module(f"jbf.{module}")
    Path().chmod(0o777)
    os.seteuid(65534)
    try:
        yield
    finally:
        os.seteuid(0)


def link_to_itself(name: str) -> None:
    Path(name).symlink_to(name)


def socket_file(name: str) -> None:
    with socket.socket(socket.AF_UNIX) as one:
        one.bind(name)


def unreadable_file(name: str) -> None:
    Path(name).write_text(csv_text())
    Path(name).chmod(0)


def dangling_link(name: str) -> None:
    Path(name).symlink_to("nowhere")


SPECIAL_FILES: dict[str, tuple[Callable[[str], object], str]] = {
    "a folder": (os.mkdir, "is a folder"),
    "a loop of links": (link_to_itself, "cannot be read (too many levels of symbolic links)"),
    "a pipe without a writer": (os.mkfifo, "nothing comes out of this pipe"),
    "a socket": (socket_file, "cannot be read"),
    "a dead link": (dangling_link, "the file does not exist"),
    "a link to zeros": (lambda n: Path(n).symlink_to("/dev/zero"), "is a device, not a file"),
}
PIPE = "a pipe without a writer"
EXTENDED = pytest.mark.extended
DEVICES = ("/dev/zero", "/dev/urandom", "/dev/full", "/dev/null")


SPECIAL = [pytest.param(n, marks=EXTENDED if n == PIPE else ()) for n in SPECIAL_FILES]
"""The case with a pipe is extended: each command waits ten seconds for a writer."""


@pytest.mark.parametrize("name", SPECIAL)
def test_special_file_is_refused_by_commands_and_readers(name: str, capfd: Capture) -> None:
    make, fragment = SPECIAL_FILES[name]
    make("odd")
    line = refused(["predict", "model.toml", "odd", "--out", "new.csv"], fragment, capfd)
    assert line.startswith("jbf: odd: ")
    for read in (read_rig, read_map, Model.load, read_run):
        raises_one_line(lambda read=read: read("odd"), fragment)  # type: ignore[misc]


@pytest.mark.parametrize("device", DEVICES)
def test_device_is_refused_by_every_command(device: str, capfd: Capture) -> None:
    fragment = f"{device}: is a device, not a file; name a file"
    for words in (
        ["compare", "model.toml", device],
        ["compare", device, "a.csv"],
        ["fit", device, "a.csv", "--out", "new.toml"],
        ["import", device, "--map", "map.toml", "--out", "new"],
        ["import", "a.csv", "--map", device, "--out", "new"],
    ):
        refused(words, fragment, capfd)


def test_unreadable_file_is_refused(capfd: Capture) -> None:
    unreadable_file("locked.csv")
    words = ["compare", "model.toml", "locked.csv"]
    with unprivileged():
        refused(words, "locked.csv: cannot be read (permission denied)", capfd)


@pytest.mark.parametrize(
    "words",
    [
        ["predict", "model.toml", "a.csv", "--out", "shut/new.csv"],
        ["compare", "model.toml", "a.csv", "--json", "shut/new.json"],
        ["import", "a.csv", "--map", "map.toml", "--out", "shut/new"],
        ["import", "a.csv", "--map", "map.toml", "--out", "shut"],
        ["demo", "shut/new"],
    ],
    ids=" ".join,
)
def test_unwritable_folder_is_refused(words: list[str], capfd: Capture) -> None:
    Path("shut").mkdir(mode=0o500)
    with unprivileged():
        refused(words, "(permission denied); check the path and its permissions", capfd)


@pytest.mark.parametrize("words", [
    "compare model.toml large",
    "compare large a.csv",
    "fit large a.csv --out new.toml",
    "import a.csv --map large --out new",
])  # fmt: skip
def test_file_of_two_gigabytes_is_refused_without_reading_it(words: str, capfd: Capture) -> None:
    code, line, read = with_two_gigabytes("large", words.split(), capfd)
    assert code == 2
    assert line.startswith("jbf: large: has 2.1 GB; what is read whole may have 0.54 GB; ")
    assert read < FEW_BYTES


FEW_BYTES = 64 << 20


def bytes_read() -> int:
    """Bytes that this process has read; 0 on systems that do not count them."""
    counters = Path("/proc/self/io")
    text = counters.read_text(encoding="ascii") if counters.exists() else "rchar: 0"
    return int(text.split("rchar: ")[1].split()[0])


def with_two_gigabytes(name: str, words: list[str], capfd: Capture) -> tuple[int, str, int]:
    """Run a command on a sparse file of 2 GiB; return exit code, its one line, and bytes read."""
    with Path(name).open("wb") as file:
        file.truncate(2 << 30)
    before = sorted(p.name for p in Path().iterdir())
    begun = bytes_read()
    code = main(words)
    read = bytes_read() - begun
    assert sorted(p.name for p in Path().iterdir()) == before
    Path(name).unlink()
    printed = capfd.readouterr()
    assert printed.out == ""
    assert printed.err.count("\n") == 1
    return code, printed.err, read


def test_pipe_with_a_writer_is_read(capfd: Capture) -> None:
    os.mkfifo("pipe.csv")
    writer = threading.Thread(target=lambda: Path("pipe.csv").write_text(csv_text()))
    writer.start()
    assert compared("pipe.csv", capfd)["rms_n"] == pytest.approx(RMS_N, rel=5e-3)
    writer.join()


UNUSUAL_NAMES = {
    "a dash first": "./-x.csv",
    "unicode": "Lauf µ ∅ 摩擦.csv",
    "markup": "<b>&amp;[red]x.csv",
    "a line break": "a\nb.csv",
    "an escape": "a\x1b[31mb.csv",
    "brackets": "a[1].csv",
    "bytes that are no UTF-8": os.fsdecode(b"a\xff.csv"),
}


@pytest.mark.parametrize("name", UNUSUAL_NAMES)
def test_file_with_an_unusual_name_is_read_and_its_name_is_printed_without_escapes(
    name: str, folder: Path, capfd: Capture
) -> None:
    file = UNUSUAL_NAMES[name]
    (folder / file).write_text(csv_text())
    assert compared(file, capfd)["rms_n"] == pytest.approx(RMS_N, rel=5e-3)
    text = accepted(["compare", "model.toml", file], capfd)
    assert "\x1b" not in text
    (folder / file).write_text("time_s\n1\n")
    line = refused(["compare", "model.toml", file], "row 1, column velocity_m_s: is missing", capfd)
    assert "\x1b" not in line


def test_null_character_in_a_file_name_is_refused() -> None:
    for read in (read_rig, read_map, Model.load, read_run, read_campaign, campaigns_in):
        raises_one_line(lambda read=read: read("a\0b"), "")  # type: ignore[misc]


def test_output_through_a_link_is_written_to_its_target_and_preserves_the_link(
    folder: Path, capfd: Capture
) -> None:
    (folder / "link.csv").symlink_to("target.csv")
    accepted(["predict", "model.toml", "a.csv", "--out", "link.csv"], capfd)
    assert (folder / "link.csv").is_symlink()
    assert (folder / "target.csv").read_text().startswith("time_s,friction_n\n")
