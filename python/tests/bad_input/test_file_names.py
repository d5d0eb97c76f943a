"""What is no plain file, and names that are odd: told at once, or read like any other."""

from __future__ import annotations

import os
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path

import pytest
from bad_input.checking import RMS_N, Capture, accepted, compared, one_line, refused, table
from jbf import read_map, read_rig, read_run, text_files
from jbf.cli import main, parser
from jbf.models.model import Model
from jbf.records.folder import campaigns_in, read_campaign


@contextmanager
def nobody() -> Iterator[None]:
    """A user with few rights, who may write into the folder: root may read and write everything."""
    if os.geteuid() != 0:
        yield
        return
    # What a command imports late may stand where only root may read.
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


def loop(name: str) -> None:
    Path(name).symlink_to(name)


def plug(name: str) -> None:
    with socket.socket(socket.AF_UNIX) as one:
        one.bind(name)


def locked(name: str) -> None:
    Path(name).write_text(table())
    Path(name).chmod(0)


def dead(name: str) -> None:
    Path(name).symlink_to("nowhere")


MADE: dict[str, tuple[Callable[[str], object], str]] = {
    "a folder": (os.mkdir, "is a folder"),
    "a loop of links": (loop, "cannot be read (too many levels of symbolic links)"),
    "a pipe that nobody fills": (os.mkfifo, "nothing comes out of this pipe"),
    "a socket": (plug, "cannot be read"),
    "a dead link": (dead, "the file does not exist"),
    "a link to zeros": (lambda n: Path(n).symlink_to("/dev/zero"), "is a device, not a file"),
}
DEVICES = ("/dev/zero", "/dev/urandom", "/dev/full", "/dev/null")


@pytest.fixture(autouse=True)
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(text_files, "PIPE_S", 0.2)


@pytest.mark.parametrize("name", MADE)
def test_what_is_no_file_is_told(name: str, capfd: Capture) -> None:
    make, fragment = MADE[name]
    make("odd")
    line = refused(["predict", "model.toml", "odd", "--out", "new.csv"], fragment, capfd)
    assert line.startswith("jbf: odd: ")
    for read in (read_rig, read_map, Model.load, read_run):
        one_line(lambda read=read: read("odd"), fragment)  # type: ignore[misc]


@pytest.mark.parametrize("name", [n for n in MADE if n != "a folder"])
@pytest.mark.parametrize("first", [["compare", "model.toml"], ["fit", "rig.toml", "--out", "m"],
                                   ["import", "--map", "map.toml", "--out", "new"]],
                         ids=lambda words: words[0])  # fmt: skip
def test_of_every_command(first: list[str], name: str, capfd: Capture) -> None:
    make, _ = MADE[name]
    make("odd.csv")
    refused([*first[:2], "odd.csv", *first[2:]], "odd.csv: ", capfd)


@pytest.mark.parametrize("device", DEVICES)
def test_a_device_is_no_file(device: str, capfd: Capture) -> None:
    told = f"{device}: is a device, not a file; name a file"
    for words in (
        ["compare", "model.toml", device],
        ["compare", device, "a.csv"],
        ["fit", device, "a.csv", "--out", "new.toml"],
        ["import", device, "--map", "map.toml", "--out", "new"],
        ["import", "a.csv", "--map", device, "--out", "new"],
    ):
        refused(words, told, capfd)


def test_a_file_without_rights(capfd: Capture) -> None:
    locked("locked.csv")
    words = ["compare", "model.toml", "locked.csv"]
    with nobody():
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
def test_a_folder_without_rights(words: list[str], capfd: Capture) -> None:
    Path("shut").mkdir(mode=0o500)
    with nobody():
        refused(words, "(permission denied); check the path and its permissions", capfd)


@pytest.mark.parametrize("words", [
    "compare model.toml large",
    "compare large a.csv",
    "fit large a.csv --out new.toml",
    "import a.csv --map large --out new",
])  # fmt: skip
def test_two_gigabytes_are_not_read_whole(words: str, capfd: Capture) -> None:
    """A file of holes: what is refused by its size is not read."""
    code, said, read = with_two_gigabytes("large", words.split(), capfd)
    assert code == 2
    assert said.startswith("jbf: large: has 2.1 GB; what is read whole may have 0.54 GB; ")
    assert read < FEW_BYTES


def test_an_import_reads_two_gigabytes_in_blocks(capfd: Capture) -> None:
    """Not to their end: the first blocks say what they are."""
    words = ["import", "large.csv", "--map", "map.toml", "--out", "new"]
    code, said, read = with_two_gigabytes("large.csv", words, capfd)
    assert code == 2
    assert said.startswith("jbf: large.csv: ")
    assert "GB" not in said
    assert read < FEW_BYTES


