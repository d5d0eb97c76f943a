"""What stands round a command: streams, encodings, threads, signals; in processes of their own."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

import pytest
from bad_input.checking import HEADER, ROWS, SECONDS, table
from jbf.cores import cap_threads, check_jobs, processes
from jbf.errors import InputError

COMPARE = ("compare", "model.toml", "a.csv")
COMMAND = (sys.executable, "-m", "jbf")


def run(
    words: Sequence[str], environment: Mapping[str, str] | None = None, *, redirect: str = ""
) -> subprocess.CompletedProcess[bytes]:
    """A command, as a shell runs it."""
    line = ' "$0" "$@" ' + redirect
    return subprocess.run(
        ["sh", "-c", line, *COMMAND, *words],
        env={**os.environ, **(environment or {})},
        capture_output=True,
        timeout=3 * SECONDS,
        check=False,
    )


ODD = {
    "too much": {
        "RAYON_NUM_THREADS": "100000",
        "MPLBACKEND": "nonsense",
        "PYTHONIOENCODING": "ascii",
        "COLUMNS": "3",
        "HOME": "/nonexistent",
    },
    "too little": {
        "RAYON_NUM_THREADS": "0",
        "MPLBACKEND": "tkagg",
        "DISPLAY": "nowhere:9",
        "LC_ALL": "C",
        "PYTHONUTF8": "0",
        "PYTHONCOERCECLOCALE": "0",
    },
    "words": {
        "RAYON_NUM_THREADS": "abc",
        "PYTHONIOENCODING": "latin-1",
        "COLUMNS": "wide",
        "LINES": "-1",
        "LC_ALL": "xx_YY",
        "PYTHONWARNINGS": "error",
    },
}
"""Several at a time, for each costs a process."""


@pytest.mark.parametrize("name", ODD)
def test_an_odd_environment_changes_nothing(name: str, folder: Path) -> None:
    file = "Lauf µ ∅.csv"
    (folder / file).write_text(table())
    found = run(["compare", "model.toml", file, "--report", "new.html", "--json", "new.json"],
                ODD[name])  # fmt: skip
    assert (found.returncode, found.stderr) == (0, b"")
    assert b"RMS 0.500 N against" in found.stdout
    assert b"<svg" in (folder / "new.html").read_bytes()
    assert "Lauf µ ∅" in (folder / "new.json").read_text(encoding="utf-8")


def test_json_on_an_ascii_terminal_is_that_of_a_file(folder: Path) -> None:
    (folder / "µ ∅.csv").write_text(table())
    words = ["compare", "model.toml", "µ ∅.csv", "--json"]
    told = run([*words, "-"], {"PYTHONIOENCODING": "ascii"})
    assert (told.returncode, told.stderr) == (0, b"")
    assert json.loads(told.stdout.decode("utf-8"))["runs"][0]["run"] == "µ ∅"


STREAMS = {
    "closed": (">&-", 0, b""),
    "both closed": (">&- 2>&-", 0, b""),
    "full": (">/dev/full", 2, b"jbf: standard output: cannot be written (no space left on device)"),
    "nobody reads": ("| true", 0, b""),
}


@pytest.mark.parametrize("name", STREAMS)
@pytest.mark.parametrize("words", [COMPARE, ("--help",)], ids=lambda w: w[0])
def test_standard_output_that_takes_nothing(words: tuple[str, ...], name: str) -> None:
    redirect, code, said = STREAMS[name]
    found = run(words, redirect=redirect)
    assert found.returncode == code
    if name != "closed" or words == COMPARE:  # argparse helps on stderr then
        assert found.stderr.startswith(said)
        assert found.stderr.count(b"\n") == (1 if said else 0)


@pytest.mark.parametrize(("redirect", "said"), [
    (">&-", b"jbf: standard output: is closed; name a file in the place of -\n"),
    (">/dev/full", b"jbf: standard output: cannot be written (no space left on device); "),
])  # fmt: skip
def test_a_result_for_standard_output_is_not_lost_unsaid(redirect: str, said: bytes) -> None:
    found = run([*COMPARE, "--json", "-"], redirect=redirect)
    assert found.returncode == 2
    assert found.stderr.startswith(said)
    assert found.stderr.count(b"\n") == 1


def test_no_more_threads_than_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    cores = str(os.cpu_count() or 1)
    for asked, given in (("100000", cores), ("1", "1"), ("0", "0"), ("abc", "abc")):
        monkeypatch.setenv("RAYON_NUM_THREADS", asked)
        cap_threads()
        assert os.environ["RAYON_NUM_THREADS"] == given


def test_the_threads_that_there_are() -> None:
    code = (
        "import jbf, threading, numpy as np\n"
        "t = np.linspace(0.0, 1.0, 50)\n"
        "run = jbf.Run.from_arrays(t, np.cos(t))\n"
        "jbf.Model(jbf.Rig(), 'coulomb').predict_many([run] * 64)\n"
        "print(len(__import__('os').listdir('/proc/self/task')))\n"
    )
    given = {**os.environ, "RAYON_NUM_THREADS": "100000", "OPENBLAS_NUM_THREADS": "1"}
    told = subprocess.run([sys.executable, "-c", code], env=given, capture_output=True, check=True)
    assert int(told.stdout) <= 2 * (os.cpu_count() or 1) + 2


def test_no_more_processes_than_work() -> None:
    """A pool starts all of them at once."""
    assert processes(1_000_000, 3) == 3
    assert processes(2, 100) == 2
    assert processes(None, 1_000_000) == (os.cpu_count() or 1)
    assert processes(4, 0) == 1
    with pytest.raises(InputError, match="--jobs: 0 campaigns at a time"):
        check_jobs(0)
    check_jobs(None)


def hears_interrupts() -> None:
    """In a child: what a shell starts in the background ignores them, and so would this."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def test_ctrl_c_is_one_line_and_leaves_nothing(folder: Path) -> None:
    """While it waits for a pipe that nobody fills, which it does for seconds."""
    os.mkfifo("slow.csv")
    before = sorted(p.name for p in folder.iterdir())
    process = subprocess.Popen(
        [*COMMAND, "compare", "model.toml", "slow.csv", "--json", "new.json"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        preexec_fn=hears_interrupts,
    )
    # Only once the pipe is read has the command begun.
    end = time.monotonic() + SECONDS
    while time.monotonic() < end:
        try:
            os.close(os.open("slow.csv", os.O_WRONLY | os.O_NONBLOCK))
        except OSError:
            time.sleep(0.02)
            continue
        break
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=SECONDS)
    if process.returncode == 2:  # the pipe was closed before the signal came
        pytest.skip("the command was quicker than the interrupt")
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


