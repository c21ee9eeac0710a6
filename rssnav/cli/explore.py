"""``rssnav explore``: a page in the browser to move the source and train a UAV."""

import re
from typing import Annotated

import typer

from rssnav.cli.console import note
from rssnav.cli.failures import EXIT_FAILURE, print_error
from rssnav.cli.options import MaxTabMemory, Plan, examples, in_bytes

PORT = 5006
ADDRESS = "127.0.0.1"
ORIGIN = re.compile(r"[\w.-]+(:\d{1,5})?", re.ASCII)
MISSING = 'the explorer needs Panel and Bokeh; install them with `pip install "rssnav[explore]"`'


def add_to(parent: typer.Typer) -> None:
    """Add the command ``explore``."""
    parent.command(
        "explore",
        epilog=examples("rssnav explore", "rssnav explore scenario1 --port 8000 --no-browser"),
    )(explore)


def _check_origin(origin: str) -> str:
    """Check that an origin is HOST or HOST:PORT."""
    if not ORIGIN.fullmatch(origin):
        raise typer.BadParameter(f"{origin!r} is not HOST or HOST:PORT, such as lab.example:5006.")
    return origin


def explore(
    plan: Plan = "flat",
    port: Annotated[
        int,
        typer.Option("--port", metavar="N", min=0, max=65535, help="Port; 0 for any free one."),
    ] = PORT,
    address: Annotated[
        str,
        typer.Option(
            "--address",
            metavar="ADDRESS",
            help="Address to listen on; by default only this computer can open the page.",
        ),
    ] = ADDRESS,
    allow_origin: Annotated[
        list[str] | None,
        typer.Option(
            "--allow-origin",
            metavar="HOST[:PORT]",
            parser=_check_origin,
            help="Another host name under which browsers may open the page; repeatable.",
            show_default=False,
        ),
    ] = None,
    max_memory: MaxTabMemory = None,
    browser: Annotated[
        bool, typer.Option("--browser/--no-browser", help="Open the page in a browser.")
    ] = True,
) -> None:
    """Open the explorer in the browser: move the source, see its map, train a UAV.

    Stop it with Ctrl-C.
    """
    import floorplans

    try:
        from rssnav.explorer.limits import Limits
        from rssnav.explorer.server import ServerSettings, serve
    except ModuleNotFoundError as error:
        if error.name not in ("panel", "bokeh"):
            raise
        print_error(MISSING)
        raise typer.Exit(EXIT_FAILURE) from error
    limits = Limits(trace_bytes=in_bytes(max_memory) or Limits.trace_bytes)
    settings = ServerSettings(port, address, tuple(allow_origin or ()), browser, limits)
    serve(floorplans.load(plan), settings, lambda url: note(f"the explorer is at {url}"))
