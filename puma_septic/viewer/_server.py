"""One page, served to this machine and nobody else."""

from __future__ import annotations

import threading
from dataclasses import dataclass
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any, ClassVar, Final, final

from puma_septic.errors import InputError
from puma_septic.validation import checked_whole

__all__ = ["PageServer", "serve_page"]

_ADDRESS: Final = "127.0.0.1"
# A connection that says nothing for this long is dropped, s.
_PATIENCE: Final = 10.0


class _Server(ThreadingHTTPServer):
    daemon_threads = True
    block_on_close = False

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A browser that goes away in the middle of an answer is nobody's error."""


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class PageServer:
    """A running server; see `serve_page`.

    Attributes
    ----------
    port : int
    """

    port: int
    _server: ThreadingHTTPServer
    _thread: threading.Thread

    @property
    def url(self) -> str:
        """Where the page is, for a browser on this machine."""
        return f"http://{_ADDRESS}:{self.port}/"

    def close(self) -> None:
        """Stop serving and free the port; a page that is open stays usable. More than once does no harm."""
        if self._thread.is_alive():
            self._server.shutdown()
            self._thread.join()
        self._server.server_close()

    def wait(self) -> None:
        """Serve until the process is interrupted (Ctrl-C) or `close` is called elsewhere; then stop."""
        try:
            while self._thread.is_alive():
                self._thread.join(0.2)  # a join without end could not be interrupted on every system
        except KeyboardInterrupt:
            pass
        finally:
            self.close()


def serve_page(html: str, *, port: int | None = None) -> PageServer:
    """Serve one page from a thread of this process, which does not keep the process alive.

    It listens on 127.0.0.1 only, so no other machine reaches it, and it refuses (403) every request whose Host is
    not this address or whose Origin is another site: a page on the web whose name is made to point here gets nothing.

    Parameters
    ----------
    port : int, optional
        Wanted; where it is taken, or by default, the system chooses a free one.

    Raises
    ------
    InputError
        For a number that is no port, or where no port can be opened at all.
    """
    wanted = 0 if port is None else checked_whole("port", port, at_least=0, at_most=65535)
    server = _listening(_handler(html.encode()), wanted)
    thread = threading.Thread(target=server.serve_forever, args=(0.05,), name="puma-septic replay", daemon=True)
    thread.start()
    return PageServer(port=int(server.server_address[1]), _server=server, _thread=thread)


def _listening(handler: type[BaseHTTPRequestHandler], port: int) -> ThreadingHTTPServer:
    for candidate in dict.fromkeys((port, 0)):
        try:
            return _Server((_ADDRESS, candidate), handler)
        except OSError as error:
            reason = error
    raise InputError(f"no port of {_ADDRESS} can be opened: {reason}") from reason


_HEADERS: Final = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "frame-ancestors 'none'",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
}


def _handler(page: bytes) -> type[BaseHTTPRequestHandler]:
    class Handler(BaseHTTPRequestHandler):
        timeout = _PATIENCE
        server_version, sys_version = "puma-septic", ""
        body: ClassVar[bytes] = page

        def do_GET(self) -> None:
            status, body = self._answer()
            self.send_response(status)
            self.send_header("Content-Type", "text/html; charset=utf-8" if status == HTTPStatus.OK else "text/plain")
            self.send_header("Content-Length", str(len(body)))
            for name, value in _HEADERS.items():
                self.send_header(name, value)
            self.end_headers()
            if self.command == "GET":
                self.wfile.write(body)

        do_HEAD = do_GET  # noqa: N815

        def _answer(self) -> tuple[HTTPStatus, bytes]:
            port = self.connection.getsockname()[1]
            names = (_ADDRESS, "localhost")
            hosts = [f"{name}:{port}" for name in names] + (list(names) if port == 80 else [])
            origins = self.headers.get_all("Origin", [])
            if self.headers.get_all("Host", []) not in [[host] for host in hosts]:
                return HTTPStatus.FORBIDDEN, b"403: this replay is shown on its own machine only\n"
            if origins and origins not in [[f"http://{host}"] for host in hosts]:
                return HTTPStatus.FORBIDDEN, b"403: this replay is not shown to other sites\n"
            if self.path.partition("?")[0] != "/":
                return HTTPStatus.NOT_FOUND, b"404: the only page is /\n"
            return HTTPStatus.OK, self.body

        def log_message(self, format: str, *args: Any) -> None:
            """Say nothing: a library does not print."""

    return Handler
