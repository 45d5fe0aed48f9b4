"""Sections that lists for shops are made with: the stock that bars are cut from."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, field_validator

from fabrication.cutting import Stock
from fabrication.project.sections import NotNegative, Positive, Section


class StockSettings(Section):
    """[stock]: what bars are cut from, for the cut list.

    Attributes
    ----------
    length_mm : of the bars that can be had
    kerf_mm : what a cut takes
    trim_mm : cut off each end of a bar before pieces are
    """

    length_mm: Annotated[tuple[Positive, ...], Field(strict=False, min_length=1, max_length=20)] = (
        6000.0,
        12000.0,
    )
    kerf_mm: NotNegative = 3.0
    trim_mm: NotNegative = 10.0

    @field_validator("length_mm")
    @classmethod
    def _ascending(cls, value: tuple[float, ...]) -> tuple[float, ...]:
        return tuple(sorted(set(value)))

    def stock(self) -> Stock:
        """The stock itself."""
        return Stock(self.length_mm, self.kerf_mm, self.trim_mm)
