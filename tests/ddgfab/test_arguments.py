"""Every public function refuses arguments of the neighboring wrong type by their name.

A function that fails here lacks the decorator `ddgfab.arguments.checked`.

The right and wrong values come from a table of this test; the functions from the packages.
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import typing
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import ArrayLike

import ddgfab
from ddgfab import io, nets, transforms
from ddgfab.arguments import checked
from ddgfab.errors import ArgumentError, DdgError, InputError
from ddgfab.grid import grid_mesh
from ddgfab.linkages import flex
from ddgfab.mesh import Mesh
from ddgfab.net import Net
from ddgfab.nets.knet import KNet, knet
from ddgfab.support import central, torsion_free_axes
from ddgfab.support.edge import beam_heights
from ddgfab.support.parallel import parallel_field
from ddgfab.transforms import invert, invert_normals

POINTS = np.stack([*np.meshgrid(np.arange(4.0), np.arange(3.0), indexing="ij"), np.ones((4, 3))], 2)
MESH = grid_mesh(POINTS)
KNET = knet([np.full(3, 0.3), np.full(2, 0.4)], [np.full(2, 0.1), np.full(1, -0.2)], 1.2)
WORDS = np.array(["a", "b"])

WRONG: dict[Any, list[Any]] = {
    Mesh: [POINTS, KNET, Net.build(POINTS), "roof.obj", 3.0, None, [MESH]],
    KNet: [POINTS, MESH, "dini", 1.0, None],
    ArrayLike: [MESH, KNET, "points", WORDS, None, object(), {"a": 1}, [[1.0], [1.0, 2.0]]],
    float: [MESH, "1.0", np.ones(2), None, 1j, [1.0]],
    int: [MESH, "3", np.ones(2), None, 1j],
    complex: [MESH, "3", np.ones(2), None],
    bool: [MESH, "yes", None, 0.5],
    str: [MESH, 3, None, POINTS],
    Path: [MESH, 3, None, POINTS],
}


def public() -> Iterator[Callable[..., Any]]:
    """Every function in an `__all__` of ddgfab, and those of offsets, which has none."""
    found: dict[Callable[..., Any], None] = {}
    for info in (*pkgutil.walk_packages(ddgfab.__path__, "ddgfab."), ddgfab):
        module = importlib.import_module(getattr(info, "name", None) or "ddgfab")
        names = getattr(module, "__all__", ())
        if module.__name__ == "ddgfab.offsets":
            names = [
                n
                for n, v in vars(module).items()
                if getattr(v, "__module__", "") == module.__name__
            ]
        for name in names:
            value = getattr(module, name)
            if inspect.isfunction(value) and not name.startswith("_"):
                found[value] = None
    return iter(found)


FUNCTIONS = sorted(
    {f for f in public() if f.__module__.startswith("ddgfab") and f is not checked},
    key=lambda f: (f.__module__, f.__name__),
)


def wrong_values(hint: Any) -> list[Any]:
    """Values that an annotation does not allow; `None` only where it is not allowed."""
    origin, parts = typing.get_origin(hint), typing.get_args(hint)
    if hint in WRONG:
        return WRONG[hint]
    if hint == ArrayLike or origin is np.ndarray:
        return WRONG[ArrayLike]
    if origin is typing.Annotated:
        return wrong_values(parts[0])
    if origin is typing.Literal:
        return [3, MESH, None]
    if origin in (Sequence, tuple):
        return [MESH, "ab", 0.1, None, [MESH], object()]
    if origin is Mapping:
        return [MESH, [1.0], "a"]
    if getattr(hint, "__name__", "") == "Callable" or "Callable" in str(origin):
        return [MESH, 3.0, "f"]
    if isinstance(hint, type):
        return [3.0, "text", MESH if hint is not Mesh else KNET]
    if parts:  # a union: what none of its parts allows
        allowed = set(parts)
        numeric = any(
            "_SupportsArray" in str(p) or typing.get_origin(p) is np.ndarray for p in parts
        )
        candidates = [object(), MESH, KNET, *([] if numeric else [np.ones(7)])]
        if type(None) not in allowed:
            candidates.append(None)
        if Mesh in allowed:
            candidates.remove(MESH)
        if Net in allowed or KNet in allowed:
            candidates.remove(KNET)
        if numeric:
            candidates.append(WORDS)
        return candidates
    return []


def parameters() -> list[Any]:
    found = []
    for function in FUNCTIONS:
        hints = typing.get_type_hints(function)
        for name in inspect.signature(function).parameters:
            if hints[name] is not Any:
                case = f"{function.__name__}-{name}"
                found.append(pytest.param(function, name, hints[name], id=case))
    return found


def test_all_functions_are_looked_at() -> None:
    assert len(FUNCTIONS) > 250
    assert {"christoffel_dual", "inspect", "vertex_offset", "families"} <= {
        f.__name__ for f in FUNCTIONS
    }


@pytest.mark.parametrize(("function", "name", "hint"), parameters())
def test_wrong_types_are_refused_by_name(
    function: Callable[..., Any], name: str, hint: Any, tmp_path: Path
) -> None:
    """Only this argument is given: it is looked at before Python misses the others."""
    values = wrong_values(hint)
    assert values, hint
    for value in values:
        with pytest.raises((TypeError, ValueError)) as error:
            function(**{name: value})
        assert isinstance(error.value, DdgError), (value, error.value)
        text = str(error.value)
        # Generators of the forms have a check of their own, with limits.
        assert text.startswith((f"{function.__name__}: {name} is ", f"{name} = "))
        assert len(text) < 400
        assert "0x" not in text
        assert "_SupportsArray" not in text


def test_messages_name_what_helps(tmp_path: Path) -> None:
    cases: list[tuple[Callable[[], Any], str]] = [
        (lambda: flex(KNET, 0.0, 0.1), "flex: dturns is 0.0; a list"),  # type: ignore[arg-type]
        (
            lambda: nets.conical_to_circular(MESH),  # type: ignore[arg-type]
            r"points is of type Mesh; an array of numbers is needed \(its vertices are",
        ),
        (
            lambda: io.write_obj(tmp_path / "k.obj", KNET),  # type: ignore[arg-type]
            r"mesh is of type KNet; a Mesh is needed \(net\.to_net\(\)\.to_mesh\(\)",
        ),
        (lambda: ddgfab.inspect(POINTS), r"shape \(4, 3, 3\) .*grid_mesh\(points\)"),  # type: ignore[arg-type]
        (lambda: transforms.darboux(POINTS, "2", [0, 0, 1.0]), "mu is '2'; a number is needed"),  # type: ignore[arg-type]
    ]
    for call, message in cases:
        with pytest.raises(ArgumentError, match=message):
            call()
    assert not list(tmp_path.iterdir())


def test_right_types_of_every_make_pass() -> None:
    """Lists, tuples, numpy's numbers, nets as arrays."""

    @checked
    def take(x: ArrayLike, s: float, n: int, w: Sequence[float], t: tuple[int, float]) -> str:
        return "taken"

    for x in (POINTS, POINTS.tolist(), Net.build(POINTS), 3, np.float32(2), [POINTS, POINTS]):
        for s in (1, 1.5, np.float64(2), np.array(3.0), np.int32(4)):
            for n in (1, np.int64(2), np.array(3)):
                for w in ([1, 2.0], (), np.ones(3), range(2)):
                    assert take(x, s, n, w, (1, 2.0)) == "taken"  # type: ignore[arg-type]
                    assert take(x, s, n, w, t=[1, 2]) == "taken"  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="missing 4 required"):
        take(POINTS)  # type: ignore[call-arg]
    with pytest.raises(ArgumentError, match=r"take: t is of type tuple; \(an integer, a number\)"):
        take(1, 1, 1, [], (1, 2.0, 3))  # type: ignore[arg-type]


