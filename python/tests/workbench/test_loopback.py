"""The workbench listens only on the loopback address and runs no code from a page."""

import socket
from pathlib import Path

import pytest

pytest.importorskip("starlette", reason="the workbench's server is an extra")

from jbf.errors import InputError
from jbf.workbench.serve import HOST, listening
from starlette.testclient import TestClient


def external_addresses() -> list[str]:
    """Addresses of this machine that are reachable from other machines."""
    result = {str(info[4][0]) for info in socket.getaddrinfo(socket.gethostname(), None)}
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))  # sends nothing
            result.add(str(probe.getsockname()[0]))
        except OSError:
            pass
    return sorted(a for a in result if not a.startswith("127.") and ":" not in a)


def test_server_listens_on_the_loopback_address_only() -> None:
    listener = listening(0)
    listener.listen()
    try:
        address, port = listener.getsockname()
        assert (address, HOST) == ("127.0.0.1", "127.0.0.1")
        socket.create_connection(("127.0.0.1", port), 5.0).close()
        for other in external_addresses():
            with pytest.raises(OSError):  # noqa: PT011 (refused, or unreachable)
                socket.create_connection((other, port), 5.0).close()
    finally:
        listener.close()


def test_server_on_an_occupied_port_reports_the_port() -> None:
    listener = listening(0)
    listener.listen()
    port = int(listener.getsockname()[1])
    try:
        with pytest.raises(InputError, match=f"port {port} is not available"):
            listening(port)
    finally:
        listener.close()


CODE = "__import__('pathlib').Path('run.txt').write_text('x')"


@pytest.mark.parametrize(
    ("address", "request_body"),
    [
        ("try", {"files": ["new.csv"], "map": f'[columns]\ntime_s = "{CODE}"\n'
                 'position_m = "`x`"\nfriction_n = "`f`"\n[drive]\nmotion = "linear"\n'
                 'friction = "force"\n'}),
        ("fit", {"effects": [CODE]}),
        ("fit", {"effects": ["os:system"]}),
        ("law", {"law": CODE}),
        ("open", {"rig": "code.toml", "runs": ["new.csv"]}),
        ("keep", {"what": CODE}),
    ],
)  # fmt: skip
@pytest.mark.usefixtures("inside_folder")
def test_python_code_in_a_workbench_request_is_not_run(
    client: TestClient, campaign: Path, address: str, request_body: dict[str, object]
) -> None:
    (campaign / "new.csv").write_text("t,x,f\n0,0,1\n1,1,1\n")
    (campaign / "code.toml").write_text(f'[drive]\nmotion = "{CODE}"\n')
    client.post("/api/open", json={"rig": "rig.toml", "runs": ["stopgo.csv"]})
    answer = client.post(f"/api/{address}", json=request_body)
    for name in ("new.csv", "code.toml"):
        (campaign / name).unlink()
    assert answer.status_code == 422 or answer.json()["problem"]
    assert not (campaign / "run.txt").exists()
