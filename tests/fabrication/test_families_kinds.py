"""Families of several kinds of pieces: order, numbers, and what is kept apart."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np
import pytest
from family_pieces import beam, marks, motion, node, panel

from ddgfab.errors import InputError
from fabrication.families import families
from fabrication.linkage.pieces import Loose
from fabrication.parts.beam import EndCut
from fabrication.parts.node import NodeShape
from fabrication.parts.panel import PANEL
from fabrication.parts.pin import PIN, PinShape
from fabrication.specs import Check

TRAPEZE = np.array([[0, 0], [900, 0], [700, 500], [100, 620.0]])


def test_kinds_come_in_the_order_of_their_pieces_and_share_no_prefix() -> None:
    one, two = node(0, [0.0]), beam(0, EndCut(20, 0.0), EndCut(900, 0.0))
    assert [f.number for f in families([one, two])] == ["NP-001", "BP-001"]
    assert [f.number for f in families([two, one])] == ["BP-001", "NP-001"]
    plate = replace(panel(1, TRAPEZE))
    object.__setattr__(plate, "kind", replace(PANEL, role="plate"))
    with pytest.raises(InputError, match='"panel" and "plate" both have part numbers PP-001'):
        families([panel(0, TRAPEZE), plate])


def test_shapes_of_two_classes_are_never_congruent() -> None:
    """Even if their keys and points agree."""

    @dataclass(frozen=True, eq=False)
    class Other(NodeShape):
        pass

    own = node(0, [0.0, 2.0])
    shape = Other(**{f.name: getattr(own.shape, f.name) for f in fields(own.shape)})
    assert shape.key() == own.shape.key()
    found = families([own, replace(node(1, [0.0, 2.0]), shape=shape)])
    assert [f.number for f in found] == ["NP-001", "NP-002"]


def test_pieces_beyond_a_limit_have_numbers_of_their_own() -> None:
    failed = replace(panel(1, TRAPEZE), checks=(Check("planarity_mm", False, 9.0, 1.0),))
    assert len(families([panel(0, TRAPEZE), failed, panel(2, TRAPEZE)])) == 2


def test_empty_and_single() -> None:
    assert families([]) == ()
    assert marks(families([panel(5, TRAPEZE)])) == [["P-0005"]]


def test_pieces_whose_key_is_everything_keep_their_places() -> None:
    shapes = [PinShape(3.0, 12.0, 5.0, 1.5), PinShape(3.0, 12.0, 5.0, 1.5), PinShape(3.0, 14.0)]
    pieces = [Loose(f"H-{k:04d}", PIN, shape, motion(k)) for k, shape in enumerate(shapes)]
    found = families(pieces)
    assert marks(found) == [["H-0000", "H-0001"], ["H-0002"]]
    for family in found:
        for instance in family.instances:
            assert np.allclose(instance.placement, motion(int(instance.mark[2:])), atol=1e-9)
