"""A plan's transmitters in TOML: the tables ``[[transmitters]]``."""

from collections.abc import Iterator, Sequence

from floorplans.toml.table import Table
from floorplans.toml.values import toml_number, toml_text
from floorplans.transmitters import PlanTransmitter

TRANSMITTER_KEYS = ("id", "position", "power_dbm", "frequency_hz", "antenna", "direction")


def read_transmitters(plan: Table) -> tuple[PlanTransmitter, ...]:
    """Read the transmitters of a plan's top-level table, in the order of the file."""
    return tuple(_read(row) for row in plan.tables("transmitters", TRANSMITTER_KEYS))


def _read(table: Table) -> PlanTransmitter:
    x, y, z = table.coordinates("position", "xyz")
    return PlanTransmitter(
        table.text("id"),
        (x, y, z),
        table.optional_number("power_dbm"),
        table.optional_number("frequency_hz"),
        table.optional_text("antenna"),
        table.optional_xyz("direction"),
    )


def write_transmitters(transmitters: Sequence[PlanTransmitter]) -> Iterator[str]:
    """Yield a block of TOML for each transmitter."""
    for transmitter in transmitters:
        yield "\n".join(["[[transmitters]]", *_lines(transmitter)])


def _lines(transmitter: PlanTransmitter) -> Iterator[str]:
    yield f"id = {toml_text(transmitter.id)}"
    yield f"position = {_vector(transmitter.position)}"
    for key in ("power_dbm", "frequency_hz"):
        value = getattr(transmitter, key)
        if value is not None:
            yield f"{key} = {toml_number(value)}"
    if transmitter.antenna is not None:
        yield f"antenna = {toml_text(transmitter.antenna)}"
    if transmitter.direction is not None:
        yield f"direction = {_vector(transmitter.direction)}"


def _vector(parts: tuple[float, ...]) -> str:
    return f"[{', '.join(map(toml_number, parts))}]"
