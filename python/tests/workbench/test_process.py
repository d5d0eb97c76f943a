"""End of the process of `jbf workbench` by a signal."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from http.client import HTTPException
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("starlette", reason="the workbench's server is an extra")

from jbf.workbench import vendored
from jbf.workbench.session_file import FILE

pytestmark = [
    pytest.mark.skipif(os.name != "posix", reason="signals of POSIX"),
    pytest.mark.skipif(not vendored.is_complete(), reason="python -m jbf.workbench.vendored"),
]
KEPT = "jbf-workbench-*"


Ask = Callable[..., dict[str, Any]]


@contextmanager
def started(folder: Path, *more: str) -> Iterator[tuple[subprocess.Popen[str], Ask]]:
    """Process of `jbf workbench FOLDER`, and a function that sends a request to it.

    The process handles SIGINT and SIGHUP although the tests may run where they are ignored
    (nohup, background jobs).
    """

    def handle_signals() -> None:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        signal.signal(signal.SIGHUP, signal.SIG_DFL)

    process = subprocess.Popen(
        [sys.executable, "-m", "jbf", "workbench", str(folder), "--no-browser", *more],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env={**os.environ, "TMPDIR": str(folder)},
        preexec_fn=handle_signals,
    )  # fmt: skip
    assert process.stdout is not None
    address, token = process.stdout.readline().strip().split("/#token=")

    def ask(what: str, body: object = None) -> dict[str, Any]:
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(f"{address}/api/{what}", data, {"X-JBF-Token": token})
        with urllib.request.urlopen(request, timeout=60.0) as answer:
            return dict(json.load(answer))

    try:
        yield process, ask
    finally:
        process.kill()
        process.communicate()


@pytest.mark.parametrize(
    "name",
    ["SIGTERM", *(pytest.param(n, marks=pytest.mark.extended) for n in ("SIGHUP", "SIGINT"))],
)
def test_signal_during_a_fit_ends_the_process_quietly(tmp_path: Path, name: str) -> None:
    number = getattr(signal, name)
    with started(tmp_path, "--demo") as (process, ask):
        ask("diagnose", {})
        limit = time.monotonic() + 60.0
        while not (ask("state")["job"] or {}).get("total"):
            assert time.monotonic() < limit
            time.sleep(0.1)
        process.send_signal(number)
        _, complaints = process.communicate(timeout=60.0)
    assert process.returncode == 128 + number
    assert complaints.strip() in ("", "jbf: interrupted")
    assert list(tmp_path.glob(KEPT)) == []
    # Nothing was changed, so that no session is written.
    assert not (tmp_path / FILE).exists()


@pytest.mark.extended
def test_signal_during_requests_ends_the_process_quietly(tmp_path: Path) -> None:
    ended, answered = threading.Event(), threading.Semaphore(0)

    def request() -> None:
        while not ended.is_set():
            with suppress(OSError, HTTPException):
                ask("state")
                answered.release()

    with started(tmp_path, "--demo") as (process, ask):
        clients = [threading.Thread(target=request) for _ in range(3)]
        for client in clients:
            client.start()
        try:
            for _ in range(20):
                assert answered.acquire(timeout=60.0)
            process.send_signal(signal.SIGHUP)
            _, complaints = process.communicate(timeout=60.0)
        finally:
            ended.set()
            for client in clients:
                client.join()
    assert process.returncode == 128 + signal.SIGHUP
    assert complaints.strip() in ("", "jbf: interrupted")


def test_changes_are_saved_at_the_end_and_return_in_the_next_session(tmp_path: Path) -> None:
    def trims(state: dict[str, Any]) -> list[Any]:
        return [run["trim"] for run in state["runs"] if run["trim"]]

    with started(tmp_path, "--demo") as (process, ask):
        run = ask("state")["runs"][0]["name"]
        ask("trim", {"run": run, "from_s": 1.0, "to_s": 9.0})
        process.send_signal(signal.SIGINT)
        words, _ = process.communicate(timeout=60.0)
    assert FILE in words
    with started(tmp_path) as (_, ask):
        assert trims(ask("state")) == [[1.0, 9.0]]
        ask("sample", {"name": "axis"})
    # The sample that --demo opens does not replace the saved session.
    with started(tmp_path, "--demo") as (_, ask):
        assert trims(ask("state")) == [[1.0, 9.0]]
