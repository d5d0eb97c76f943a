"""Special files are refused without waiting; files with unusual names are read."""

import os
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path

import input_checks
import pytest
from input_checks import RMS_N, Capture, accepted, cases, compared, csv_text, refused
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
    # Import in advance the modules that a command imports on demand, possibly from a folder of
    # root.
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


def socket_file(name: str) -> None:
    with socket.socket(socket.AF_UNIX) as one:
        one.bind(name)


SPECIAL_FILES: dict[str, tuple[Callable[[str], object], str]] = {
    "a folder": (os.mkdir, "is a folder"),
    "a loop of links": (lambda n: Path(n).symlink_to(n), "(too many levels of symbolic links)"),
    "a pipe without a writer": (os.mkfifo, "nothing comes out of this pipe"),
    "a socket": (socket_file, "cannot be read"),
    "a dead link": (lambda n: Path(n).symlink_to("nowhere"), "the file does not exist"),
    "a link to zeros": (lambda n: Path(n).symlink_to("/dev/zero"), "is a device, not a file"),
}
# The case with a pipe is extended: each command waits ten seconds for a writer.
FAST = SPECIAL_FILES.keys() - {"a pipe without a writer"}
DEVICES = ("/dev/zero", "/dev/urandom", "/dev/full", "/dev/null")


@pytest.mark.parametrize(("make", "fragment"), cases(SPECIAL_FILES, FAST))
def test_special_file_is_refused_by_commands_and_readers(
    make: Callable[[str], object], fragment: str, capfd: Capture
) -> None:
    make("odd")
    line = refused(["predict", "model.toml", "odd", "--out", "new.csv"], fragment, capfd)
    assert line.startswith("jbf: odd: ")
    for read in (read_rig, read_map, Model.load, read_run):
        input_checks.raises_one_line(lambda read=read: read("odd"), fragment)  # type: ignore[misc]


@pytest.mark.parametrize("device", DEVICES)
def test_device_is_refused_by_every_command(device: str, capfd: Capture) -> None:
    fragment = f"{device}: is a device, not a file; name a file"
    for words in (
        ["compare", "model.toml", device],
        ["compare", device, "a.csv"],
        ["fit", device, "a.csv", "--out", "new.toml"],
        ["import", device, "--map", "map.toml", "--folder", "new"],
        ["import", "a.csv", "--map", device, "--folder", "new"],
    ):
        refused(words, fragment, capfd)


def test_file_without_read_permission_is_refused(capfd: Capture) -> None:
    Path("locked.csv").write_text(csv_text())
    Path("locked.csv").chmod(0)
    words = ["compare", "model.toml", "locked.csv"]
    with unprivileged():
        refused(words, "locked.csv: cannot be read (permission denied)", capfd)


@pytest.mark.parametrize(
    "words",
    [
        ["predict", "model.toml", "a.csv", "--out", "shut/new.csv"],
        ["compare", "model.toml", "a.csv", "--json", "shut/new.json"],
        ["import", "a.csv", "--map", "map.toml", "--folder", "shut/new"],
        ["import", "a.csv", "--map", "map.toml", "--folder", "shut"],
        ["demo", "shut/new"],
    ],
    ids=" ".join,
)
def test_output_to_folder_without_permission_is_refused(words: list[str], capfd: Capture) -> None:
    Path("shut").mkdir(mode=0o500)
    with unprivileged():
        refused(words, "(permission denied); check the path and its permissions", capfd)


@pytest.mark.parametrize("words", [
    "compare model.toml large",
    "compare large a.csv",
    "fit large a.csv --out new.toml",
    "import a.csv --map large --folder new",
])  # fmt: skip
def test_file_of_2_gigabytes_is_refused_without_reading_it(words: str, capfd: Capture) -> None:
    with Path("large").open("wb") as sparse_file:
        sparse_file.truncate(2 << 30)
    before, begun = sorted(Path().iterdir()), bytes_read()
    assert main(words.split()) == 2
    assert bytes_read() - begun < FEW_BYTES
    assert sorted(Path().iterdir()) == before
    printed = capfd.readouterr()
    assert (printed.out, printed.err.count("\n")) == ("", 1)
    beginning = "jbf: large: has 2.1 GB; what is read whole may have 0.54 GB; "
    assert printed.err.startswith(beginning)


FEW_BYTES = 64 << 20


def bytes_read() -> int:
    """Number of bytes read by this process; 0 on systems that do not count them."""
    counters = Path("/proc/self/io")
    text = counters.read_text(encoding="ascii") if counters.exists() else "rchar: 0"
    return int(text.split("rchar: ")[1].split()[0])


def test_run_is_read_from_a_named_pipe_with_a_writer(capfd: Capture) -> None:
    os.mkfifo("pipe.csv")
    writer = threading.Thread(target=lambda: Path("pipe.csv").write_text(csv_text()))
    writer.start()
    assert compared("pipe.csv", capfd)["rms"] == pytest.approx(RMS_N, rel=5e-3)
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


@pytest.mark.parametrize("file", UNUSUAL_NAMES.values(), ids=UNUSUAL_NAMES)
def test_unusual_file_name_is_printed_without_escapes(file: str, capfd: Capture) -> None:
    Path(file).write_text(csv_text())
    assert compared(file, capfd)["rms"] == pytest.approx(RMS_N, rel=5e-3)
    text = accepted(["compare", "model.toml", file], capfd)
    assert "\x1b" not in text
    Path(file).write_text("time_s\n1\n")
    line = refused(["compare", "model.toml", file], "row 1, column velocity_m_s: is missing", capfd)
    assert "\x1b" not in line


def test_null_character_in_a_file_name_is_refused() -> None:
    for read in (read_rig, read_map, Model.load, read_run, read_campaign, campaigns_in):
        input_checks.raises_one_line(lambda read=read: read("a\0b"), "")  # type: ignore[misc]


def test_output_through_a_link_is_written_to_its_target(folder: Path, capfd: Capture) -> None:
    (folder / "link.csv").symlink_to("target.csv")
    accepted(["predict", "model.toml", "a.csv", "--out", "link.csv"], capfd)
    assert (folder / "link.csv").is_symlink()
    assert (folder / "target.csv").read_text().startswith("time_s,friction_n\n")
