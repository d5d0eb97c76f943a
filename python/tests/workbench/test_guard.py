"""Access control of the workbench: foreign hosts, origins, tokens, uploads, paths."""

import asyncio
import re
import threading
from collections.abc import Iterator, MutableMapping
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("starlette", reason="the workbench's server is an extra")

from jbf.workbench import actions
from jbf.workbench.app import create_app
from jbf.workbench.files import Folder
from jbf.workbench.guard import POLICY
from jbf.workbench.session import Session
from starlette.applications import Starlette
from starlette.testclient import TestClient
from workbench_parts import PORT, TOKEN, client_of

OWN = f"127.0.0.1:{PORT}"
PATHS = ["/", "/api/state", "/api/files", "/static/main.js"]


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize(
    "host",
    ["evil.example", f"evil.example:{PORT}", "127.0.0.1", f"127.0.0.1:{PORT + 1}", "0.0.0.0"],
)
def test_request_with_a_foreign_host_is_refused(client: TestClient, path: str, host: str) -> None:
    answer = client.get(path, headers={"host": host})
    assert answer.status_code == 400
    assert "token" not in answer.text.lower()


ORIGINS = ("http://evil.example", "null", f"https://{OWN}", "http://127.0.0.1:1")


@pytest.mark.parametrize("origin", ORIGINS)
@pytest.mark.parametrize("method", ["GET", "POST"])
def test_foreign_origin_is_refused_with_token(client: TestClient, origin: str, method: str) -> None:
    path = {"GET": "/api/state", "POST": "/api/undo"}[method]
    assert client.request(method, path, headers={"origin": origin}).status_code == 403


def test_static_file_requested_by_another_site_is_refused(client: TestClient) -> None:
    for site in ("cross-site", "same-site"):
        assert client.get("/static/main.js", headers={"sec-fetch-site": site}).status_code == 403


def test_same_origin_and_localhost_requests_are_served(client: TestClient) -> None:
    own = {"origin": f"http://{OWN}", "sec-fetch-site": "same-origin"}
    assert client.get("/api/state", headers=own).status_code == 200
    assert client.get("/api/state", headers={"host": f"localhost:{PORT}"}).status_code == 200


@pytest.mark.parametrize("token", ["", "wrong", TOKEN[:-1], TOKEN + "x", "ä"])
def test_request_with_a_wrong_token_is_refused(client: TestClient, token: str) -> None:
    headers = {"x-jbf-token": token.encode("latin-1")}
    for method, path in (("GET", "/api/state"), ("POST", "/api/open"), ("GET", "/api/events")):
        answer = client.request(method, path, headers=headers)
        assert answer.status_code == 403, (method, path)
        assert TOKEN not in answer.text


def test_start_page_does_not_contain_the_access_token(client: TestClient) -> None:
    page = client.get("/", headers={"x-jbf-token": ""})
    assert page.status_code == 200
    assert TOKEN not in page.text


@pytest.mark.parametrize("path", PATHS)
def test_every_workbench_response_has_the_security_headers(client: TestClient, path: str) -> None:
    answer = client.get(path)
    assert answer.headers["content-security-policy"] == POLICY
    assert answer.headers["x-content-type-options"] == "nosniff"
    assert answer.headers["cross-origin-resource-policy"] == "same-origin"
    assert not [name for name in answer.headers if name.startswith("access-control-")]


def test_content_security_policy_allows_only_this_server() -> None:
    parts = dict(part.split(" ", 1) for part in POLICY.split("; "))
    assert parts["default-src"] == parts["frame-ancestors"] == "'none'"
    assert parts["script-src"] == "'self'"
    assert not re.search("unsafe|http", POLICY)


def test_preflight_request_of_a_foreign_origin_is_refused(client: TestClient) -> None:
    headers = {"origin": "http://evil.example", "access-control-request-method": "POST"}
    answer = client.options("/api/open", headers=headers)
    assert answer.status_code == 403
    assert "access-control-allow-origin" not in answer.headers


def test_web_socket_connection_to_the_workbench_is_refused(client: TestClient) -> None:
    with pytest.raises(Exception), client.websocket_connect("/api/events"):  # noqa: B017, PT011
        pass


@pytest.mark.parametrize("declared", [True, False])
def test_upload_above_limit_is_refused(session: Session, campaign: Path, declared: bool) -> None:
    client = client_of(session, largest=1000)
    body = b"x" * 4000
    content = body if declared else iter([body[:500], body[500:]])
    answer = client.post("/api/upload?name=big.csv", content=content)
    assert answer.status_code == 413
    assert not list(campaign.glob("*big*"))


@pytest.mark.parametrize(
    "name",
    ["../up.csv", "a/b.csv", "..", "", "/etc/x.csv", ".hidden.csv", "run.py", "run.html",
     "a\\b.csv", "model.so", "x.csv\0.toml", "workbench.json"],
)  # fmt: skip
def test_upload_with_unsafe_name_is_refused(client: TestClient, campaign: Path, name: str) -> None:
    before = sorted(campaign.parent.rglob("*"))
    answer = client.post("/api/upload", params={"name": name}, content=b"t,v\n")
    assert answer.status_code == 422
    assert "error" in answer.json()
    assert sorted(campaign.parent.rglob("*")) == before


def test_uploaded_file_has_the_bytes_of_the_request(client: TestClient, campaign: Path) -> None:
    assert client.post("/api/upload?name=new.csv", content=b"time_s\n1\n").status_code == 200
    assert (campaign / "new.csv").read_bytes() == b"time_s\n1\n"
    (campaign / "new.csv").unlink()