FEW_BYTES = 64 << 20


def bytes_read() -> int:
    """By this process so far; a system that does not count them says 0."""
    counters = Path("/proc/self/io")
    told = counters.read_text(encoding="ascii") if counters.exists() else "rchar: 0"
    return int(told.split("rchar: ")[1].split()[0])


def with_two_gigabytes(name: str, words: list[str], capfd: Capture) -> tuple[int, str, int]:
    """Exit code, what was said in one line, and how many bytes were read. (`refused` compares
    what is in the folder, byte by byte.)"""
    with Path(name).open("wb") as file:
        file.truncate(2 << 30)
    before = sorted(p.name for p in Path().iterdir())
    begun = bytes_read()
    code = main(words)
    read = bytes_read() - begun
    assert sorted(p.name for p in Path().iterdir()) == before
    Path(name).unlink()
    told = capfd.readouterr()
    assert told.out == ""
    assert told.err.count("\n") == 1
    return code, told.err, read


def test_a_pipe_that_is_filled_is_read(capfd: Capture) -> None:
    os.mkfifo("pipe.csv")
    writer = threading.Thread(target=lambda: Path("pipe.csv").write_text(table()))
    writer.start()
    assert compared("pipe.csv", capfd)["rms_n"] == pytest.approx(RMS_N, rel=5e-3)
    writer.join()


def test_a_pipe_without_end_is_left(monkeypatch: pytest.MonkeyPatch, capfd: Capture) -> None:
    monkeypatch.setattr(text_files, "PIPE_BYTES", 1000)
    os.mkfifo("pipe.csv")

    def fill() -> None:
        # Its reader goes away.
        with suppress(BrokenPipeError):
            Path("pipe.csv").write_text(table() * 1000)

    writer = threading.Thread(target=fill)
    writer.start()
    refused(["compare", "model.toml", "pipe.csv"], "pipe.csv: is longer than", capfd)
    writer.join(5.0)
    assert not writer.is_alive()


ODD_NAMES = {
    "blanks": " a  b .csv",
    "a dash first": "./-x.csv",
    "unicode": "Lauf µ ∅ 摩擦.csv",
    "markup": "<b>&amp;[red]x.csv",
    "percent": "100%s%n{}.csv",
    "quotes": "a'b\"c.csv",
    "a line break": "a\nb.csv",
    "an escape": "a\x1b[31mb.csv",
    "brackets": "a[1].csv",
    "a star": "a*.csv",
    "no ending": "plain",
    "two endings": "a.csv.csv",
    "capitals": "A.CSV",
    "200 letters": "n" * 200 + ".csv",
    "bytes that are no UTF-8": os.fsdecode(b"a\xff.csv"),
    "hidden": ".a.csv",
}


@pytest.mark.parametrize("name", ODD_NAMES)
def test_an_odd_name_is_a_name(name: str, folder: Path, capfd: Capture) -> None:
    file = ODD_NAMES[name]
    (folder / file).write_text(table())
    assert compared(file, capfd)["rms_n"] == pytest.approx(RMS_N, rel=5e-3)
    told = accepted(["compare", "model.toml", file], capfd)
    assert "\x1b" not in told
    (folder / file).write_text("time_s\n1\n")
    line = refused(["compare", "model.toml", file], "row 1, column velocity_m_s: is missing", capfd)
    assert "\x1b" not in line


NO_NAMES = {
    "300 letters": ("n" * 300, "file name too long"),
    "in a file": ("rig.toml/a.csv", "not a directory"),
    "in no folder": ("no/such/a.csv", "its folder does not exist"),
    "a slip": ("b.csv", "the file does not exist"),
    "a slip of the ending": ("a.cvs", 'did you mean "a.csv"?'),
    "no match": ("*.txt", "no file matches; correct the pattern"),
    "itself twice": ("./a.csv", "is given twice; name each run once"),
}


@pytest.mark.parametrize("name", NO_NAMES)
def test_a_name_of_nothing(name: str, capfd: Capture) -> None:
    file, fragment = NO_NAMES[name]
    refused(["compare", "model.toml", "a.csv", file], fragment, capfd)


def test_a_null_in_a_name_is_told() -> None:
    for read in (read_rig, read_map, Model.load, read_run, read_campaign, campaigns_in):
        one_line(lambda read=read: read("a\0b"), "")  # type: ignore[misc]


def test_a_link_is_followed_and_stays(folder: Path, capfd: Capture) -> None:
    (folder / "link.csv").symlink_to("target.csv")
    accepted(["predict", "model.toml", "a.csv", "--out", "link.csv"], capfd)
    assert (folder / "link.csv").is_symlink()
    assert (folder / "target.csv").read_text().startswith("time_s,friction_n\n")
