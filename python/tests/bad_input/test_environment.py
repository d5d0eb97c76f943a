"""The environment of a command: streams, encodings, threads and signals, in separate processes."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from input_checks import SECONDS, cases, csv_text
from jbf.cores import cap_threads, check_jobs, processes
from jbf.errors import InputError

COMPARE = ("compare", "model.toml", "a.csv")
EXTENDED = pytest.mark.extended
COMMAND = (sys.executable, "-m", "jbf")


def run(words: Sequence[str], redirect: str = "", **settings: str) -> Any:
    """Run a command in a shell with additional environment variables."""
    line = ["sh", "-c", f'"$0" "$@" {redirect}', *COMMAND, *words]
    return subprocess.run(line, env=os.environ | settings, capture_output=True, timeout=3 * SECONDS)


# Each case sets several variables, because each starts a process.
MINIMAL = {"RAYON_NUM_THREADS": "0", "MPLBACKEND": "tkagg", "DISPLAY": "nowhere:9", "LC_ALL": "C"}
MINIMAL |= {"PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
INVALID = {"RAYON_NUM_THREADS": "abc", "PYTHONIOENCODING": "latin-1", "COLUMNS": "wide"}
INVALID |= {"LINES": "-1", "LC_ALL": "xx_YY", "PYTHONWARNINGS": "error"}


@pytest.mark.parametrize("settings", [INVALID, pytest.param(MINIMAL, marks=EXTENDED)])
def test_compare_command_reports_the_same_rms_under_unusual_environment_variables(
    settings: dict[str, str], folder: Path
) -> None:
    file = "Lauf µ ∅.csv"
    (folder / file).write_text(csv_text())
    words = ["compare", "model.toml", file, "--report", "new.html", "--json", "new.json"]
    result = run(words, **settings)
    assert (result.returncode, result.stderr) == (0, b"")
    assert b"RMS 0.500 N against" in result.stdout
    assert b"<svg" in (folder / "new.html").read_bytes()
    assert "Lauf µ ∅" in (folder / "new.json").read_text(encoding="utf-8")


FULL = b"jbf: standard output: cannot be written (no space left on device)"
STREAMS = {"full": (">/dev/full", 2, FULL), "both closed": (">&- 2>&-", 0, b"")}
STREAMS["pipe without a reader"] = ("| true", 0, b"")
WORDS = {"compare": (COMPARE,), "help": (("--help",),)}


@pytest.mark.parametrize(("redirect", "code", "message"), cases(STREAMS, ["full"]))
@pytest.mark.parametrize("words", cases(WORDS, ["compare"]))
def test_full_standard_output_is_reported_and_a_closed_one_is_ignored(
    words: tuple[str, ...], redirect: str, code: int, message: bytes
) -> None:
    done = run(words, redirect=redirect)
    assert done.returncode == code
    assert done.stderr.startswith(message)
    assert done.stderr.count(b"\n") == (1 if message else 0)


def test_json_to_a_closed_standard_output_is_refused_in_one_line() -> None:
    done = run([*COMPARE, "--json", "-"], redirect=">&-")
    assert done.returncode == 2
    assert done.stderr.startswith(b"jbf: standard output: ")
    assert done.stderr.count(b"\n") == 1


def test_requested_threads_are_limited_to_the_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    cores = str(os.cpu_count() or 1)
    for requested, expected in (("100000", cores), ("1", "1"), ("0", "0"), ("abc", "abc")):
        monkeypatch.setenv("RAYON_NUM_THREADS", requested)
        cap_threads()
        assert os.environ["RAYON_NUM_THREADS"] == expected


def test_number_of_processes_is_limited_to_tasks_jobs_and_cores() -> None:
    assert processes(1_000_000, 3) == 3
    assert processes(2, 100) == 2
    assert processes(None, 1_000_000) == (os.cpu_count() or 1)
    assert processes(4, 0) == 1


def test_zero_jobs_are_refused_and_an_unset_number_of_jobs_is_accepted() -> None:
    with pytest.raises(InputError, match="--jobs: 0 campaigns at a time"):
        check_jobs(0)
    check_jobs(None)


def started(command: Sequence[str], stderr: int) -> subprocess.Popen[bytes]:
    """Start a process with the default action of SIGINT, which shells disable in the background."""

    def restore_interrupts() -> None:
        signal.signal(signal.SIGINT, signal.SIG_DFL)

    output = subprocess.PIPE
    return subprocess.Popen(command, stdout=output, stderr=stderr, preexec_fn=restore_interrupts)


def open_for_writing(pipe: str) -> int:
    """Open the pipe for writing as soon as another process reads from it."""
    end = time.monotonic() + SECONDS
    while True:
        try:
            return os.open(pipe, os.O_WRONLY | os.O_NONBLOCK)
        except OSError:
            if time.monotonic() > end:
                raise
            time.sleep(0.02)


def test_interrupted_command_prints_one_line_and_leaves_no_file(folder: Path) -> None:
    """The signal arrives while the command reads from an open pipe without content."""
    os.mkfifo("slow.csv")
    before = sorted(p.name for p in folder.iterdir())
    words = ["compare", "model.toml", "slow.csv", "--json", "new.json"]
    process = started([*COMMAND, *words], stderr=subprocess.PIPE)
    writer = open_for_writing("slow.csv")
    try:
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=SECONDS)
    finally:
        os.close(writer)
    assert (process.returncode, out, err) == (130, b"", b"jbf: interrupted\n")
    assert sorted(p.name for p in folder.iterdir()) == before


WRITER = """\
import sys
from jbf.text_files import write_texts
text = sys.argv[1] * 400_000
print("ready", flush=True)
while True:
    write_texts({"one.txt": text, "two.txt": text})
"""


@pytest.mark.parametrize("kind", [signal.SIGINT, pytest.param(signal.SIGKILL, marks=EXTENDED)])
def test_killed_concurrent_writers_leave_complete_files(kind: signal.Signals, folder: Path) -> None:
    commands = [[sys.executable, "-c", WRITER, letter] for letter in "ab"]
    writers = [started(command, stderr=subprocess.DEVNULL) for command in commands]
    complete = {letter * 400_000 for letter in "ab"}
    try:
        for writer in writers:
            assert writer.stdout is not None
            assert writer.stdout.readline() == b"ready\n"
        for _ in range(20):
            time.sleep(0.01)
            for name in ("one.txt", "two.txt"):
                if (folder / name).exists():
                    assert (folder / name).read_text() in complete
        for writer in writers:
            writer.send_signal(kind)
            writer.wait(SECONDS)
    finally:
        for writer in writers:
            writer.kill()
            assert writer.stdout is not None
            writer.stdout.close()
            writer.wait()
    assert {(folder / name).read_text() for name in ("one.txt", "two.txt")} <= complete
    if kind is signal.SIGINT:
        assert [p.name for p in folder.iterdir() if p.name.endswith(".tmp")] == []
