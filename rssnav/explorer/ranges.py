"""Ranges of the numbers on the page, enforced on the server, whatever the browser sends."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Range:
    """Label and range of a number on the page.

    Attributes
    ----------
    label : str
    low, high : float
        Smallest and largest value.
    step : float
        Step of the widget's arrows.
    whole : bool
        Whether only whole numbers are accepted.
    """

    label: str
    low: float
    high: float
    step: float = 1.0
    whole: bool = False

    def check(self, value: object, name: str = "") -> None:
        """Raise ValueError for anything but a number in the range, by its name or the label."""
        kind = int if self.whole else (int, float)
        if isinstance(value, bool) or not isinstance(value, kind):
            what = "a whole number" if self.whole else "a number"
        elif self.low <= value <= self.high:
            return
        else:
            what = f"{self.low:g} to {self.high:g}"
        raise ValueError(f"{name or self.label}: {shortened(value)} must be {what}")


def shortened(value: object, most: int = 40) -> str:
    """Text of a value from the browser, at most a line long."""
    if isinstance(value, int) and abs(value) >= 10**most:
        return "a number of many digits"
    text = repr(value)
    return text if len(text) <= most else f"{text[:most]}..."
