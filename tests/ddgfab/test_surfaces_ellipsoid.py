"""The ellipsoid in confocal coordinates."""

from __future__ import annotations

import numpy as np
import pytest

from ddgfab.errors import InputError
from ddgfab.surfaces import (
    ellipsoid_curvatures,
    ellipsoid_normals,
    ellipsoid_patch,
    ellipsoid_umbilics,
)

U, V = np.linspace(5, 8, 7)[:, None], np.linspace(1.5, 3.5, 6)[None, :]


def test_points_normals_and_curvatures_by_second_routes() -> None:
    x = ellipsoid_patch(U, V)
    assert np.abs((x**2 / [9, 4, 1]).sum(axis=-1) - 1).max() < 1e-15
    step = 1e-5
    f_u = (ellipsoid_patch(U + step, V) - ellipsoid_patch(U - step, V)) / (2 * step)
    f_v = (ellipsoid_patch(U, V + step) - ellipsoid_patch(U, V - step)) / (2 * step)
    n = ellipsoid_normals(x)
    for tangent in (f_u, f_v):
        assert np.abs((tangent * n).sum(axis=-1)).max() < 1e-9
    assert np.abs((f_u * f_v).sum(axis=-1)).max() < 1e-9
    # Rodrigues: along curvature lines dn = kappa dx with the outward normal.
    n_u = ellipsoid_normals(ellipsoid_patch(U + step, V)) - ellipsoid_normals(
        ellipsoid_patch(U - step, V)
    )
    n_v = ellipsoid_normals(ellipsoid_patch(U, V + step)) - ellipsoid_normals(
        ellipsoid_patch(U, V - step)
    )
    first, second = ellipsoid_curvatures(U, V)
    assert np.abs(n_u / (2 * step) - first[..., None] * f_u).max() < 1e-8
    assert np.abs(n_v / (2 * step) - second[..., None] * f_v).max() < 1e-8


def test_point_and_curvatures_by_hand() -> None:
    assert ellipsoid_patch(6, 2.5) == pytest.approx([2.09463601, 0.89442719, 0.55901699], abs=1e-8)
    kappa = ellipsoid_curvatures(6, 2.5)
    assert kappa == pytest.approx((0.258198890, 0.619677335), abs=1e-9)
    assert kappa[0] * kappa[1] == pytest.approx(0.16, abs=1e-15)
    assert ellipsoid_umbilics()[0] == pytest.approx([2.3717082451, 0, 0.6123724357], abs=1e-10)
    assert np.array(ellipsoid_curvatures(4, 4)) == pytest.approx(0.375, abs=1e-15)


def test_refusals() -> None:
    with pytest.raises(InputError, match=r"u = 9.5 lies outside 4..9"):
        ellipsoid_patch(9.5, 2)
    with pytest.raises(InputError, match="v = nan"):
        ellipsoid_patch(5, np.nan)
    with pytest.raises(InputError, match="a > b > c"):
        ellipsoid_patch(5, 2, 4, 9, 1)
