"""Run the command line: ``python -m rssnav``."""

from rssnav.cli import app

app(prog_name="rssnav")
