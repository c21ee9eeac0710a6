"""The server: one application, a session per tab, and a list of allowed origins."""

import asyncio
import socket
from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from ipaddress import ip_address
from typing import Any

import panel as pn
from tornado.websocket import WebSocketClosedError

from floorplans import FloorPlan
from rssnav.explorer.limits import Limits
from rssnav.explorer.page import page_of
from rssnav.explorer.session import Session
from rssnav.explorer.tracing import MapCache

LOOPBACK = "127.0.0.1"
_LOOPBACK_NAMES = (LOOPBACK, "localhost")
_MESSAGE_OVERHEAD = 1_000_000


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
    cache = MapCache()

    def tab() -> pn.Template:
        asyncio.get_running_loop().set_exception_handler(_report)
        session = Session(plan, settings.limits, cache)
        pn.state.on_session_destroyed(lambda _context: session.close())
        return page_of(session, pn.state.add_periodic_callback)

    names = host_names(settings.address)
    ready(f"http://{names[0]}:{port}/")
    pn.serve(
        {"/": tab},
        port=port,
        address=settings.address,
        websocket_origin=[
            *(f"{name}:{port}" for name in names),
            *with_port(settings.origins, port),
        ],
        websocket_max_message_size=2 * settings.limits.upload_bytes + _MESSAGE_OVERHEAD,
        title="rssnav explorer",
        show=settings.show,
        verbose=False,
    )


def _report(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
    """Report errors between requests, except that a tab was closed during a message."""
    if not isinstance(context.get("exception"), WebSocketClosedError):
        loop.default_exception_handler(context)


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
    except OSError as error:
        raise OSError(
            f"cannot listen on {address} port {port}: {error.strerror}; choose another with --port"
        ) from error
