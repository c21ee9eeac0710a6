"""Buttons that download a file, which is made when they are clicked."""

from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import panel as pn

from rssnav.explorer.background import SupersededError, TooManyError
from rssnav.explorer.session import Session
from rssnav.explorer.styles import WIDGETS


def written(name: str, save: Callable[[Path], None]) -> bytes:
    """Return the content of a file that a function writes."""
    with TemporaryDirectory(prefix="rssnav-") as folder:
        path = Path(folder) / name
        save(path)
        return path.read_bytes()


class FileButton(pn.widgets.FileDownload):
    """A download button whose callback may return None, which downloads nothing."""

    def _sync_data(self, fileobj: Any) -> None:
        if fileobj is not None:
            super()._sync_data(fileobj)


def file_button(session: Session, label: str, content: Callable[[], bytes]) -> Any:
    """Return a button for a file; its content is made on the session's thread for files."""

    async def made() -> BytesIO | None:
        try:
            return BytesIO(await session.files.make(content))
        except TooManyError as error:
            session.problem = str(error)
        except SupersededError:  # the tab was closed
            pass
        return None

    return FileButton(
        callback=made,
        filename="plan",
        label=label,
        button_type="default",
        stylesheets=WIDGETS,
        sizing_mode="stretch_width",
    )
