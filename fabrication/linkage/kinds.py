"""[linkage]: the kinds of linkage with their parameters, and the mechanisms that they make."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Final, Literal

import numpy as np
from pydantic import Field, model_validator

from ddgfab.errors import InputError
from ddgfab.linkages import Mechanism, bennett, crab_mechanism, cube, knet_mechanism
from ddgfab.mesh import Floats
from ddgfab.net import Net
from ddgfab.nets.knet import KNet
from ddgfab.nets.knet.crab import crab_net
from ddgfab.nets.knet.recover import recover_knet
from fabrication.linkage.surfaces import SURFACES, check_numbers, surface_net
from fabrication.meshes_in import read_mesh
from fabrication.project.sections import Finite, Positive, Section

Angle = Annotated[float, Field(gt=0, lt=360)]
Twist = Annotated[float, Field(gt=0, lt=180)]
Index = Annotated[int, Field(ge=0)]
Count = Annotated[int, Field(ge=1, le=100)]

MADE: Final = ("surface", "parameters", "cells", "deltas_deg")
"""What a K-net is made from; a file has its own."""

TWIST_DEG: Final = 20.0
"""Twist [deg] of the bars of a K-net of few cells where none is given."""

TURN_DEG: Final = 60.0
"""Twists [deg] of a row of bars together, where none are given: nets that turn further meet
themselves at the angles of their design pose."""

BENNETT_BETA_DEG: Final = 70.0
"""Second twist [deg] of a Bennett linkage when neither b nor beta is given."""


class BennettLinkage(Section):
    """[linkage] kind = "bennett": one isogram of four bars a, b, a, b.

    Attributes
    ----------
    a_mm, alpha_deg : length and twist of two of the bars
    b_mm, beta_deg : of the others; one of them is enough, as a / sin(alpha) = b / sin(beta); with
        b_mm alone the twist is the acute one; neither: beta = 70 deg
    design_deg : driving angle of the design pose, in which files and pictures show the kit
    """

    kind: Literal["bennett"] = "bennett"
    a_mm: Positive = 100.0
    alpha_deg: Twist = 40.0
    b_mm: Positive | None = None
    beta_deg: Twist | None = None
    design_deg: Angle = 90.0

    def mechanism(self, folder: Path | None = None) -> Mechanism:
        """The mechanism; raises `InputError` where lengths and twists do not fit."""
        beta = self.beta_deg
        if self.b_mm is None and beta is None:
            beta = BENNETT_BETA_DEG
        return bennett(
            self.a_mm,
            np.radians(self.alpha_deg),
            b=self.b_mm,
            beta=None if beta is None else float(np.radians(beta)),
            driver=float(np.radians(self.design_deg)),
        )


class CubeLinkage(Section):
    """[linkage] kind = "cube": 12 bars on 8 hinges, six isograms, two degrees of freedom.

    Attributes
    ----------
    twists_deg : of the bars of the three directions, all different
    longest_mm : length of the longest bars; the others follow from the twists
    corners_deg : angles at hinge 0 in the design pose, from its bar of direction 0 to the others
    rates : how the two angles move along the path, in proportion; [1, 0] locks the second, [1, -1]
        opens both alike. The default is a way on which the bars stay clear of each other longest
    """

    kind: Literal["cube"] = "cube"
    twists_deg: tuple[Twist, Twist, Twist] = Field(default=(58.0, 131.0, 50.0), strict=False)
    longest_mm: Positive = 110.0
    corners_deg: tuple[Finite, Finite] = Field(default=(123.0, 45.0), strict=False)
    rates: tuple[Finite, Finite] = Field(default=(8.0, -5.0), strict=False)

    def mechanism(self, folder: Path | None = None) -> Mechanism:
        """The mechanism; raises `InputError` where the twists make isograms that only fold."""
        twists = np.radians(self.twists_deg)
        lengths = self.longest_mm * np.sin(twists) / np.sin(twists).max()
        first, second = np.radians(self.corners_deg).tolist()
        return cube(lengths.tolist(), twists.tolist(), corners=(first, second), rates=self.rates)


class KNetLinkage(Section):
    """[linkage] kind = "knet": every quad of a K-net is an isogram; m + n - 1 degrees of freedom.

    The net comes from a file, or from a surface by name.

    Attributes
    ----------
    file : OBJ, OFF or PLY of a K-net that is a grid, relative to the project file
    patch : [i0, i1, j0, j1], the vertices of the file that are taken, ends included
    surface : "cauchy" (two lines of constant turns), "amsler", "pseudosphere", "dini", "breather"
        or "kuen"
    parameters : the surface's own numbers: { corner_deg, turn_0_deg, turn_1_deg }, { angle_deg }
        between the straight lines, { psi_deg } and { sigma_deg, psi_deg } (90 at the rim), { tau,
        phase_deg }, { shift }; they also choose the part of the surface
    cells : of a surface: number of cells in both directions
    deltas_deg : of a surface: twists of the bars in both directions; none: 20, and where there are
        more than three cells less, 60 through all of them, so that the net does not meet itself
    longest_mm : length of the longest bars; all are scaled
    anchor : vertex of the driving angle; by default the one in the middle
    path : "locked" keeps the turns of the two lines through the anchor and moves the angle between
        them; "fold" shrinks all, towards the bundle of bars
    """

    kind: Literal["knet"] = "knet"
    file: Path | None = Field(default=None, strict=False)
    patch: tuple[Index, Index, Index, Index] | None = Field(default=None, strict=False)
    surface: str = "cauchy"
    parameters: dict[str, Finite] = Field(default_factory=dict)
    cells: tuple[Count, Count] = Field(default=(3, 3), strict=False)
    deltas_deg: tuple[Twist, Twist] | None = Field(default=None, strict=False)
    longest_mm: Positive = 80.0
    anchor: tuple[Index, Index] | None = Field(default=None, strict=False)
    path: Literal["locked", "fold"] = "locked"

    @classmethod
    def choices(cls) -> Mapping[str, Sequence[str]]:
        """The surfaces."""
        return {"surface": tuple(SURFACES)}

    @model_validator(mode="after")
    def _one_source(self) -> KNetLinkage:
        made = [name for name in MADE if name in self.changed()]
        if self.file is not None and made:
            raise ValueError(f"file and {made[0]} exclude each other")
        if self.patch is not None and self.file is None:
            raise ValueError("patch is for file")
        check_numbers(self.surface, self.parameters)
        return self

    @property
    def twists_deg(self) -> tuple[float, float]:
        """Twists [deg] of the bars in both directions of a surface."""
        twist = min(TWIST_DEG, TURN_DEG / max(self.cells))
        return self.deltas_deg or (twist, twist)

    def mechanism(self, folder: Path | None = None) -> Mechanism:
        """The mechanism; a file is looked for from `folder`.

        Raises
        ------
        InputError, MeshError
            The file is not a K-net: names the worst vertices and their defect. The patch or anchor
            is not in the net.
        """
        net = self.net(folder)
        longest = net.r * max(float(np.sin(delta).max()) for delta in net.deltas)
        return knet_mechanism(
            net, scale_mm=self.longest_mm / longest, anchor=self.anchor, path=self.path
        )

    def net(self, folder: Path | None = None) -> KNet:
        """The K-net itself, in its own unit."""
        if self.file is None:
            alphas, betas = (
                np.full(count, np.radians(delta))
                for count, delta in zip(self.cells, self.twists_deg, strict=True)
            )
            return surface_net(self.surface, alphas, betas, self.parameters)
        path = self.file if folder is None else folder / self.file
        try:
            return recover_knet(self._patch(Net.from_mesh(read_mesh(path).mesh))).knet
        except InputError as error:
            raise type(error)(f"{path}: {error}" if error.file is None else str(error)) from None

    def _patch(self, net: Net) -> Floats:
        """Points of the part of a net that is taken."""
        points = np.asarray(net.points)
        if self.patch is None:
            return points
        i0, i1, j0, j1 = self.patch
        rows, columns = points.shape[:2]
        if not (i0 < i1 < rows and j0 < j1 < columns):
            raise InputError(
                f"patch {list(self.patch)}: the net has vertices 0..{rows - 1} x 0..{columns - 1}, "
                "and the second of each pair is greater than the first"
            )
        return points[i0 : i1 + 1, j0 : j1 + 1]


class CrabLinkage(Section):
    """[linkage] kind = "crab": rings of isograms closed around an axis, which open like a basket.

    Attributes
    ----------
    around : number of hinges on a ring
    rings : number of rings of hinges
    twist_deg : of all bars; those of the two directions have opposite hands
    design_deg : driving angle of the design pose: of the axes of ring 0 with the net's axis
    length_mm : of all bars
    """

    kind: Literal["crab"] = "crab"
    around: Annotated[int, Field(ge=3, le=60)] = 5
    rings: Annotated[int, Field(ge=3, le=60)] = 4
    twist_deg: Twist = 40.0
    design_deg: Angle = 45.0
    length_mm: Positive = 80.0

    def mechanism(self, folder: Path | None = None) -> Mechanism:
        """The mechanism; raises `InputError` or `DegenerateError` where no such net exists."""
        net = crab_net(
            self.around, np.radians(self.twist_deg), np.radians(self.design_deg), self.rings
        )
        return crab_mechanism(net, scale_mm=self.length_mm / net.edge_length)
