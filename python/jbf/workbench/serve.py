"""Start of the workbench server on the loopback interface, with an access token."""

from __future__ import annotations

import secrets
import signal
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from jbf.errors import InputError
from jbf.workbench import vendored
from jbf.workbench.files import Folder
from jbf.workbench.session import Session
from jbf.workbench.session_file import keep, load, save_changes

if TYPE_CHECKING:
    import uvicorn

HOST = "127.0.0.1"


def listening(port: int) -> socket.socket:
    """Open a socket on the loopback interface; port 0 selects a free port.

    Raises
    ------
    InputError
        The port is in use.
    """
    listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listener.bind((HOST, port))
        listener.listen()
    except (OSError, OverflowError) as error:
        listener.close()
        problem = f"port {port} is not available ({error})"
        raise InputError(
            file="--port", problem=problem, remedy="omit it: a free port is used"
        ) from None
    return listener


@contextmanager
def _ended_by_signals(server: uvicorn.Server) -> Iterator[None]:
    """Stop the server at SIGTERM or SIGHUP; then raise `SystemExit` with 128 + the first signal.

    A second signal stops it without waiting for requests. The handler itself does not raise: the
    exception would appear wherever the event loop happens to be, and a request could catch it.
    """
    received: list[int] = []

    def end(number: int, _: object) -> None:
        server.force_exit = bool(received)
        received.append(number)
        server.should_exit = True

    names = ("SIGTERM", "SIGHUP") if threading.current_thread() is threading.main_thread() else ()
    numbers = [number for name in names if (number := getattr(signal, name, None)) is not None]
    # A signal that is ignored (nohup) remains ignored.
    handled = [n for n in numbers if signal.getsignal(n) is signal.SIG_DFL]
    for number in handled:
        signal.signal(number, end)
    try:
        yield
    finally:
        for number in handled:
            signal.signal(number, signal.SIG_DFL)
    if received:
        raise SystemExit(128 + received[0])


def _saved(session: Session) -> list[str]:
    """Save the changes of a session; return sentences about this and about the running fit."""
    job, sentences = session.jobs.job, []
    if job is not None and job.kind != "compare":
        sentences.append(f"{job.words}: cancelled.")
    try:
        path = save_changes(session)
    except InputError as error:
        return [*sentences, f"The session was not saved: {error}."]
    if path is not None:
        sentences.append(f"Session saved: {path}. jbf workbench {path.parent} continues it.")
    return sentences


def serve(
    folder: str,
    port: int,
    opened: Callable[[str], None],
    ended: Callable[[str], None],
    *,
    demo: bool = False,
) -> None:
    """Serve the workbench page for a folder until Ctrl-C, then save the session.

    SIGTERM and SIGHUP end it as well, with `SystemExit`.

    Parameters
    ----------
    folder, port
        Folder of the session, and port of the server; 0 selects a free one.
    opened
        Called with the address of the page.
    ended
        Called with each sentence about the saved session and a cancelled fit.
    demo
        Whether the sample of a bearing is opened instead of the saved session, which is kept.

    Raises
    ------
    InputError
        The folder does not exist, the port is in use, or a required package is not installed.
    """
    try:
        import uvicorn

        from jbf.workbench.app import create_app
        from jbf.workbench.samples import open_sample
    except ImportError:
        remedy = 'pip install "jbf[workbench]"'
        raise InputError(problem="Starlette or uvicorn is not installed", remedy=remedy) from None
    if not vendored.is_complete():
        remedy = "python -m jbf.workbench.vendored (once, with a network)"
        raise InputError(problem=f"{vendored.NAME} was not fetched at build time", remedy=remedy)
    listener = listening(port)
    session = Session(Folder.of(folder))
    try:
        if demo:
            keep(session)
            open_sample(session, "bearing")
        else:
            load(session)
        token = secrets.token_urlsafe(24)
        at = listener.getsockname()[1]
        config = uvicorn.Config(
            create_app(session, token, at),
            log_level="warning",
            lifespan="off",
            timeout_graceful_shutdown=1,
        )
        server = uvicorn.Server(config)
        try:
            with _ended_by_signals(server):
                # The fragment of an address is sent to no server and appears in no log.
                opened(f"http://{HOST}:{at}/#token={token}")
                server.run(sockets=[listener])
        finally:
            for sentence in _saved(session):
                ended(sentence)
    finally:
        session.close()
        listener.close()
