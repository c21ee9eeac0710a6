"""Requests of browsers: not too many pages, only messages that the page sends, in good order."""

import asyncio
import logging
import time
from typing import Any

from bokeh.protocol.exceptions import ProtocolError
from bokeh.protocol.message import Message
from bokeh.server.urls import per_app_patterns
from bokeh.server.views.session_handler import SessionHandler
from panel.io.server import WSHandler
from panel.reactive import Syncable
from tornado.web import RequestHandler

from rssnav.explorer.limits import Limits

LOGGER = logging.getLogger(__name__)

MESSAGES = {"PULL-DOC-REQ", "PATCH-DOC", "SERVER-INFO-REQ"}
ATTRIBUTES = {
    "active", "clicks", "collapsed", "data", "direction", "end", "indices", "inner_height",
    "inner_width", "interval", "outer_height", "outer_width", "start", "value", "value_throttled",
    "visible",
}  # fmt: skip
"""Properties that widgets and plots change in the browser."""

UPLOAD = "upload_event"
MOST_REST_S = 1.0
LOGGED = 300
"""Maximum length of a log line about a message."""


def guard_websockets(limits: Limits) -> None:
    """Make servers started from now on refuse too many pages, and other messages than theirs."""
    connections: set[GuardedHandler] = set()
    given = {"limits": limits, "connections": connections}
    for index, (route, handler, *_) in enumerate(per_app_patterns):
        if issubclass(handler, WSHandler):
            guarded: type[RequestHandler] = type("Handler", (GuardedHandler,), given)
        elif issubclass(handler, LimitedPages):
            guarded = type("Handler", (handler,), given)
        elif issubclass(handler, SessionHandler):
            guarded = type("Handler", (LimitedPages, handler), given)
        else:
            continue
        per_app_patterns[index] = (route, guarded)
    for name in ("bokeh.server.views.ws", "bokeh.server.protocol_handler", "panel.reactive"):
        logging.getLogger(name).addFilter(shorten)


def lock_documents() -> None:
    """Make Panel handle quick events under the document's lock.

    It runs an event that follows another change closely without the lock, and what the event then
    changes of the page fails.
    """
    for name in ("_event_coroutine", "_change_coroutine"):
        vars(Syncable)[name].lock = True


def refuse(handler: RequestHandler, count: int, what: str) -> None:
    """Answer a request with 503 and why."""
    handler.set_status(503)
    handler.set_header("Retry-After", "5")
    handler.finish(
        f"{count} {what} are open, the maximum of this explorer: close some, then reload"
    )


class LimitedPages(RequestHandler):
    """A page that is refused while too many are open or being opened."""

    limits: Limits
    application_context: Any

    async def prepare(self) -> None:
        """Refuse the request where a session for it would be one too many."""
        await super().prepare()  # pyright: ignore[reportGeneralTypeIssues]
        n_open = len(self.application_context.sessions)
        if n_open >= self.limits.pages and not self._finished:
            refuse(self, n_open, "pages")


class GuardedHandler(WSHandler):
    """A websocket of a tab that closes on messages that the page does not send.

    Attributes
    ----------
    limits : Limits
    connections : set
        Those that are open.
    """

    limits: Limits
    connections: set["GuardedHandler"]
    _n_bytes = 0

    async def prepare(self) -> None:
        """Refuse a connection that would be one too many."""
        await super().prepare()
        if len(self.connections) >= self.limits.pages and not self._finished:
            refuse(self, len(self.connections), "connections")

    def on_close(self) -> None:
        """Let another one come, also where the session has ended before its connection."""
        self.connections.discard(self)
        try:
            super().on_close()
        except AssertionError:  # as Bokeh says that the connection has no session
            application: Any = self.application
            application.client_lost(self.connection)

    def open(self, *args: str, **kwargs: str) -> None:
        """Open a connection; close it at once for a token that the server has not made."""
        self.connections.add(self)
        try:
            super().open(*args, **kwargs)
        except (ProtocolError, ValueError, KeyError) as error:
            LOGGER.error("refused a websocket: %s", type(error).__name__)
            self.close()

    async def on_message(self, fragment: str | bytes) -> None:
        """Handle a fragment of a message; close once the message is too large for an upload.

        The connection then rests as long as that took, so that one that sends without end leaves
        half of the time to the others.
        """
        self._n_bytes += len(fragment)
        if self._n_bytes > self.limits.upload_bytes + self.limits.message_bytes:
            self._protocol_error("the message is too large")
        elif self.close_code is None:
            begun_s = time.monotonic()
            await super().on_message(fragment)
            await asyncio.sleep(min(time.monotonic() - begun_s, MOST_REST_S))

    async def _handle(self, message: Message[Any]) -> Any | None:
        """Handle a message if the page can have sent it."""
        n_bytes, self._n_bytes = self._n_bytes, 0
        try:
            check_message(message, n_bytes, self.limits)
        except ProtocolError as error:
            self._protocol_error(str(error))
            return None
        return await super()._handle(message)


def check_message(message: Message[Any], n_bytes: int, limits: Limits) -> None:
    """Raise `ProtocolError` for a message that the page does not send."""
    if message.msgtype not in MESSAGES:
        raise ProtocolError(f"{message.msgtype[:LOGGED]} is no message of the page")
    events = message.content.get("events", []) if message.msgtype == "PATCH-DOC" else []
    if not isinstance(events, list) or not all(isinstance(event, dict) for event in events):
        raise ProtocolError("events must be a list of objects")
    if len(events) > limits.events:
        raise ProtocolError(f"{len(events)} events in a message; at most {limits.events}")
    for event in events:
        check_event(event)
    if n_bytes > limits.message_bytes and not _is_upload(events):
        raise ProtocolError(f"{n_bytes} bytes; at most {limits.message_bytes} are accepted")


def check_event(event: dict[str, Any]) -> None:
    """Raise `ProtocolError` for a change of the document that the page does not make."""
    kind, attribute = event.get("kind"), event.get("attr")
    if kind == "MessageSent" or (kind == "ModelChanged" and attribute in ATTRIBUTES):
        return
    raise ProtocolError(f"{kind!r} of {attribute!r} is no change that the page makes"[:LOGGED])


def _is_upload(events: list[dict[str, Any]]) -> bool:
    """Whether the events are one upload."""
    data = events[0].get("msg_data") if len(events) == 1 else None
    return isinstance(data, dict) and data.get("name") == UPLOAD


def shorten(record: logging.LogRecord) -> bool:
    """Shorten a log record about a message, which the browser may have made huge."""
    text = record.getMessage()
    record.msg, record.args = text if len(text) <= LOGGED else f"{text[:LOGGED]} ...", ()
    record.exc_info = record.exc_text = None
    return True