def test_constructors_and_methods_name_what_is_wrong() -> None:
    flat: Any = POINTS.reshape(-1, 3)
    cases: list[tuple[Callable[[], Any], str]] = [
        (lambda: Mesh.build(flat, 3), "faces: a list of lists"),  # type: ignore[arg-type]
        (lambda: Mesh.build(flat, [0, 1, 2]), "faces: a list of lists"),  # type: ignore[list-item]
        (lambda: Mesh.build("a", [[0, 1, 2]]), "vertices of type str"),
        (lambda: Mesh.build(MESH, MESH.faces), "vertices of type Mesh"),  # type: ignore[arg-type]
        (lambda: MESH.with_vertices(MESH), r"Mesh\.with_vertices: vertices is of type Mesh"),  # type: ignore[arg-type]
        (lambda: MESH.scaled("2"), "'2'; a number is needed"),  # type: ignore[arg-type]
        (lambda: Net.build(MESH), r"Net\.build: points is of type Mesh"),  # type: ignore[arg-type]
        (lambda: Net.from_mesh(POINTS), r"grid_mesh\(points\)"),  # type: ignore[arg-type]
        (lambda: nets.SIsothermic.of(POINTS), r"SIsothermic\.of: mesh"),  # type: ignore[arg-type]
        (lambda: transforms.Moebius.inversion(MESH, 1.0), "center is of type Mesh"),  # type: ignore[arg-type]
        (lambda: transforms.Moebius.inversion([9, 9, 9], 1.0)(MESH), "points is of type Mesh"),  # type: ignore[arg-type]
        (lambda: Net.build(POINTS).shift("u"), "axis is 'u'; an integer is needed"),  # type: ignore[arg-type]
    ]
    for call, message in cases:
        with pytest.raises(DdgError, match=message):
            call()


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: nets.planarity(POINTS + 1j), "complex128; an array of numbers is needed"),
        (lambda: invert(POINTS, np.array([0, 1j, 0]), 1.0), "complex128; an array of numbers"),
        (lambda: nets.shift(POINTS, 2.5), "axis is 2.5; an integer is needed"),
        (lambda: nets.shift(POINTS, 5), "axis 5: an array of shape"),
        (lambda: nets.difference(POINTS, -4, periodic=True), "axis -4"),
        (lambda: invert(POINTS, [0.0, 1.0], 1.0), r"center has shape \(2,\); \(3,\) is needed"),
        (lambda: invert(POINTS[..., :2], [0.0, 0, 9], 1.0), r"\(\.\.\., 3\) is needed"),
        (lambda: invert_normals(POINTS, POINTS[:2], [0.0, 0, 9]), "shapes do not go together"),
        (lambda: nets.star_triangle([1.0, 2], [1.0, 2, 3], 1.0), r"a12 \(2,\), a23 \(3,\)"),
        (lambda: nets.conjugate_residuals([1.0, 2.0]), "a net has shape"),
        (lambda: nets.conical_to_circular(POINTS, [1.0, 2.0]), r"first has shape \(2,\)"),
        (lambda: nets.axis_coplanarity(POINTS, POINTS[:2], 0), "directions has shape"),
        (lambda: nets.complex_cross_ratio([1.0, 2], [1.0, 2, 3], 1, 2), r"a \(2,\), b \(3,\)"),
        (lambda: central(grid_mesh(POINTS), [1.0]), r"center has shape \(1,\)"),
        (lambda: torsion_free_axes(grid_mesh(POINTS), POINTS[0]), r"start has shape \(3, 3\)"),
        (lambda: parallel_field(grid_mesh(POINTS), POINTS[0]), r"target has shape \(3, 3\)"),
        (lambda: beam_heights(grid_mesh(POINTS), POINTS[0]), r"axes has shape \(3, 3\)"),
    ],
)
def test_shapes_and_kinds_that_do_not_fit_are_named(call: Any, words: str) -> None:
    with pytest.raises(InputError, match=words):
        call()


def test_complex_numbers_are_taken_where_they_mean_something() -> None:
    assert nets.complex_cross_ratio(0, 1, 1 + 1j, 1j) == pytest.approx(-1.0)
    assert nets.shift([1.0, 2.0, 4.0], 0.0).tolist() == [2.0, 4.0]  # type: ignore[arg-type]
