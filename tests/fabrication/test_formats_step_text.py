"""STEP text by ISO 10303-21: strings and headers read by a second parser, which is `part21`."""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import part21
import pytest
from gridshell_kinds import KINDS
from parts_table import EXACT

from fabrication.formats.step import Header, Material, StepProduct
from fabrication.formats.step.direct import assembly_bytes, part_bytes
from fabrication.formats.step.read import read_step
from fabrication.formats.step.records import product_name
from fabrication.formats.step.text import header_list, quoted
from fabrication.solids import boundary_of, properties_of

ALPHABET = (
    "aZ 09'\\#;()äßЖ東京\u2028\uffff\U0001f3db\U00020bb7\U0010ffff\n\t\x00\x7f\x85\ud83c\udfdb"
)


def shown(text: str) -> str:
    """What a text should come back as: control characters as one space, halves replaced."""
    out: list[str] = []
    for c in text:
        control = ord(c) < 32 or 127 <= ord(c) < 160 or c in "\u2028\u2029"
        if control and out and out[-1] == "\0":
            continue
        out.append("\0" if control else "\ufffd" if 0xD800 <= ord(c) < 0xE000 else c)
    return "".join(out).replace("\0", " ")


def product(number: str = "BP-001", material: str = "S355") -> StepProduct:
    shape = next(iter(EXACT.values()))[0]
    found = boundary_of(shape)
    return StepProduct(
        number, KINDS["beam"], None, properties_of(shape), Material(material, 7850.0), found
    )


def test_any_text_comes_back_through_a_second_parser() -> None:
    rng = random.Random(7)
    for _ in range(3000):
        text = "".join(rng.choices(ALPHABET, k=rng.randrange(12)))
        code = quoted(text)
        assert code.isascii()
        assert code.isprintable()
        assert part21.decode(code) == shown(text)


def test_characters_above_ffff_have_eight_digits() -> None:
    assert quoted("a\U0001f3dbä") == "'a\\X4\\0001F3DB\\X0\\\\X2\\00E4\\X0\\'"


@pytest.mark.parametrize(
    "text",
    [
        "",
        "J. Müller",
        "O'Neil\nand\tSons\x00\x1b[31m",
        "吉野\U00020bb7 \U0001f3db",
        "x" * 1000,
        "é\\" * 300,
    ],
)
def test_headers_are_by_the_book_whatever_they_hold(text: str) -> None:
    head = Header(author=text, organization=text, description=text)
    name = f"{text[:240]}.step"
    one = part_bytes(product(material=text), name, header=head)
    marks = [("BP-001", "B-0000", np.eye(4))]
    whole = assembly_bytes([product()], marks, name=text, file_name=name, header=head)
    for data in (one, whole):
        decoded = part21.header(data.decode("ascii"))
        _, _, author, organization, *_ = decoded["FILE_NAME"]
        assert decoded["FILE_NAME"][0] == shown(name)[:256]
        assert "".join(author) == "".join(organization) == shown(text)
        assert "".join(decoded["FILE_DESCRIPTION"][0]) == (shown(text) or shown(name))
        part21.tokens(data.decode("ascii").split("DATA;\n", 1)[1])


def test_a_long_author_takes_several_strings_each_short_enough() -> None:
    assert header_list("ab" * 200).count("','") == 1


@pytest.mark.slow
def test_the_kernel_reads_names_above_ffff(tmp_path: Path) -> None:
    name = "Dach \U0001f3db 東京"
    path = tmp_path / "a.step"
    path.write_bytes(part_bytes(product(name), path.name))
    assert [p.name for p in read_step(path).products] == [product_name(name)]
