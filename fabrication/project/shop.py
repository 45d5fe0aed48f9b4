"""Sections that lists for shops are made with: stock that bars are cut from, and rates of costs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Annotated, Any, Final, Literal

from pydantic import Field, field_validator, model_validator

from fabrication.cutting import Stock
from fabrication.formats.tables import Legend
from fabrication.nesting import SheetStock
from fabrication.project.sections import NotNegative, Positive, Section
from fabrication.standards import stock_size
from fabrication.table import Table

Lengths = Annotated[tuple[Positive, ...], Field(strict=False, min_length=1, max_length=20)]


class StockSettings(Section):
    """[stock]: what bars are cut from, for the cut list.

    Attributes
    ----------
    length_mm : of the bars that can be had; "auto": the usual lengths of the profile up to 12 m
        (standards/profiles.toml), of rods for pins 1 m
    kerf_mm : what a cut takes
    trim_mm : cut off each end of a bar before pieces are
    """

    length_mm: Literal["auto"] | Lengths = "auto"
    kerf_mm: NotNegative = 3.0
    trim_mm: NotNegative = 10.0

    @field_validator("length_mm")
    @classmethod
    def _ascending(cls, value: Any) -> Any:
        return value if value == "auto" else tuple(sorted(set(value)))

    def stock(self, usual: Sequence[float]) -> Stock:
        """The stock itself; `usual` lengths where none are set."""
        lengths = tuple(usual) if self.length_mm == "auto" else self.length_mm
        return Stock(tuple(map(float, lengths)), self.kerf_mm, self.trim_mm)


class GlassStockSettings(StockSettings):
    """[stock]: what bars and glass are cut from, for the cut list and the estimate of glass.

    Attributes
    ----------
    glass_mm : smaller and larger side of the sheets of glass that plies are cut from; "auto": the
        largest sheet of EN 572-2, 3210 x 6000
    glass_trim_mm : cut off each edge of a sheet of glass
    glass_gap_mm : land between two panes on a sheet, to break them out and to grind their edges
    """

    glass_mm: Literal["auto"] | Annotated[tuple[Positive, Positive], Field(strict=False)] = "auto"
    glass_trim_mm: NotNegative = 20.0
    glass_gap_mm: NotNegative = 20.0

    @model_validator(mode="after")
    def _land(self) -> GlassStockSettings:
        small = min(self.glass())
        if 2.0 * self.glass_trim_mm >= small:
            raise ValueError(
                f"glass_trim_mm = {self.glass_trim_mm:g} at both edges leaves nothing of a sheet "
                f"of {small:g} mm; less than {small / 2.0:g}"
            )
        return self

    def glass(self) -> tuple[float, float]:
        """Smaller and larger side [mm] of the sheets of glass."""
        sides = stock_size() if self.glass_mm == "auto" else self.glass_mm
        return min(sides), max(sides)

    def sheet(self) -> SheetStock:
        """The sheets of glass, the larger side along x."""
        small, large = self.glass()
        return SheetStock(large, small, self.glass_trim_mm, self.glass_gap_mm)

    @property
    def glass_is_set(self) -> bool:
        """Whether the project says something of its sheets of glass."""
        return any(key.startswith("glass_") for key in self.changed())


class RateSettings(Section):
    """[rates]: prices for an estimate of the costs, which is made of those that are set.

    Attributes
    ----------
    currency : of the rates
    kg : for a kilogram of what is made of bars or printed
    m2 : for a square metre of panes
    hole : for drilling a hole, or milling the opening behind one
    cut : for sawing one end of a bar
    node : for a node, beside its mass
    """

    currency: Annotated[str, Field(max_length=20)] = "EUR"
    kg: NotNegative | None = None
    m2: NotNegative | None = None
    hole: NotNegative | None = None
    cut: NotNegative | None = None
    node: NotNegative | None = None

    def table(self, quantities: Iterable[tuple[str, str, float]]) -> dict[str, Table]:
        """The table "costs", by name, of what has a rate; none where no rate is set.

        Parameters
        ----------
        quantities : (name of the rate, what it is for, how much)
        """
        rows = []
        for name, item, quantity in quantities:
            rate = getattr(self, name)
            if rate is not None:
                rows.append(
                    {
                        "item": item,
                        "quantity": float(quantity),
                        "unit": UNITS.get(name, "piece"),
                        "rate": rate,
                        "cost": quantity * rate,
                        "currency": self.currency,
                        "basis": ESTIMATE,
                    }
                )
        return {"costs": Table(rows, "costs", COSTS)} if rows else {}


UNITS: Final = {"kg": "kg", "m2": "m2"}
"""Units of the rates; others are for a piece."""

ESTIMATE: Final = "estimate: quantity x rate of the project, no offer"

COSTS: Final = Legend(
    title="Costs: an estimate",
    about="what the rates of the project give: an estimate for comparison, not an offer",
    meanings={
        "item": "what is paid for, rejected pieces included",
        "quantity": "how much of it",
        "unit": "of the quantity",
        "rate": "price of one unit, from [rates] of the project",
        "cost": "quantity times rate",
        "currency": "of rate and cost",
        "basis": "what the number is worth",
    },
    totals=("cost",),
)
