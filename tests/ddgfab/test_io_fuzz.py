"""Any bytes at all: readers give a mesh or an error of ours, soon, and in little memory.

`DDGFAB_FUZZ=5000` runs so many examples for each reader instead of the few of CI; then they differ
from run to run.
"""

from __future__ import annotations

import gzip
import json
import os
import struct
import time
import tracemalloc
from pathlib import Path

import pytest

from ddgfab.errors import DdgError
from ddgfab.io import read_mesh

hypothesis = pytest.importorskip("hypothesis")
st = hypothesis.strategies

EXAMPLES = int(os.environ.get("DDGFAB_FUZZ", "0"))
SECONDS, MEMORY = 5.0, 50e6

pytestmark = pytest.mark.slow

NUMBERS = st.one_of(
    st.sampled_from(
        [
            "0",
            "1",
            "-1",
            "0.5",
            "1e3",
            "1e-7",
            "1e60",
            "1e61",
            "1e308",
            "1e999",
            "nan",
            "-inf",
            "1d2",
            "0x1",
            "1_0",
            "1,5",
            "--1",
            "9" * 400,
            "1" + "0" * 5000,
            "",
            "٣",
            "+.5",
            "5e-324",
            "1.0000001",
        ]
    ),
    st.floats(-10, 10).map(str),
    st.integers(-3, 12).map(str),
    st.sampled_from([str(2**31), str(2**53), str(2**63), str(-(2**64)), "9" * 5000]),
)
WORDS = st.one_of(
    NUMBERS,
    st.sampled_from(
        [
            "v",
            "f",
            "l",
            "vn",
            "vt",
            "p",
            "g",
            "o",
            "usemtl",
            "surf",
            "curv",
            "#",
            "\\",
            "/",
            "1/2/3",
            "1//1",
            "-1/-1/-1",
            "OFF",
            "COFF",
            "4OFF",
            "nOFF",
            "STNOFF",
            "BINARY",
            "solid",
            "vertex",
            "facet",
            "endsolid",
            "ply",
            "end_header",
            "# units: m",
            "# normals: node axes",
            "\x00",
            "\x1b",
            "\ufeff",
            "é",
            "# 9 vertices, 9 faces",
        ]
    ),
    st.text(max_size=4),
)
ROWS = st.lists(WORDS, max_size=7).map(" ".join)
LOOSE = st.lists(ROWS, max_size=14).map("\n".join)
POINTS = st.lists(st.tuples(NUMBERS, NUMBERS, NUMBERS), max_size=9)
FACES = st.lists(st.lists(st.integers(-2, 10), max_size=6), max_size=8)


@st.composite
def objs(draw: st.DrawFn) -> bytes:
    rows = ["v " + " ".join(p) for p in draw(POINTS)]
    kind = draw(st.sampled_from(["f", "f", "f", "l"]))
    rows += [f"{kind} " + " ".join(map(str, f)) for f in draw(FACES)]
    rows += draw(st.lists(ROWS, max_size=2))
    return draw(st.sampled_from(["\n", "\r\n", "\r", " \\\n"])).join(rows).encode()


@st.composite
def offs(draw: st.DrawFn) -> bytes:
    points, faces = draw(POINTS), draw(FACES)
    head = draw(st.sampled_from(["OFF", "COFF", "NOFF", "off", "STOFF", "OFF3", "CNOFF"]))
    more = draw(st.integers(-1, 2))
    rows = [f"{len(points) + more} {len(faces)} 0", *(" ".join(p) for p in points)]
    rows += [" ".join(map(str, [len(f), *f])) for f in faces]
    return (head + "\n" + draw(st.sampled_from(["\n", "\n", " ", "\n# x\n\n"])).join(rows)).encode()