def test_upload_with_a_used_name_keeps_both_contents(session: Session, tmp_path: Path) -> None:
    """The same content is stored once; other content is given a number."""
    session.folder = Folder.of(tmp_path)
    client = client_of(session)

    def stored(content: bytes) -> str:
        answer = client.post("/api/upload?name=log.csv", content=content)
        return str(answer.json()["file"])

    first, second = b"time_s\n1\n", b"time_s\n2\n"
    names = [stored(content) for content in (first, first, second, second)]
    assert names == ["log.csv", "log.csv", "log_2.csv", "log_2.csv"]
    contents = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    assert contents == {"log.csv": first, "log_2.csv": second}


def test_upload_does_not_write_through_a_link_that_leads_outside(
    session: Session, tmp_path: Path
) -> None:
    inside, secret = tmp_path / "inside", tmp_path / "secret.csv"
    inside.mkdir()
    secret.write_bytes(b"secret")
    (inside / "log.csv").symlink_to(secret)
    session.folder = Folder.of(inside)
    answer = client_of(session).post("/api/upload?name=log.csv", content=b"time_s\n1\n")
    assert answer.status_code == 422
    assert secret.read_bytes() == b"secret"
    assert [path.name for path in inside.iterdir()] == ["log.csv"]


OUTSIDE = ("../secret.toml", "/etc/passwd", "link/rig.toml")


@pytest.fixture
def link(campaign: Path) -> Iterator[None]:
    """A link to an outside folder with a secret file, and a secret file next to the folder."""
    outside = campaign.parent / "outside"
    outside.mkdir(exist_ok=True)
    for file in (outside / "rig.toml", campaign.parent / "secret.toml"):
        file.write_text("secret = 1\n")
    (campaign / "link").symlink_to(outside)
    yield
    (campaign / "link").unlink()


def assert_path_is_refused(client: TestClient, address: str, request: dict[str, object]) -> None:
    answer = client.post(f"/api/{address}", json=request)
    assert answer.status_code == 422
    error = answer.json()["error"]
    assert "not a name in the folder" in error or "does not exist" in error
    assert "secret" not in error.replace("secret.toml", "")


@pytest.mark.usefixtures("link")
@pytest.mark.parametrize("name", [*OUTSIDE, "..%2fsecret.toml"])
@pytest.mark.parametrize("address", ["open", "look", "try", "import"])
def test_path_outside_the_folder_is_refused(client: TestClient, name: str, address: str) -> None:
    text = '[columns]\ntime_s = "`t`"\n'
    names = {"rig": name, "runs": [name], "file": name, "files": [name]}
    assert_path_is_refused(client, address, {**names, "into": "new", "map": text})


@pytest.mark.usefixtures("link")
@pytest.mark.parametrize("name", OUTSIDE)
@pytest.mark.parametrize("address", ["try", "import"])
def test_map_that_names_an_outside_file_is_refused(
    client: TestClient, campaign: Path, name: str, address: str
) -> None:
    run = next(path.name for path in campaign.glob("*.csv"))
    text = f'[columns]\ntime_s = "`time_s`"\n[cut]\nfile = "{name}"\n'
    assert_path_is_refused(client, address, {"files": [run], "map": text, "into": "new"})
    text = f'[file]\nbeside = ["{name}"]\n[columns]\ntime_s = "`time_s`"\n'
    assert_path_is_refused(client, address, {"files": [run], "map": text, "into": "new"})


@pytest.mark.parametrize(
    "path",
    ["/static/../app.py", "/static/%2e%2e/app.py", "/vendored/..%2fapp.py", "/vendored/guard.py"],
)
def test_source_files_are_not_served_through_static_paths(client: TestClient, path: str) -> None:
    assert client.get(path).status_code == 404


Message = MutableMapping[str, Any]


async def request(app: Starlette, target: str, messages: list[Message]) -> int:
    """Status of a POST request whose client sends these messages, without a server."""
    path, _, query = target.partition("?")
    headers = {"host": OWN, "x-jbf-token": TOKEN}
    scope = {
        "type": "http", "method": "POST", "path": path, "raw_path": path.encode(),
        "query_string": query.encode(), "root_path": "", "scheme": "http",
        "headers": [(k.encode(), v.encode()) for k, v in headers.items()],
    }  # fmt: skip
    sent: list[Message] = []

    async def receive() -> Message:
        return messages.pop(0)

    async def send(message: Message) -> None:
        sent.append(message)

    await app(scope, receive, send)
    return int(sent[0]["status"])


def test_cancelled_upload_leaves_no_file(session: Session, campaign: Path) -> None:
    """The client disconnects between two blocks of the body."""
    messages: list[Message] = [
        {"type": "http.request", "body": b"time_s\n", "more_body": True},
        {"type": "http.disconnect"},
    ]
    app = create_app(session, TOKEN, PORT)
    assert asyncio.run(request(app, "/api/upload?name=half.csv", messages)) == 400
    assert not [path for path in campaign.iterdir() if "half.csv" in path.name]


def test_request_that_runs_when_the_server_stops_is_answered(
    session: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun, stopped = threading.Event(), threading.Event()

    def long_action(*_: object) -> None:
        begun.set()
        stopped.wait(60.0)

    monkeypatch.setitem(actions.COMMANDS, "look", long_action)
    app = create_app(session, TOKEN, PORT)

    async def stop_during_request() -> int:
        body: list[Message] = [{"type": "http.request", "body": b"{}"}]
        task = asyncio.create_task(request(app, "/api/look", body))
        while not begun.is_set():
            await asyncio.sleep(0.01)
        task.cancel()
        try:
            return await task
        finally:
            stopped.set()

    assert asyncio.run(stop_during_request()) == 503
