"""Settings of a linkage's parts as plain numbers, with the printer's presets behind them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final, Literal

from ddgfab.errors import InputError
from fabrication.standards.printers import Printer, printer

PinKind = Literal["metal", "printed"]
LabelStyle = Literal["engraved", "embossed", "none"]


BAR: Final = 5.0
"""Width and height [mm] of bars when none is given."""

BEVEL: Final = 0.2
"""Bevel of bars as a part of their smaller side: the corners then fit eyes 6 mm high at any twist,
and the flat sides still take letters of 4 mm."""


ROUNDING: Final = 1e-9
"""A wall [mm] may miss its limit by this much: sums of decimal numbers are not exact."""


@dataclass(frozen=True)
class LinkageSettings:
    """Numbers of a linkage's parts [mm]; make them with `settings_for`, which knows the printer.

    Attributes
    ----------
    printer : what makes the parts: limits on walls, strokes and bores, and the coupon
    pin : a rod of metal with two printed caps, or a printed pin with a head and one cap
    pin_diameter : of the pins
    clearance : between pin and bore, a side
    axial_gap : between neighbours on a pin
    press : between pin and the bore of a cap, a side
    eye_diameter, eye_height : of the eyes
    bar_width, bar_height, bevel : of the bars' section; the bevel is taken off its four corners
    cap_diameter, cap_grip, cap_floor : of the caps, how much of the pin they hold, and their end
    head_height : of a printed pin's head, which has the diameter of the caps
    label : how part numbers are written on the links
    label_depth : of engraved text, or how far embossed text stands out
    coupon : whether the kit holds a clearance coupon and its test pin
    max_levels : most levels along a hinge
    """

    printer: Printer
    pin: PinKind
    pin_diameter: float
    clearance: float
    axial_gap: float
    press: float
    eye_diameter: float
    eye_height: float
    bar_width: float
    bar_height: float
    bevel: float
    cap_diameter: float
    cap_grip: float
    cap_floor: float
    head_height: float
    label: LabelStyle
    label_depth: float
    coupon: bool
    max_levels: int

    @property
    def bore(self) -> float:
        """Diameter of the eyes' bores."""
        return self.pin_diameter + 2.0 * self.clearance

    @property
    def pitch(self) -> float:
        """Distance of neighbouring levels along a hinge."""
        return self.eye_height + self.axial_gap


def settings_for(
    printer_key: str = "fdm-0.4", pin: PinKind = "metal", **given: Any
) -> LinkageSettings:
    """Settings for a printer; everything given replaces the default.

    Raises
    ------
    ProjectError
        An unknown printer.
    InputError
        An unknown name, or a number that is not positive where it has to be.
    """
    preset = printer(printer_key)
    given = {name: value for name, value in given.items() if value is not None}
    diameter = given.get("pin_diameter", preset.metal_pin if pin == "metal" else preset.printed_pin)
    bar = min(given.get("bar_width", BAR), given.get("bar_height", BAR))
    defaults: dict[str, Any] = {
        "pin_diameter": diameter,
        "clearance": preset.clearance,
        "axial_gap": preset.axial_gap,
        "press": preset.press,
        "eye_diameter": 10.0,
        "eye_height": 6.0,
        "bar_width": BAR,
        "bar_height": BAR,
        "bevel": BEVEL * bar,
        "cap_diameter": max(6.0, diameter + 2.0 * preset.press + 2.4 * preset.wall),
        "cap_grip": 3.0,
        "cap_floor": 1.2,
        "head_height": 2.0,
        "label": "engraved",
        "label_depth": preset.text_depth,
        "coupon": True,
        "max_levels": 6,
    }
    unknown = [name for name in given if name not in defaults]
    if unknown:
        raise InputError(f'there is no setting "{unknown[0]}"; known: {", ".join(defaults)}')
    settings = LinkageSettings(printer=preset, pin=pin, **(defaults | given))
    check_settings(settings)
    return settings


def check_settings(settings: LinkageSettings) -> None:
    """Raise `InputError` where the numbers of the parts contradict each other or the printer."""
    s, limits = settings, settings.printer
    for name in (
        "pin_diameter", "clearance", "axial_gap", "eye_diameter", "eye_height", "bar_width",
        "bar_height", "cap_diameter", "cap_grip", "cap_floor", "head_height", "label_depth",
    ):  # fmt: skip
        if not 0.0 < getattr(s, name) < math.inf:
            raise InputError(f"{name} is {getattr(s, name):g} mm; it must be positive")
    for name in ("press", "bevel"):
        if not 0.0 <= getattr(s, name) < math.inf:
            raise InputError(f"{name} is {getattr(s, name):g} mm; it cannot be negative")
    if s.max_levels < 1:
        raise InputError(f"max_levels is {s.max_levels}; bars need one level or more")
    wall = 0.5 * (s.eye_diameter - s.bore)
    if wall < limits.wall - ROUNDING:
        most = s.eye_diameter - 2.0 * (limits.wall + s.clearance)
        raise InputError(
            f"a pin of {s.pin_diameter:g} mm in a bore of {s.bore:g} mm leaves a wall of "
            f"{wall:.3g} mm in an eye of {s.eye_diameter:g} mm; limit {limits.wall:g} mm "
            f"({limits.name}):\nuse a pin of {most:.3g} mm or less, or larger eyes"
        )
    if s.pin == "printed" and s.pin_diameter < limits.printed_pin:
        raise InputError(
            f"a printed pin of {s.pin_diameter:g} mm breaks; limit {limits.printed_pin:g} mm "
            f"({limits.name})"
        )
    if s.bore < limits.hole:
        raise InputError(
            f"a bore of {s.bore:g} mm closes when printed; limit {limits.hole:g} mm ({limits.name})"
        )
    wall = 0.5 * (s.cap_diameter - s.pin_diameter) - s.press
    if min(wall, s.cap_floor) < limits.wall:
        raise InputError(
            f"the caps' wall of {wall:.3g} mm and floor of {s.cap_floor:g} mm must be "
            f"{limits.wall:g} mm or more ({limits.name})"
        )
    if s.cap_diameter < s.bore + limits.wall:
        raise InputError(
            f"caps of {s.cap_diameter:g} mm do not hold eyes with bores of {s.bore:g} mm; make "
            f"them {s.bore + limits.wall:g} mm or more"
        )
    if s.cap_diameter > s.eye_diameter:
        raise InputError(
            f"caps of {s.cap_diameter:g} mm are wider than the eyes of {s.eye_diameter:g} mm, and "
            f"bars would meet them; make the eyes larger"
        )
    thin = min(s.bar_width, s.bar_height - (s.label_depth if s.label == "engraved" else 0.0))
    if thin < limits.wall:
        raise InputError(
            f"bars of {s.bar_width:g} x {s.bar_height:g} mm leave {thin:.3g} mm"
            + (f" under letters {s.label_depth:g} mm deep" if s.label == "engraved" else "")
            + f"; limit {limits.wall:g} mm ({limits.name})"
        )