@st.composite
def plys(draw: st.DrawFn) -> bytes:
    points, faces = draw(POINTS), draw(FACES)
    kind = draw(st.sampled_from(["ascii", "binary_little_endian", "binary_big_endian"]))
    code = draw(st.sampled_from(["float", "double", "int", "uchar"]))
    index = draw(st.sampled_from(["int", "uint", "char", "short", "float"]))
    size = draw(st.sampled_from(["uchar", "char", "int", "uint", "double"]))
    extra = draw(st.sampled_from(["", "property list uchar int more\n", "element edge 2\n",
                                  "property float x\n", "element user 99999999999\n"]))  # fmt: skip
    head = f"ply\nformat {kind} 1.0\ncomment units: mm\nelement vertex {len(points)}\n"
    head += "".join(f"property {code} {axis}\n" for axis in "xyz") + extra
    head += f"element face {len(faces)}\nproperty list {size} {index} vertex_indices\nend_header\n"
    if kind == "ascii":
        rows = [" ".join(p) for p in points] + [" ".join(map(str, [len(f), *f])) for f in faces]
        return (head + "\n".join(rows)).encode()
    return head.encode() + draw(st.binary(max_size=200))


@st.composite
def stls(draw: st.DrawFn) -> bytes:
    if draw(st.booleans()):
        rows = ["vertex " + " ".join(p) for p in draw(POINTS)]
        return ("solid a\n" + "\n".join(rows) + draw(st.sampled_from(["\nendsolid", ""]))).encode()
    count = draw(st.integers(0, 4))
    body = draw(st.binary(min_size=50 * count, max_size=50 * count))
    return draw(st.sampled_from([b" ", b"s"])) * 80 + struct.pack("<I", count) + body


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=3),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(
            st.sampled_from(["x", "y", "z", "0", "1", "vertices", "faces"]), inner, max_size=4
        )
    ),
    max_leaves=12,
)


@st.composite
def compas(draw: st.DrawFn) -> bytes:
    points = draw(
        st.lists(st.one_of(JSON, st.lists(st.floats(-5, 5), min_size=3, max_size=3)), max_size=8)
    )
    faces = draw(st.one_of(FACES, st.lists(JSON, max_size=3), JSON))
    names = draw(st.sampled_from([("vertices", "faces"), ("vertex", "face"), ("vertex", "faces")]))
    record = {names[0]: points, names[1]: faces, "dva": draw(JSON)}
    if draw(st.booleans()):
        record[names[0]] = {str(i): p for i, p in enumerate(points)}
    return json.dumps(draw(st.sampled_from([record, [record], {"data": record}]))).encode()


MADE = {"obj": objs(), "off": offs(), "ply": plys(), "stl": stls(), "json": compas()}
CASES = {
    "any": (st.binary(max_size=200), ["obj", "off", "ply", "stl", "json"]),
    "loose": (
        LOOSE.map(lambda text: text.encode("utf-8", "surrogatepass")),
        ["obj", "off", "ply", "stl"],
    ),
    **{kind: (made, [kind]) for kind, made in MADE.items()},
}


def bounded(path: Path, data: bytes, **ways: object) -> None:
    """Read; what comes out is a sound mesh or an error of ours, within time and memory."""
    path.write_bytes(data)
    tracemalloc.start()
    begin = time.process_time()
    try:
        mesh = read_mesh(path, **ways).mesh  # type: ignore[arg-type]
    except DdgError as error:
        message = str(error)
        assert message.startswith(str(path))
        assert len(message) < 1000 + len(str(path))
        assert all(c.isprintable() or c == "\n" for c in message)
    else:
        mesh.validate()
    finally:
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
    assert time.process_time() - begin < SECONDS
    assert peak < MEMORY


@pytest.mark.parametrize("case", CASES)
def test_any_bytes(case: str, tmp_path: Path) -> None:
    made, suffixes = CASES[case]

    @hypothesis.settings(
        max_examples=EXAMPLES or 50,
        deadline=None,
        derandomize=not EXAMPLES,
        database=None,
        suppress_health_check=list(hypothesis.HealthCheck),
    )
    @hypothesis.given(made, st.sampled_from(suffixes), st.booleans(), st.booleans())
    def run(data: bytes, suffix: str, packed: bool, quads: bool) -> None:
        if packed:
            data = gzip.compress(data, 1)
        bounded(tmp_path / f"a.{suffix}", data, quads=quads)

    run()
