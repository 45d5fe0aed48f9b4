"""Numbers of the right type that make no sense together: a result, or an error of ours, soon.

Shapes that do not go together, empty arrays, numbers that are not finite, zero or huge. What numpy
raises or warns of inside would not say which argument it was.
"""

from __future__ import annotations

import inspect
import random
import signal
import typing
import warnings
from collections.abc import Callable, Iterator
from types import FrameType
from typing import Any

import numpy as np
import pytest
from numpy.typing import ArrayLike
from test_arguments import FUNCTIONS

from ddgfab import nets, surfaces
from ddgfab.arguments import complex_together, finite_together, vectors
from ddgfab.errors import ArgumentError, DdgError, InputError
from ddgfab.forms.monge_surface import monge
from ddgfab.mesh import Floats

ODD: list[Any] = [
    np.zeros(0),
    np.zeros((0, 3)),
    np.array([np.nan, 1.0]),
    np.array([np.inf, 1.0]),
    np.ones((2, 3)),
    np.ones((4, 4, 3)),
    np.ones((5, 4)),
    np.ones(2),
    np.arange(3.0),
    np.arange(4.0),
    1.0,
    0.0,
    -1.0,
    3,
    1e300,
    np.inf,
    np.nan,
]
ROUNDS = 20
LONGEST_S = 20


def of_numbers(function: Callable[..., Any]) -> bool:
    hints = typing.get_type_hints(function)
    hints.pop("return", None)
    known = (ArrayLike, Floats, float, int, complex, bool, float | None, int | None)
    return bool(hints) and all(hint in known or hint == ArrayLike | None for hint in hints.values())


NUMERIC = [function for function in FUNCTIONS if of_numbers(function)]


def calls(function: Callable[..., Any]) -> Iterator[dict[str, Any]]:
    """Odd values for the arguments without a default, and for some of the others."""
    rng = random.Random(function.__name__)
    parameters = inspect.signature(function).parameters
    for _ in range(ROUNDS):
        yield {
            name: rng.choice(ODD)
            for name, parameter in parameters.items()
            if parameter.default is parameter.empty or rng.random() < 0.4
        }


def test_there_are_functions_of_numbers() -> None:
    assert len(NUMERIC) > 100
    assert {"soliton", "isothermic_point", "amsler_angle"} <= {f.__name__ for f in NUMERIC}


def test_odd_numbers_end_in_a_result_or_an_error_of_ours() -> None:
    def late(signum: int, frame: FrameType | None) -> None:
        raise TimeoutError(f"no answer in {LONGEST_S} s")

    before = signal.signal(signal.SIGALRM, late)
    try:
        for function in NUMERIC:
            for arguments in calls(function):
                signal.alarm(LONGEST_S)
                try:
                    with warnings.catch_warnings():
                        warnings.simplefilter("error")
                        function(**arguments)
                except DdgError:
                    pass
                except Exception as error:
                    pytest.fail(f"{function.__name__}({arguments}): {error!r}")
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: surfaces.soliton([1.0, 2], [1.0, 2, 3], 1.0), r"u \(2,\), v \(3,\)"),
        (lambda: surfaces.dini([1.0, np.nan], 0.0), r"u\[1\] is nan; a finite number"),
        (lambda: surfaces.kuen(0.0, 0.0, np.inf), "shift is inf; a finite number is needed"),
        (lambda: surfaces.dini([0.0, 1e308], -1e308, 1e-3), r"point \(1,\) is not finite"),
        (lambda: surfaces.amsler_angle([1.0, 1e12], 1.0), r"r = 1e\+12 .*limit 1e\+06"),
        (lambda: surfaces.amsler_angle(np.inf, 1.0), "r is inf"),
        (lambda: surfaces.ellipsoid_normals([1.0, 2]), r"points has shape \(2,\); \(\.\.\., 3\)"),
        (lambda: surfaces.ellipsoid_normals([0.0, 0, 0]), "has no normal"),
        (lambda: surfaces.ellipsoid_normals([1.0, 0, 0], b=9.0), "a > b > c > 0"),
        (lambda: surfaces.kuen_lines(1.0, 0.0), "v = 0 rad; it must lie between 0 and pi"),
        (
            lambda: nets.isothermic_point([0, 0], [1, 0], [0, 1], [1, 2.0], [-1, -2, -3.0]),
            r"alpha1 \(2,\), alpha2 \(3,\)",
        ),
        (
            lambda: nets.evolve_isothermic([[0, 0]], [[0, 0]], 1, -1, growth_limit=np.nan),
            "growth_limit is nan; a positive number",
        ),
        (lambda: nets.knet.oriented_angle(*np.ones((3, 2))), r"normal has shape \(2,\)"),
        (lambda: monge(np.ones((4, 2)), np.ones((3, 3)), [1.0], [0, 0, 1.0]), r"steps .*\(2,\)"),
    ],
)  # fmt: skip
def test_messages_name_the_argument_and_what_it_needs(call: Any, words: str) -> None:
    with pytest.raises((InputError, DdgError), match=words):
        call()


def test_helpers_give_one_shape_and_keep_complex_numbers() -> None:
    x, y = finite_together(x=[1.0, 2.0], y=3)
    assert x.shape == y.shape == (2,)
    p, q = complex_together(p=1j, q=[1, 2])
    assert p.dtype.kind == "c"
    assert q.dtype.kind == "f"
    a, b = vectors(a=np.ones((4, 1, 3)), b=np.ones((2, 3)))
    assert a.shape == b.shape == (4, 2, 3)
    with pytest.raises(ArgumentError, match=r"b has shape \(3, 2\)"):
        vectors(a=np.ones(3), b=np.ones((3, 2)))


def test_labels_of_many_quads_at_one_corner() -> None:
    many = nets.isothermic_point([0.0, 0], [1.0, 0], [0.0, 1], [1.0, 2, 1], [-1.0, -1, -3])
    one = [
        nets.isothermic_point([0.0, 0], [1.0, 0], [0.0, 1], a, b)
        for a, b in ((1.0, -1.0), (2.0, -1.0), (1.0, -3.0))
    ]
    assert many.tolist() == np.array(one).tolist()


def test_far_parameters_have_their_limit() -> None:
    """Where the exponential overflows, its arc tangent is known."""
    assert surfaces.soliton(1e4, 0.0, 1.0) == pytest.approx(2 * np.pi)
    assert surfaces.breather_angle(1e4, 1e4, 0.5) == 0.0
    assert surfaces.pseudosphere_lines(1e4, 0.0).tolist() == [0.0, 0.0, 1e4 - 1.0]
