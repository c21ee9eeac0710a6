"""A server of the explorer, and a client that sends it raw messages of the Bokeh protocol."""

from __future__ import annotations

import asyncio
import json
import re
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from bokeh.protocol import Protocol
from bokeh.protocol.receiver import Receiver
from tornado.httpclient import HTTPRequest
from tornado.websocket import WebSocketClosedError, websocket_connect

PATIENCE_S = 60.0
COMMAND = [sys.executable, "-m", "rssnav", "explore", "flat", "--port", "0", "--no-browser"]
WITH_FEW_PAGES = [
    sys.executable,
    "-c",
    """
import sys

import floorplans
from rssnav.explorer.limits import Limits
from rssnav.explorer.server import ServerSettings, serve

def ready(address):
    print(address, file=sys.stderr, flush=True)

settings = ServerSettings(0, show=False, limits=Limits(pages=5))
serve(floorplans.load("flat"), settings, ready)
""",
]
"""A server of at most five pages."""


class Server:
    """A running explorer.

    Attributes
    ----------
    address : str
        Of its page, such as http://127.0.0.1:5006/.
    log : Path
        What it has written.
    """

    def __init__(self, process: subprocess.Popen[bytes], log: Path) -> None:
        self.process, self.log = process, log
        self.address = ""

    def get(self, path: str = "") -> str:
        with urllib.request.urlopen(self.address + path, timeout=PATIENCE_S) as answer:
            return answer.read().decode()

    def token(self) -> str:
        """A token of a new page."""
        return re.search(r'"token":"([^"]+)"', self.get()).group(1)

    def _status(self, key: str) -> int:
        text = Path(f"/proc/{self.process.pid}/status").read_text(encoding="utf-8")
        return int(re.search(rf"{key}:\s+(\d+)", text).group(1))

    @property
    def memory_bytes(self) -> int:
        return 1024 * self._status("VmRSS")

    @property
    def n_threads(self) -> int:
        return self._status("Threads")

    @property
    def processor_s(self) -> float:
        """Processor time used so far [s]."""
        fields = Path(f"/proc/{self.process.pid}/stat").read_text(encoding="utf-8").split(")")[1]
        return sum(map(int, fields.split()[11:13])) / 100.0


@contextmanager
def running_server(log: Path, command: Sequence[str] = COMMAND) -> Iterator[Server]:
    """A server on any free port, in a process of its own."""
    with log.open("wb") as remarks:
        process = subprocess.Popen(command, stderr=remarks, stdout=remarks)
    server = Server(process, log)
    try:
        ends_s = time.monotonic() + PATIENCE_S
        while not server.address:
            assert time.monotonic() < ends_s, log.read_text(encoding="utf-8")
            found = re.search(r"http://\S+", log.read_text(encoding="utf-8"))
            try:
                if found:
                    urllib.request.urlopen(found.group(), timeout=PATIENCE_S).close()
                    server.address = found.group()
            except OSError:
                pass
            time.sleep(0.1)
        yield server
    finally:
        process.terminate()
        process.wait(timeout=20)


