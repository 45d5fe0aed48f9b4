"""A design as formats are given it, without a job: parts without solids of the kernel."""

from __future__ import annotations

from fabrication.formats.base import Part, Whole
from fabrication.gridshell.design import Design
from fabrication.solids import realise


def whole_of(design: Design, failed: frozenset[str] = frozenset()) -> Whole:
    """All parts, and where they stand."""
    product = design.product()
    parts = {
        family.number: Part.of(
            family,
            realise(family.shape, product.chord, solid=False),
            product.material(family),
        )
        for family in product.families
    }
    return Whole(product.about(), parts, product.families, product.families, failed)
