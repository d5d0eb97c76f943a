"""End of the process of `jbf workbench` by a signal."""

import json
import os
import signal
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

import pytest

pytest.importorskip("starlette", reason="the workbench's server is an extra")

from jbf.workbench import vendored

pytestmark = [
    pytest.mark.skipif(os.name != "posix", reason="signals of POSIX"),
    pytest.mark.skipif(not vendored.is_complete(), reason="python -m jbf.workbench.vendored"),
]
KEPT = "jbf-workbench-*"


@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP", "SIGINT"])
def test_signal_during_a_fit_ends_the_process_quietly(tmp_path: Path, name: str) -> None:
    number = getattr(signal, name)
    process = subprocess.Popen(
        [sys.executable, "-m", "jbf", "workbench", str(tmp_path), "--no-browser", "--demo"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env={**os.environ, "TMPDIR": str(tmp_path)},
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )  # fmt: skip
    assert process.stdout is not None
    address, token = process.stdout.readline().strip().split("/#token=")

    def ask(what: str, body: object = None) -> dict[str, object]:
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(f"{address}/api/{what}", data, {"X-JBF-Token": token})
        with urllib.request.urlopen(request, timeout=60.0) as answer:
            return dict(json.load(answer))

    ask("diagnose", {})
    limit = time.monotonic() + 60.0
    while not dict(ask("state")["job"] or {}).get("total"):  # type: ignore[call-overload]
        assert time.monotonic() < limit
        time.sleep(0.1)
    process.send_signal(number)
    _, complaints = process.communicate(timeout=60.0)
    assert process.returncode == 128 + number
    assert complaints.strip() in ("", "jbf: interrupted")
    assert list(tmp_path.glob(KEPT)) == []