class Client:
    """A connection of a script to the explorer.

    Attributes
    ----------
    models : dict
        Attributes of every model of the page, by id, with its type under "type".
    errors : list of str
        What the server answered to messages that it could not handle.
    """

    def __init__(self, server: Server, loop: asyncio.AbstractEventLoop) -> None:
        self.server, self.loop = server, loop
        self.models: dict[str, dict[str, Any]] = {}
        self.errors: list[str] = []
        self.closed = self.acknowledged = False
        self._receiver = Receiver(Protocol())
        self._socket: Any = None
        self._n_sent = 0

    def open(self, token: str | None = None, **headers: str) -> Client:
        """Connect, and say that the page is ready; wait for its content."""
        self.connect(token, **headers)
        self.pull()
        self.event("document_ready")
        self.until(lambda: self.input("Reflections"))
        return self

    def connect(self, token: str | None = None, **headers: str) -> None:
        """Open the websocket; a header's underscores stand for dashes."""
        names = {name.replace("_", "-"): value for name, value in headers.items()}
        request = HTTPRequest(self.server.address.replace("http", "ws") + "ws", headers=names)
        subprotocols = ["bokeh", token or self.server.token()]

        async def connect() -> Any:
            return await websocket_connect(
                request, subprotocols=subprotocols, max_message_size=100_000_000
            )

        self._socket = self.loop.run_until_complete(connect())
        assert self._socket is not None
        self.until(lambda: self.acknowledged)

    def pull(self) -> None:
        self.send("PULL-DOC-REQ", {})
        self.until(lambda: self.models)

    def send(self, kind: str, content: object, buffers: tuple[bytes, ...] = ()) -> str:
        """Send a message; return its id."""
        self._n_sent += 1
        header = {"msgid": f"{self._n_sent}", "msgtype": kind}
        if buffers:
            header["num_buffers"] = len(buffers)
        for fragment in (header, {}, content):
            self.send_raw(json.dumps(fragment))
        for number, payload in enumerate(buffers):
            self.send_raw(json.dumps({"id": f"b{number}"}))
            self.send_raw(payload)
        return header["msgid"]

    def send_raw(self, fragment: str | bytes) -> None:
        async def write() -> None:
            await self._socket.write_message(fragment, binary=isinstance(fragment, bytes))

        self.loop.run_until_complete(write())

    def change(self, model_id: str, attribute: str, value: object) -> None:
        """Set a property of a model, as a widget in the browser does."""
        event = {
            "kind": "ModelChanged", "model": {"id": model_id}, "attr": attribute, "new": value,
        }  # fmt: skip
        self.send("PATCH-DOC", {"events": [event]})

    def event(
        self, name: str, values: dict[str, Any] | None = None, buffers: tuple[bytes, ...] = ()
    ) -> None:
        """Send an event of the page, such as a click."""
        data = {"type": "event", "name": name, "values": _encoded(values or {})}
        content = {"kind": "MessageSent", "msg_type": "bokeh_event", "msg_data": data}
        self.send("PATCH-DOC", {"events": [content]}, buffers)

    def until(self, condition, patience_s: float = PATIENCE_S) -> Any:
        """Receive messages until a condition holds; return it. Fail if it never does."""
        ends_s = time.monotonic() + patience_s
        while not (found := condition()):
            assert time.monotonic() < ends_s, "waited in vain"
            assert not self.closed, "the server has closed the connection"
            self.receive(0.2)
        return found

    def receive(self, seconds: float) -> None:
        """Take in the messages that arrive within a time."""
        ends_s = time.monotonic() + seconds
        while not self.closed and (left_s := ends_s - time.monotonic()) > 0.0:
            fragment = self.loop.run_until_complete(self._fragment(left_s))
            if fragment == "":
                return
            if fragment is None:
                self.closed = True
                return
            message = self.loop.run_until_complete(self._receiver.consume(fragment))
            if message:
                self._take(message)

    _reading: asyncio.Future[Any] | None = None

    async def _fragment(self, seconds: float) -> str | bytes | None:
        """Next fragment; an empty one if none comes in time, None at the end."""
        if self._reading is None:
            self._reading = asyncio.ensure_future(self._socket.read_message())
        done, _ = await asyncio.wait({self._reading}, timeout=seconds)
        if not done:
            return ""
        self._reading = None
        return done.pop().result()

    def _take(self, message: Any) -> None:
        self.acknowledged |= message.msgtype == "ACK"
        if message.msgtype == "ERROR":
            self.errors.append(message.content["text"])
        content = message.content
        self._note(getattr(content, "content", content))

    def _note(self, part: object) -> None:
        """Collect the models in a part of a message."""
        if isinstance(part, dict):
            if part.get("kind") == "ModelChanged":
                self.models.setdefault(part["model"]["id"], {})[part["attr"]] = part["new"]
            if part.get("type") == "object" and "id" in part:
                kept = self.models.setdefault(part["id"], {})
                kept.update(part.get("attributes", {}), type=part["name"])
            for value in part.values():
                self._note(value)
        elif isinstance(part, list):
            for value in part:
                self._note(value)

    def find(self, kind: str, attribute: str, value: object) -> str:
        """Id of the model of a kind (end of its type) with a value; empty if there is none."""
        for model_id, model in self.models.items():
            if model.get("type", "").endswith(kind) and model.get(attribute) == value:
                return model_id
        return ""

    @property
    def plan_figure(self) -> str:
        """Id of the figure of plan and map."""
        found = self.find("Figure", "match_aspect", True)
        assert found, "the page has no figure of the plan"
        return found

    def input(self, label: str) -> str:
        """Id of the input with a label; empty if there is none."""
        return self.find("", "title", label) or self.find("", "label", label)

    @property
    def texts(self) -> str:
        """All texts that the page shows."""
        return "\n".join(str(model.get("text", "")) for model in self.models.values())

    @property
    def map_summary(self) -> str:
        """The line about the newest map."""
        found = re.search(r"[^<>]*cells, .*traced in [^<]*", self.texts)
        return found.group() if found else ""

    def wait_for_map(self) -> Client:
        self.until(lambda: "traced in" in self.texts and "without diff" not in self.texts)
        return self

    def still_works(self) -> None:
        """Check that another power gives another map."""
        power = self.input("Power [dBm]")
        before, level = self.map_summary, float(self.models[power]["value"])
        self.change(power, "value", level - 1.0 if level > 0.0 else level + 30.0)
        self.models[power]["value"] = level - 1.0
        self.until(lambda: self.map_summary != before)

    def send_until_closed(self, fragments: list[str | bytes]) -> None:
        """Send fragments; the server may close the connection at any of them."""
        try:
            for fragment in fragments:
                self.send_raw(fragment)
        except WebSocketClosedError:
            self.closed = True

    def upload(self, name: str, content: bytes) -> None:
        """Drop a file on the page."""
        dropper = next(k for k, m in self.models.items() if "FileDropper" in m.get("type", ""))
        data = {
            "name": name, "type": "", "chunk": 1, "total_chunks": 1,
            "data": {"type": "bytes", "data": {"id": "b0"}},
        }  # fmt: skip
        values = {"model": {"id": dropper}, "data": _encoded(data)}
        self.event("upload_event", values, (content,))

    def close(self) -> None:
        if self._socket is not None:
            self._socket.close()
            self.receive(1.0)
        self.closed = True


def _encoded(values: dict[str, Any]) -> dict[str, Any]:
    """A dictionary as the protocol writes it."""
    return {"type": "map", "entries": [[name, value] for name, value in values.items()]}


@contextmanager
def clients(server: Server) -> Iterator[Any]:
    """A function that makes clients, which are closed at the end."""
    loop = asyncio.new_event_loop()
    made: list[Client] = []

    def make() -> Client:
        made.append(Client(server, loop))
        return made[-1]

    try:
        yield make
    finally:
        for client in made:
            client.close()
        loop.close()
