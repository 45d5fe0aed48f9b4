"""Linkages: kinematics of Bennett isograms, cubes, whole K-nets and closed rotational nets."""

from ddgfab.linkages.crab import crab_mechanism
from ddgfab.linkages.instant_mobility import mobility
from ddgfab.linkages.isogram import bennett
from ddgfab.linkages.isogram_cube import cube
from ddgfab.linkages.knet_flex import flex
from ddgfab.linkages.mechanism import Mechanism, Pose, bar_lengths, signed_twists
from ddgfab.linkages.whole import knet_mechanism

__all__ = [
    "Mechanism",
    "Pose",
    "bar_lengths",
    "bennett",
    "crab_mechanism",
    "cube",
    "flex",
    "knet_mechanism",
    "mobility",
    "signed_twists",
]
