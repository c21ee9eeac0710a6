"""Connections whose session has ended before them."""

from bokeh.server.connection import ServerConnection

from rssnav.explorer.websockets import GuardedHandler


class Application:
    """Notes the connections that are lost."""

    def __init__(self) -> None:
        self.lost: list[ServerConnection] = []

    def client_lost(self, connection: ServerConnection) -> None:
        self.lost.append(connection)


def test_a_connection_is_forgotten_after_its_session() -> None:
    application = Application()
    handler = object.__new__(GuardedHandler)
    connection = object.__new__(ServerConnection)
    connection._session = None
    handler.connections, handler.connection = {handler}, connection
    handler.application, handler.close_code, handler.close_reason = application, 1006, None
    handler.on_close()
    assert application.lost == [connection]
    assert not handler.connections
