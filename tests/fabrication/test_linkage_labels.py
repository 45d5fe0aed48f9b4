"""Labels on links, the coupon of a kit, settings and printers."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from linkage_cases import kit

from ddgfab.errors import InputError, ProjectError
from fabrication.linkage.coupon import coupon_shape
from fabrication.linkage.labels import label_for
from fabrication.linkage.links import link_checks
from fabrication.linkage.settings import settings_for
from fabrication.parts.coupon import COUPON, CouponShape
from fabrication.parts.link import LinkShape
from fabrication.solids import boundary_of
from fabrication.standards import Printer, printer, printer_keys


def test_labels_are_legible_where_there_is_room_and_can_be_left_out() -> None:
    shape = kit().links[0].shape
    assert shape.label is not None
    assert 5 * shape.label.unit == pytest.approx(4.0)  # letters of 4 mm
    assert shape.label.unit >= settings_for().printer.stroke
    assert all(p.shape.label is None for p in kit(label="none").links)
    raised = kit(label="embossed")
    assert all(p.shape.label.depth < 0 for p in raised.links)


def test_links_report_their_thinnest_places() -> None:
    for piece in kit().links:
        checks = {check.name: (check.value, check.limit) for check in piece.checks}
        assert checks == {"wall_mm": (3.3, 1.2), "bar_mm": (4.4, 1.2), "stroke_mm": (0.8, 0.6)}
        assert all(check.passed for check in piece.checks)
    weak = settings_for(label="none")
    shape = LinkShape(60.0, 0.5, 0.0, 0.0, 10.0, 6.0, (8.0, 3.4), 1.0, 5.0)
    assert [check.passed for check in link_checks(shape, None, weak)] == [False, False]


def test_bars_too_small_for_a_label_go_without_and_say_so() -> None:
    found = kit(bar_width=2.0, bar_height=2.0)
    assert all(p.shape.label is None for p in found.links)
    assert found.notes == (
        "LP-001 has no label: its bar is too small for legible letters",
        "LP-002 has no label: its bar is too small for legible letters",
    )


@pytest.mark.parametrize("width", [3.0, 4.0, 5.0, 6.0, 8.0])
@pytest.mark.parametrize("key", ["fdm-0.4", "fdm-0.25", "sla", "sls"])
def test_a_label_fits_its_bar(width: float, key: str) -> None:
    settings = settings_for(key, bar_width=width, bar_height=width, eye_height=12.0)
    shape = LinkShape(60.0, 0.5, 0.0, 0.0, 14.0, 12.0, (4.0, 4.0), width, width, settings.bevel)
    label = label_for(shape, "L1068", settings)
    if label is not None:
        assert label.unit >= settings.printer.stroke
        assert boundary_of(LinkShape(**{**vars(shape), "label": label})) is not None


@pytest.mark.parametrize("key", printer_keys())
@pytest.mark.parametrize("pin", ["metal", "printed"])
def test_every_printer_has_a_coupon_around_its_clearance(key: str, pin: Any) -> None:
    settings = settings_for(key, pin=pin)
    coupon = coupon_shape(settings)
    boundary_of(coupon)
    clearances = (np.array(coupon.bores) - settings.pin_diameter) / 2
    assert (np.diff(clearances) > 0).all()
    assert clearances.min() < settings.clearance < clearances.max()
    assert np.abs(clearances - settings.clearance).min() < 1e-9
    assert [int(label.text) / 100 for label in coupon.labels] == pytest.approx(clearances)


@pytest.mark.parametrize("label", ["engraved", "none"])
@pytest.mark.parametrize("diameter", [5.0, 6.5, 7.0])
def test_thick_pins_have_a_coupon_too(diameter: float, label: Any) -> None:
    boundary_of(coupon_shape(settings_for("fdm-0.4", pin_diameter=diameter, label=label)))


def test_the_thickest_pin_that_is_named_is_taken() -> None:
    with pytest.raises(InputError, match=r"use a pin of 7\.2 mm or less"):
        settings_for("fdm-0.4", pin_diameter=7.3)
    settings_for("fdm-0.4", pin="printed", pin_diameter=7.2, cap_diameter=9.9)


def test_a_kit_holds_one_coupon_and_its_pin_or_none() -> None:
    found = kit()
    assert [p.mark for p in found.pieces if p.kind == COUPON] == ["T-0000"]
    assert isinstance(found.pieces[-2].shape, CouponShape)
    assert found.pieces[-1].mark == "T-0001"
    assert not any(p.mark.startswith("T") for p in kit(coupon=False).pieces)


# --- settings and printers -----------------------------------------------------------------------
@pytest.mark.parametrize(
    ("given", "words"),
    [
        (
            {"pin_diameter": 8.0},
            ["pin of 8 mm", "wall of 0.8 mm", "limit 1.2", "7.2 mm or"],
        ),
        ({"pin": "printed", "pin_diameter": 3.0}, ["3 mm breaks", "limit 4 mm"]),
        ({"pin_diameter": 1.0}, ["bore of 1.4 mm closes", "limit 2 mm"]),
        ({"eye_height": 0.0}, ["eye_height is 0 mm"]),
        ({"clearance": -0.1}, ["clearance is -0.1 mm"]),
        ({"press": -0.1}, ["press is -0.1 mm"]),
        ({"pin_diameter": 0.0}, ["pin_diameter is 0 mm"]),
        ({"bevel": float("nan")}, ["bevel is nan mm"]),
        ({"eye_diameter": float("inf")}, ["eye_diameter is inf mm"]),
        ({"clearance": 1.5}, ["caps of 6 mm", "bores of 6 mm", "7.2 mm or more"]),
        ({"cap_floor": 0.5}, ["floor of 0.5 mm", "1.2 mm"]),
        ({"cap_diameter": 12.0}, ["caps of 12 mm", "eyes of 10 mm"]),
        ({"bar_width": 1.0}, ["bars of 1 x 5 mm", "limit 1.2 mm"]),
        ({"bar_height": 1.5}, ["leave 0.9 mm under letters 0.6 mm deep", "limit 1.2 mm"]),
        ({"max_levels": 0}, ["max_levels is 0"]),
        ({"eye_hight": 6.0}, ['"eye_hight"', "eye_height"]),
    ],
)
def test_bad_settings_are_said(given: dict[str, Any], words: list[str]) -> None:
    with pytest.raises(InputError) as error:
        settings_for(**given)
    assert all(word in str(error.value) for word in words), error.value
    assert len(str(error.value).splitlines()) <= 3


def test_defaults_are_those_of_the_printer() -> None:
    s = settings_for()
    assert (s.pin_diameter, s.clearance, s.axial_gap) == (3.0, 0.2, 0.4)
    assert (s.eye_diameter, s.eye_height, s.bar_width, s.bar_height) == (10.0, 6.0, 5.0, 5.0)
    assert (s.printer.wall, settings_for(pin="printed").pin_diameter) == (1.2, 4.0)


def test_printers_are_complete_and_sourced() -> None:
    assert printer_keys()[0] == "fdm-0.4"
    for key in printer_keys():
        preset = printer(key)
        assert isinstance(preset, Printer)
        assert preset.key == key
        assert len(preset.source) > 40
        assert 0 <= preset.press < preset.clearance <= preset.axial_gap
        assert 0 < preset.stroke <= preset.wall
    with pytest.raises(ProjectError, match=r"fdm-0\.4"):
        printer("fdm-0.5")
