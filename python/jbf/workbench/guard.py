"""Access control: only the page of this server with its token may send requests.

The loopback interface alone is not an access control: any page in the user's browser can send
requests to the server. A page whose host name is made to resolve to the loopback address (DNS
rebinding) can read the responses. Therefore host name, origin and a secret are checked
independently.
"""

from __future__ import annotations

import secrets
from collections.abc import MutableMapping
from typing import Any

from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

TOKEN = "x-jbf-token"
LARGEST_UPLOAD = 1 << 29
"""Maximum size of a request body, bytes; larger files must be copied manually."""
POLICY = "; ".join(
    [
        "default-src 'none'",
        "script-src 'self'",
        "style-src 'self'",
        "img-src 'self' data: blob:",
        "connect-src 'self'",
        "frame-ancestors 'none'",
        "base-uri 'none'",
        "form-action 'none'",
    ]
)
"""Content Security Policy: the page loads and runs only content of this server."""
HEADERS = {
    "content-security-policy": POLICY,
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "cache-control": "no-store",
}


class TooLarge(Exception):
    """Error for a request body that exceeds the limit."""


class Guard:
    """Middleware that rejects requests of other pages, around the whole application.

    Parameters
    ----------
    app
        Application that handles permitted requests.
    token
        Secret; every path under `/api/` requires it in the header `X-JBF-Token`.
    port
        Port of the server.
    largest
        Maximum size of a request body in bytes.
    """

    def __init__(self, app: ASGIApp, token: str, port: int, largest: int = LARGEST_UPLOAD) -> None:
        self.app, self.token, self.largest = app, token, largest
        self.hosts = {f"127.0.0.1:{port}", f"localhost:{port}"}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request to the application, or reject it."""
        if scope["type"] == "lifespan":
            await self.app(scope, receive, send)
            return
        if scope["type"] != "http":  # web sockets are not used
            await send({"type": "websocket.close", "code": 1008})
            return
        headers = {k.decode("latin-1"): v.decode("latin-1") for k, v in scope["headers"]}
        begun = False

        async def with_headers(message: Message) -> None:
            nonlocal begun
            if message["type"] == "http.response.start":
                begun = True
                extra = [(k.encode(), v.encode()) for k, v in HEADERS.items()]
                message = {**message, "headers": [*message.get("headers", []), *extra]}
            await send(message)

        refusal = self.refusal(scope["path"], headers)
        if refusal is not None:
            code, words = refusal
            await PlainTextResponse(words, code)(scope, receive, with_headers)
            return
        received_bytes = 0

        async def limited() -> MutableMapping[str, Any]:
            nonlocal received_bytes
            message = await receive()
            received_bytes += len(message.get("body", b""))
            if received_bytes > self.largest:
                raise TooLarge
            return message

        try:
            await self.app(scope, limited, with_headers)
        except TooLarge:
            if not begun:
                await PlainTextResponse(self._too_large(), 413)(scope, receive, with_headers)

    def refusal(self, path: str, headers: dict[str, str]) -> tuple[int, str] | None:
        """Status code and reason for the rejection of a request; None for a permitted request."""
        if headers.get("host", "") not in self.hosts:
            return 400, "this server answers to 127.0.0.1 and localhost alone"
        origin = headers.get("origin")
        if origin is not None and origin not in {f"http://{host}" for host in self.hosts}:
            return 403, "requests from other pages are not allowed"
        if headers.get("sec-fetch-site", "none") not in ("same-origin", "none"):
            return 403, "requests from other pages are not allowed"
        given = headers.get(TOKEN, "").encode()
        if path.startswith("/api/") and not secrets.compare_digest(given, self.token.encode()):
            return 403, (
                "the token is missing or wrong: open the address that jbf workbench printed"
            )
        size = headers.get("content-length", "0")
        if not size.isdigit() or int(size) > self.largest:
            return 413, self._too_large()
        return None

    def _too_large(self) -> str:
        return f"more than {self.largest >> 20} MiB: copy the file into the folder manually"
