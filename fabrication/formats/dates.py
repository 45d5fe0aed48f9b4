"""The date that files carry: that of SOURCE_DATE_EPOCH, never the clock's."""

from __future__ import annotations

import os
from datetime import datetime, timedelta
from typing import Final

LAST_SECOND: Final = 253_402_300_799
"""Of the year 9999, after 1970."""


def epoch_time() -> datetime | None:
    """The time (UTC) of SOURCE_DATE_EPOCH; None where it is not set, or no time."""
    seconds = os.environ.get("SOURCE_DATE_EPOCH", "")
    if not seconds.isdecimal() or int(seconds) > LAST_SECOND:
        return None
    return datetime(1970, 1, 1) + timedelta(seconds=int(seconds))
