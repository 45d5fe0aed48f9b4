"""STEP written directly: the text itself, without a kernel."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gridshell_kinds import KINDS
from parts_table import EXACT
from step_products import HEADER, SHAPES, boundary, products, text_of

from ddgfab.errors import DegenerateError, KernelError
from fabrication.formats.step import (
    StepProduct,
)
from fabrication.formats.step.direct import assembly_bytes, part_bytes
from fabrication.formats.step.geometry import BoundaryShell, shell
from fabrication.formats.step.text import quoted, real
from fabrication.solids import boundary_of, properties_of

# --- the text itself, without a kernel --------------------------------------------------------


@pytest.mark.parametrize("name", EXACT)
def test_every_id_is_defined_once_and_every_reference_is_to_a_defined_id(name: str) -> None:
    text = text_of(EXACT[name][0]).decode("ascii")
    data = re.sub(r"'[^']*'", "''", text.split("DATA;\n")[1])
    defined = re.findall(r"^#(\d+) ?=", data, flags=re.M)
    assert len(defined) == len(set(defined))
    assert set(re.findall(r"#(\d+)", data)) == set(defined)
    for value in re.findall(r"(?<=[(,])-?\d[^,()]*(?=[,)])", data):
        # counts: of schemas, and degrees of polynomials and their knots
        whole = value in {"3", "2000"} or (value.isdigit() and "B_SPLINE" in data)
        assert whole or re.fullmatch(r"-?\d+\.\d*(E[+-]?\d+)?", value)


@pytest.mark.parametrize("name", EXACT)
def test_the_ids_of_a_shell_are_counted_right(name: str) -> None:
    found = boundary_of(EXACT[name][0])
    assert found is not None
    template, numbers = shell(found, 32, 4)
    assert template.ids == 32 + BoundaryShell(found).ids
    assert template.text.count("%") == len(numbers)


def test_shapes_of_one_topology_do_not_share_numbers() -> None:
    first, second = SHAPES["BP-002"], SHAPES["BP-003"]
    template, numbers = shell(boundary("BP-002"), 32, 4)
    other, others = shell(boundary("BP-003"), 32, 4)
    assert template is other
    assert numbers != others
    assert text_of(first) != text_of(second)


def test_strings_and_reals_follow_part_21() -> None:
    assert quoted("O'Neil") == "'O''Neil'"
    assert quoted("a\\b") == "'a\\\\b'"
    assert quoted("Dä") == "'D\\X2\\00E4\\X0\\'"
    for value, text in [(1.0, "1."), (-2.5, "-2.5"), (1e-5, "1.E-05"), (1.25e20, "1.25E+20")]:
        assert real(value) == text
        assert float(text) == value


def test_bytes_are_the_same_in_every_process_and_no_kernel_is_loaded() -> None:
    here = Path(__file__)
    program = (
        f"import sys; sys.path[:0] = [{str(here.parent)!r}, {str(here.parents[2])!r}]\n"
        "import hashlib, step_products as t\n"
        "from fabrication.formats.step import assembly_bytes\n"
        "text = assembly_bytes(t.products(), t.INSTANCES, name='R', file_name='a')\n"
        "assert 'OCP' not in sys.modules\n"
        "print(hashlib.sha256(text).hexdigest())"
    )
    prints = {
        subprocess.run(
            [sys.executable, "-c", program],
            check=True,
            capture_output=True,
            env={**os.environ, "PYTHONHASHSEED": seed, "SOURCE_DATE_EPOCH": "0"},
        ).stdout
        for seed in ("1", "2")
    }
    assert len(prints) == 1


@pytest.mark.parametrize(
    ("schema", "identity"),
    [
        ("AP214", "AUTOMOTIVE_DESIGN {"),
        ("AP242", "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF"),
    ],
)
def test_the_header_is_filled_in(
    schema: Any, identity: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    text = part_bytes(products()[0], "BP-001.step", header=HEADER, schema=schema).decode("ascii")
    head = text.split("DATA;")[0]
    assert r"FILE_DESCRIPTION(('C:\\jobs\\7'),'2;1');" in head
    assert (
        r"FILE_NAME('BP-001.step','2023-11-14T22:13:20',('J. M\X2\00FC\X0\ller'),('Werk O''Neil'),"
        "'ddgfab "
    ) in head
    assert f"FILE_SCHEMA(('{identity}" in head


def test_an_unknown_part_number_and_a_missing_boundary_are_named() -> None:
    with pytest.raises(KernelError, match="B-0009 is an instance of BP-009"):
        assembly_bytes(products(), [("BP-009", "B-0009", np.eye(4))], name="R", file_name="a")
    bare = [StepProduct("BP-001", KINDS["beam"], None, properties_of(SHAPES["BP-001"]))]
    with pytest.raises(KernelError, match="BP-001"):
        assembly_bytes(bare, [], name="R", file_name="a")


def test_an_edge_without_length_and_what_is_not_finite_are_refused_by_number() -> None:
    whole = boundary("BP-002")
    for vertex, value in ((0, np.nan), (int(whole.edges[0, 0]), whole.points[whole.edges[0, 1]])):
        points = whole.points.copy()
        points[vertex] = value
        broken = replace(products()[1], boundary=replace(whole, points=points))
        with pytest.raises(DegenerateError, match=r"BP-002: .*not finite"):
            assembly_bytes([broken], [], name="R", file_name="a")
