"""Web application of the workbench: routes of the server and their handlers."""

from __future__ import annotations

import asyncio
import json
import secrets
from collections.abc import AsyncIterator, Callable
from importlib.resources import files
from typing import Any

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.middleware import Middleware
from starlette.requests import ClientDisconnect, Request
from starlette.responses import JSONResponse, Response, StreamingResponse
from starlette.routing import Mount, Route
from starlette.staticfiles import StaticFiles

from jbf.errors import JbfError
from jbf.workbench import actions, vendored
from jbf.workbench.guard import LARGEST_UPLOAD, Guard
from jbf.workbench.session import Session

TICK_S = 0.1
"""Interval between checks for changes of the session, s."""
PULSE_S = 10.0
"""Interval without changes after which a comment line is sent, s, to detect a closed page."""

Parameters = dict[str, Any]
Action = Callable[[Session, Parameters], Any]


def create_app(session: Session, token: str, port: int, largest: int = LARGEST_UPLOAD) -> Starlette:
    """Create the web application for a session.

    Parameters
    ----------
    session
        Session that the page displays.
    token
        Secret that each request under `/api/` must contain.
    port
        Port of the server; part of the accepted host names.
    largest
        Maximum size of an upload in bytes.
    """

    def endpoint(action: Action) -> Callable[[Request], Any]:
        """Convert an action of the session to a handler of requests."""

        async def answer(request: Request) -> Response:
            parameters: Parameters = dict(request.query_params)
            if request.method == "POST":
                body = await request.body()
                try:
                    content = json.loads(body or b"{}")
                except ValueError:
                    return _refused("the body is not valid JSON", 400)
                if not isinstance(content, dict):
                    return _refused("the body is not an object", 400)
                parameters = content
            try:
                return await run_in_threadpool(_answered, action, session, parameters)
            except asyncio.CancelledError:  # Ctrl-C during the request
                return _refused("the server has stopped", 503)

        return answer

    async def upload(request: Request) -> Response:
        name = request.query_params.get("name", "")
        try:
            session.folder.check_upload(name)
        except JbfError as error:
            return _refused(str(error))
        part = session.folder.root / f".{name}.{secrets.token_hex(4)}.part"

        def added() -> str:
            with session.lock:
                return session.folder.add(part, name)

        try:
            with part.open("xb") as file:
                async for block in request.stream():
                    file.write(block)
            stored = await run_in_threadpool(added)
        except ClientDisconnect:
            return _refused("the upload was cancelled", 400)
        except JbfError as error:
            return _refused(str(error))
        except OSError as error:
            return _refused(f"{name}: cannot be written ({error.strerror})")
        finally:
            part.unlink(missing_ok=True)
        session.changed()
        return JSONResponse({"file": stored})

    async def events(request: Request) -> Response:
        return StreamingResponse(_news(session, request), media_type="text/event-stream")

    routes = [
        Route("/", _page),
        Route("/api/events", events),
        Route("/api/upload", upload, methods=["POST"]),
        *(Route(f"/api/{n}", endpoint(a)) for n, a in actions.QUERIES.items()),
        *(Route(f"/api/{n}", endpoint(a), methods=["POST"]) for n, a in actions.COMMANDS.items()),
        Mount("/static", StaticFiles(packages=[("jbf.workbench", "static")])),
        Route("/vendored/{name}", _vendored),
    ]
    guard = Middleware(Guard, token=token, port=port, largest=largest)
    return Starlette(routes=routes, middleware=[guard])


def _answered(action: Action, session: Session, parameters: Parameters) -> Response:
    """Response with the result of an action, or with its error."""
    try:
        answer = action(session, parameters)
    except JbfError as error:
        return _refused(str(error))
    except (KeyError, TypeError, ValueError) as error:
        return _refused(f"the request is not valid ({type(error).__name__}: {error})", 400)
    return answer if isinstance(answer, Response) else JSONResponse(answer)


def _refused(words: str, code: int = 422) -> JSONResponse:
    """Response with an error message."""
    return JSONResponse({"error": words}, code)


async def _page(request: Request) -> Response:
    """Response with the page."""
    page = files("jbf.workbench") / "static" / "index.html"
    return Response(page.read_bytes(), media_type="text/html; charset=utf-8")


async def _vendored(request: Request) -> Response:
    """Response with a file of the plot library."""
    file = vendored.file(request.path_params["name"])
    if file is None:
        return _refused("file not found", 404)
    kind = "text/css" if file.suffix == ".css" else "text/javascript"
    return Response(file.read_bytes(), media_type=kind)


async def _news(session: Session, request: Request) -> AsyncIterator[str]:
    """Yield the state as server-sent events whenever it has changed."""
    sent_version, quiet = -1, 0.0
    while not await request.is_disconnected():
        running = session.jobs.job is not None or session.readings.job is not None
        # The elapsed time of a running fit changes as well.
        if session.version != sent_version or (running and quiet >= 1.0):
            sent_version, quiet = session.version, 0.0
            state = await run_in_threadpool(session.to_dict)
            yield f"data: {json.dumps(state)}\n\n"
        elif quiet >= PULSE_S:
            quiet = 0.0
            yield ": still here\n\n"
        quiet += TICK_S
        await asyncio.sleep(TICK_S)
