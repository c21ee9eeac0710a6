"""Messages from the browser: only those that the page sends, and not larger than they can be."""

import logging
from typing import Any

from bokeh.protocol.exceptions import ProtocolError
from bokeh.protocol.message import Message
from bokeh.server.urls import per_app_patterns
from panel.io.server import WSHandler

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
LOGGED = 300
"""Maximum length of a log line about a message."""


def guard_websockets(limits: Limits) -> None:
    """Make servers started from now on refuse other messages than the page's."""

    class Handler(GuardedHandler):
        pass

    Handler.limits = limits
    for index, (route, handler, *_) in enumerate(per_app_patterns):
        if issubclass(handler, WSHandler):
            per_app_patterns[index] = (route, Handler)
    for name in ("bokeh.server.views.ws", "bokeh.server.protocol_handler"):
        logging.getLogger(name).addFilter(shorten)


class GuardedHandler(WSHandler):
    """A websocket of a tab that closes on messages that the page does not send.

    Attributes
    ----------
    limits : Limits
    """

    limits: Limits
    _n_bytes = 0

    def open(self, *args: str, **kwargs: str) -> None:
        """Open a connection; close it at once for a token that the server has not made."""
        try:
            super().open(*args, **kwargs)
        except (ProtocolError, ValueError, KeyError) as error:
            LOGGER.error("refused a websocket: %s", type(error).__name__)
            self.close()

    async def on_message(self, fragment: str | bytes) -> None:
        """Handle a fragment of a message; close once the message is too large for an upload."""
        self._n_bytes += len(fragment)
        if self._n_bytes > self.limits.upload_bytes + self.limits.message_bytes:
            self._protocol_error("the message is too large")
        elif self.close_code is None:
            await super().on_message(fragment)

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
