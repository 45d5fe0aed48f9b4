"""Angles of K-nets and the discrete sine-Gordon (Hirota) equation on a potential of them.

In a quad phi is the angle at x and x_12 (from edges of the first direction to those of the second,
about the normal), psi that at x_1 and x_2, chi = pi - psi, k = tan(delta_1 / 2) tan(delta_2 / 2).
A potential h at the vertices has phi = (h_1 + h_2) / 2 and chi = (h + h_12) / 2 in every quad, and
fulfils sin((h_12 - h_1 - h_2 + h) / 4) = k sin((h_12 + h_1 + h_2 + h) / 4) exactly. With eps^2 / 4
in place of k, or the angle phi in place of h, this equation of the textbooks holds to leading order
only. Source: mathematics.md 3.7, 3.8, 13; Bobenko, Pinkall 1996.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from ddgfab.arguments import checked
from ddgfab.errors import InputError
from ddgfab.mesh import Floats
from ddgfab.nets.knet.net import KNet, knet
from ddgfab.nets.knet.oriented import modulo, oriented_angle, refuse_angles
from ddgfab.quads import finite
from ddgfab.tolerances import NET_INPUT


@checked
def angle_coefficient(delta_1: ArrayLike, delta_2: ArrayLike) -> Floats:
    """(M, N) k = tan(delta_1 / 2) tan(delta_2 / 2) of quads, from (M,) and (N,) angles [rad].

    Numbers give a number (0-dimensional array).

    Raises
    ------
    InputError
        An angle outside (0, pi).
    """
    a, b = np.asarray(delta_1, dtype=np.float64), np.asarray(delta_2, dtype=np.float64)
    refuse_angles(np.atleast_1d(a), "delta {} of the first direction")
    refuse_angles(np.atleast_1d(b), "delta {} of the second direction")
    return np.multiply.outer(np.tan(a / 2), np.tan(b / 2))


@checked
def quad_angles(net: KNet) -> tuple[Floats, Floats, Floats, Floats]:
    """Angles of the quads of a 2-net at x, x_12, x_1 and x_2, (M, N) each, in (-pi, pi] [rad].

    About the normals of the corners, counterclockwise between the two sides: phi, phi, psi, psi.
    The first two agree, as do the last two; negative ones occur where the net has folded over.

    Raises
    ------
    InputError
        Another number of directions than two; take a layer of the net.

    Source: mathematics.md 3.7.
    """
    x, n = net.points, net.normals
    if net.d != 2:
        raise InputError(f"{net!r} has {net.d} directions; angles of quads need two")
    a, b = np.diff(x, axis=0), np.diff(x, axis=1)
    low, high, left, right = a[:, :-1], a[:, 1:], b[:-1], b[1:]
    return (
        oriented_angle(n[:-1, :-1], low, left),
        oriented_angle(n[1:, 1:], -high, -right),
        oriented_angle(n[1:, :-1], right, -low),
        oriented_angle(n[:-1, 1:], -left, high),
    )


@checked
def vertex_angle_defect(net: KNet) -> Floats:
    """(M - 1, N - 1) angle sums at interior vertices minus 2 pi, modulo 2 pi: zero (3.7)."""
    phi, phi_12, psi_1, psi_2 = quad_angles(net)
    total = phi[1:, 1:] + phi_12[:-1, :-1] + psi_1[:-1, 1:] + psi_2[1:, :-1]
    return modulo(total)


@checked
def chi_of_phi(phi: ArrayLike, k: ArrayLike) -> Floats:
    """chi with tan(chi / 2) = (1 + k) / (1 - k) tan(phi / 2), continuous for |k| < 1.

    Exact relation of the angles of a quad: tan(phi / 2) tan(psi / 2) = (1 - k) / (1 + k), with
    chi = pi - psi. Angles beyond pi are kept on their branch: chi(phi + 2 pi) = chi(phi) + 2 pi
    (- 2 pi for |k| > 1).

    Raises
    ------
    InputError
        k = 1 (delta_1 + delta_2 = pi): psi does not depend on phi. Shapes that do not go together,
        entries that are not finite.

    Source: mathematics.md 3.7.
    """
    angle = np.asarray(phi, dtype=np.float64)
    angle, coefficient = np.broadcast_arrays(angle, _coefficients(k, angle.shape))
    finite(angle, "phi")
    if (coefficient == 1).any():
        at = tuple(np.argwhere(coefficient == 1)[0].tolist())
        raise InputError(f"k of quad {at} is 1, that is delta_1 + delta_2 = pi: psi is 0 or pi")
    turns = np.round(angle / (2 * np.pi))
    half = 0.5 * (angle - 2 * np.pi * turns)
    below = np.where(coefficient < 1, 1.0 - coefficient, coefficient - 1.0)
    sign = np.where(coefficient < 1, 1.0, -1.0)
    chi = 2.0 * sign * np.arctan2((1.0 + coefficient) * np.sin(half), below * np.cos(half))
    return np.asarray(chi + 2 * np.pi * turns * sign)


@checked
def angle_relation_defect(net: KNet) -> Floats:
    """(M, N) defect of tan(phi / 2) tan(psi / 2) = (1 - k) / (1 + k), as an angle chi (3.7)."""
    phi, _, psi, _ = quad_angles(net)
    return modulo(chi_of_phi(phi, angle_coefficient(*net.deltas)) - (np.pi - psi))


@checked
def product_defect(net: KNet) -> Floats:
    """(M - 1, N - 1) |Q Q_12 - F(Q_1) F(Q_2)| with Q = exp(i phi), F(z) = (z - k) / (1 - k z).

    The evolution of angles over four quads around a vertex, each F with the k of its quad (3.7).
    """
    q = np.exp(1j * quad_angles(net)[0])
    k = angle_coefficient(*net.deltas)
    f = (q - k) / (1.0 - k * q)
    return np.asarray(np.abs(q[:-1, :-1] * q[1:, 1:] - f[1:, :-1] * f[:-1, 1:]))


@checked
def hirota_residual(h: ArrayLike, k: ArrayLike) -> Floats:
    """(M, N) sin((h_12 - h_1 - h_2 + h) / 4) - k sin((h_12 + h_1 + h_2 + h) / 4).

    Parameters
    ----------
    h : (M + 1, N + 1) potential at the vertices
    k : (M, N) or a number, `angle_coefficient`

    Raises
    ------
    InputError
        Shapes that do not fit, entries that are not finite.

    Source: mathematics.md 3.8.
    """
    values = np.asarray(h, dtype=np.float64)
    if values.ndim != 2 or min(values.shape) < 2:
        raise InputError(f"a potential has shape (M + 1, N + 1); this one {values.shape}")
    finite(values, "potential")
    coefficient = _coefficients(k, (values.shape[0] - 1, values.shape[1] - 1))
    here, first, second = values[:-1, :-1], values[1:, :-1], values[:-1, 1:]
    both = values[1:, 1:]
    return np.asarray(
        np.sin((both - first - second + here) / 4)
        - coefficient * np.sin((both + first + second + here) / 4)
    )


def _coefficients(k: ArrayLike, shape: tuple[int, ...]) -> Floats:
    """k as finite numbers of the shape of the quads."""
    coefficient = np.asarray(k, dtype=np.float64)
    if coefficient.ndim and shape and coefficient.shape != shape:
        raise InputError(f"k has shape {coefficient.shape}; {shape} or one number is needed")
    finite(coefficient, "k")
    return coefficient


@checked
def evolve_hirota(first: ArrayLike, second: ArrayLike, k: ArrayLike) -> Floats:
    """(M + 1, N + 1) potential from its values on both axes.

    tan((h + h_12) / 4) = (1 + k) / (1 - k) tan((h_1 + h_2) / 4) on the continuous branch.

    Parameters
    ----------
    first, second : (M + 1,), (N + 1,) h in directions 0 and 1, with a common first value
    k : (M, N) or a number

    Raises
    ------
    InputError
        Shapes that do not fit, first values that differ, k = 1.

    Source: mathematics.md 3.8.
    """
    a, b = np.asarray(first, dtype=np.float64), np.asarray(second, dtype=np.float64)
    if a.ndim != 1 or b.ndim != 1 or min(len(a), len(b)) < 2:
        raise InputError(f"axes of shapes {a.shape} and {b.shape}: two values or more are needed")
    finite(a, "first axis")
    finite(b, "second axis")
    if a[0] != b[0]:
        raise InputError(f"the axes start with {a[0]:g} and {b[0]:g}; they must share their value")
    shape = (len(a) - 1, len(b) - 1)
    coefficient = np.broadcast_to(_coefficients(k, shape), shape)
    h = np.empty((len(a), len(b)))
    h[:, 0], h[0] = a, b
    for s in range(sum(shape) - 1):
        i = np.arange(max(0, s - shape[1] + 1), min(shape[0] - 1, s) + 1)
        j = s - i
        phi = 0.5 * (h[i + 1, j] + h[i, j + 1])
        h[i + 1, j + 1] = 2.0 * chi_of_phi(phi, coefficient[i, j]) - h[i, j]
    return h


@checked
def hirota_potential(net: KNet, start: tuple[float, float] = (0.0, 0.0)) -> Floats:
    """(M + 1, N + 1) potential h of the angles of a K-net: phi = (h_1 + h_2) / 2 in every quad.

    It is followed along the first row and column of quads, where neighbouring angles must differ by
    less than pi, and evolves from these axes, also over folds of the net.

    Parameters
    ----------
    net : K-net with two directions and a quad or more
    start : h at the points (0, 0) and (1, 0): the two free constants of the even and odd points

    Raises
    ------
    InputError
        Another number of directions, no quad, k = 1.

    Source: mathematics.md 3.8.
    """
    if net.d != 2 or min(net.shape) < 2:
        raise InputError(f"{net!r}: a potential needs two directions and a quad")
    phi = quad_angles(net)[0]
    k = angle_coefficient(*net.deltas)
    row, column = np.unwrap(phi[:, 0]), np.unwrap(phi[0])
    h_00, h_10 = start
    h_01 = 2 * row[0] - h_10
    first = _axis(row, chi_of_phi(row, k[:, 0]), h_00, h_10, h_01)
    second = _axis(column, chi_of_phi(column, k[0]), h_00, h_01, h_10)
    return evolve_hirota(first, second, k)


@checked
def knet_from_potential(
    h: ArrayLike,
    deltas: Sequence[ArrayLike],
    *,
    r: float = 1.0,
    origin: ArrayLike = (0.0, 0.0, 0.0),
    normal: ArrayLike = (0.0, 0.0, 1.0),
    edge: ArrayLike = (1.0, 0.0, 0.0),
    tolerance: float = NET_INPUT,
) -> KNet:
    """The K-net of a solution of Hirota's equation: the inverse of `hirota_potential`.

    It is unique up to its place.

    The angle at the first point is phi of the first quad; the axes turn by chi of one quad less phi
    of the next, with phi = (h_1 + h_2) / 2 and chi = (h + h_12) / 2.

    Parameters
    ----------
    h : (M + 1, N + 1) potential at the vertices
    deltas : (M,) and (N,) angles between consecutive normals [rad], which give k
    r, origin, normal, edge : scale and place, as in `knet`
    tolerance : on the residual of Hirota's equation

    Raises
    ------
    InputError
        Shapes that do not fit; a potential that does not fulfil the equation with these angles:
        names the quad and the residual. As `knet`.

    Source: mathematics.md 3.8, 3.5.
    """
    values = np.asarray(h, dtype=np.float64)
    if len(deltas) != 2:
        raise InputError(f"deltas of {len(deltas)} directions; a potential has two")
    residual = np.abs(hirota_residual(values, angle_coefficient(*deltas)))
    worst = tuple(int(i) for i in np.unravel_index(int(residual.argmax()), residual.shape))
    if not residual[worst] <= tolerance:
        raise InputError(
            f"the potential is not a solution of Hirota's equation: residual {residual[worst]:.2g} "
            f"in quad {worst} (limit {tolerance:g}); evolve_hirota makes one from two axes"
        )
    phi = 0.5 * (values[1:, :-1] + values[:-1, 1:])
    chi = 0.5 * (values[:-1, :-1] + values[1:, 1:])
    turns = [chi[:-1, 0] - phi[1:, 0], phi[0, 1:] - chi[0, :-1]]
    return knet(deltas, turns, phi[0, 0], r=r, origin=origin, normal=normal, edge=edge)


def _axis(phi: Floats, chi: Floats, h_00: float, h_10: float, h_01: float) -> Floats:
    """h along an axis, from the quads along it and both values next to the first one."""
    axis = [h_00, h_10]
    beside = [h_01]
    for i in range(len(phi)):
        beside.append(2 * chi[i] - axis[i])
        if i + 1 < len(phi):
            axis.append(2 * phi[i + 1] - beside[i + 1])
    return np.array(axis)