@pytest.mark.parametrize("kind", [signal.SIGINT, signal.SIGKILL])
def test_two_writers_and_a_kill_leave_whole_files(kind: signal.Signals, folder: Path) -> None:
    writers = [
        subprocess.Popen(
            [sys.executable, "-c", WRITER, letter],
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            preexec_fn=hears_interrupts,
        )
        for letter in "ab"
    ]
    wholes = {letter * 400_000 for letter in "ab"}
    try:
        for writer in writers:
            assert writer.stdout is not None
            assert writer.stdout.readline() == b"ready\n"
        for _ in range(20):
            time.sleep(0.01)
            for name in ("one.txt", "two.txt"):
                if (folder / name).exists():
                    assert (folder / name).read_text() in wholes
        for writer in writers:
            writer.send_signal(kind)
            writer.wait(SECONDS)
    finally:
        for writer in writers:
            writer.kill()
            assert writer.stdout is not None
            writer.stdout.close()
            writer.wait()
    assert {(folder / name).read_text() for name in ("one.txt", "two.txt")} <= wholes
    if kind is signal.SIGINT:
        assert [p.name for p in folder.iterdir() if p.name.endswith(".tmp")] == []


def test_the_table_is_what_the_model_says() -> None:
    """Of the made-up run itself, lest every test above hold for nothing."""
    assert HEADER == ("time_s", "velocity_m_s", "friction_n")
    assert len({row[2] for row in ROWS}) > 50
