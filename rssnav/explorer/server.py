"""The server: one application, a session per tab, and a list of allowed origins."""

import asyncio
import logging
import signal
import socket
from collections.abc import Callable, Generator, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from functools import partial
from ipaddress import ip_address
from typing import Any

import panel as pn
from panel.io.resources import get_dist_path
from panel.io.server import Server
from tornado.websocket import WebSocketClosedError

from floorplans import FloorPlan
from rssnav.explorer.fair_turns import FairTurns
from rssnav.explorer.limits import Limits
from rssnav.explorer.page import POLL_MS, Frame, Page
from rssnav.explorer.session import Session
from rssnav.explorer.tracing import MapCache
from rssnav.explorer.websockets import guard_websockets, lock_documents

LOGGER = logging.getLogger(__name__)

LOOPBACK = "127.0.0.1"
_LOOPBACK_NAMES = (LOOPBACK, "localhost")
UNUSED_MS = 2000
"""Time after which the session of a closed tab ends [ms]."""


@dataclass(frozen=True)
class ServerSettings:
    """Address of the explorer, and who may open it.

    Attributes
    ----------
    port : int
        Port; 0 for any free one.
    address : str
        Address of the interface to listen on.
    origins : tuple of str
        Further hosts, as HOST or HOST:PORT, under which browsers may open the page.
    show : bool
        Whether to open a browser.
    limits : Limits
        Limits on uploads, plans and maps.
    """

    port: int = 5006
    address: str = LOOPBACK
    origins: tuple[str, ...] = ()
    show: bool = True
    limits: Limits = field(default_factory=Limits)


def serve(plan: FloorPlan, settings: ServerSettings, ready: Callable[[str], None]) -> None:
    """Serve the explorer until interrupted.

    Parameters
    ----------
    plan : FloorPlan
        The plan of a new tab.
    settings : ServerSettings
    ready : callable
        Called with the page's address once the server is about to listen.

    Raises
    ------
    OSError
        When it cannot listen on the address and port.
    """
    port = _free_port(settings.address, settings.port)
    pn.extension("filedropper", notifications=False)
    pn.config.exception_handler = _log_briefly
    guard_websockets(settings.limits)
    lock_documents()
    names = host_names(settings.address)
    ready(f"http://{names[0]}:{port}/")
    with _own_interrupts():
        server = pn.serve(
            {"/": Tabs(plan, settings.limits).page},
            port=port,
            address=settings.address,
            websocket_origin=[
                *(f"{name}:{port}" for name in names),
                *with_port(settings.origins, port),
            ],
            websocket_max_message_size=settings.limits.upload_bytes + settings.limits.message_bytes,
            unused_session_lifetime_milliseconds=UNUSED_MS,
            check_unused_sessions_milliseconds=UNUSED_MS // 2,
            title="rssnav explorer",
            show=settings.show,
            start=False,
            verbose=False,
        )
    assert isinstance(server, Server)
    server.start()
    server.io_loop.start()


@contextmanager
def _own_interrupts() -> Generator[None]:
    """Keep the handler of Ctrl-C; the one that Panel installs stops with exit code 0."""
    handler = signal.getsignal(signal.SIGINT)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, handler)


class Tabs:
    """The open tabs: a session for each browser that has connected.

    Parameters
    ----------
    plan : FloorPlan
        The plan of a new tab.
    limits : Limits
    """

    def __init__(self, plan: FloorPlan, limits: Limits) -> None:
        self._plan, self._limits = plan, limits
        self._cache = MapCache()
        self._turns = FairTurns(limits.jobs)
        self._n_open = 0

    def page(self) -> pn.Template:
        """Return an empty page that is filled when its browser connects."""
        asyncio.get_running_loop().set_exception_handler(_report)
        document = pn.state.curdoc
        assert document is not None
        # Panel tells it to the session of the request, which a slow browser comes too late for.
        document.template_variables.setdefault("dist_url", get_dist_path(cdn=False))
        frame = Frame()
        pn.state.onload(partial(self._open, frame))
        return frame.template

    def _open(self, frame: Frame) -> None:
        """Open a session and show it, unless too many are open."""
        if self._n_open >= self._limits.tabs:
            frame.refuse(
                f"{self._n_open} tabs are open, the maximum of this explorer: close one, "
                "then reload this page"
            )
            return
        session = Session(self._plan, self._limits, self._cache, self._turns)
        self._n_open += 1
        pn.state.on_session_destroyed(lambda _context: self._close(session))
        page = Page(session)
        document = pn.state.curdoc
        assert document is not None
        with document.models.freeze():
            page.fill(frame)
        pn.state.add_periodic_callback(page.refresh, POLL_MS)

    def _close(self, session: Session) -> None:
        session.close()
        self._n_open -= 1


def _report(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
    """Report errors between requests, except that a tab was closed during a message."""
    if not isinstance(context.get("exception"), WebSocketClosedError):
        loop.default_exception_handler(context)


def _log_briefly(error: Exception) -> None:
    """Log an error of a widget on one line: whatever a browser sends must not flood the log."""
    LOGGER.error("a change of the page failed: %s: %.200s", type(error).__name__, error)
    LOGGER.debug("the change that failed", exc_info=error)


def host_names(address: str) -> tuple[str, ...]:
    """Names under which a browser may reach an address.

    The address of all interfaces has the machine's name and those of loopback; other names must be
    allowed one by one.
    """
    try:
        parsed = ip_address(address)
    except ValueError:
        return _LOOPBACK_NAMES if address == "localhost" else (address,)
    if parsed.is_loopback:
        return _LOOPBACK_NAMES
    if parsed.is_unspecified:
        return (socket.gethostname(), *_LOOPBACK_NAMES)
    return (address,)


def with_port(origins: Sequence[str], port: int) -> list[str]:
    """Add the port to hosts without one."""
    return [name if ":" in name else f"{name}:{port}" for name in origins]


def _free_port(address: str, port: int) -> int:
    """Check that a port is free; for 0, find a free one."""
    try:
        family, _, _, _, place = socket.getaddrinfo(address, port, type=socket.SOCK_STREAM)[0]
        with closing(socket.socket(family, socket.SOCK_STREAM)) as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(place)
            return int(probe.getsockname()[1])
    except UnicodeError as error:  # a name that is none: too long, or with an empty part
        raise OSError(f"cannot listen on {address:.200}: expected an address or a name") from error
    except OSError as error:
        raise OSError(
            f"cannot listen on {address} port {port}: {error.strerror}; choose another with --port"
        ) from error
