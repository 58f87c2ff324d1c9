"""Published reference values with their sources."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.typing import Floats

from .scenario import FREE_SPEED

SPECIFIC_FLOW = 1.9
"""Persons per second and metre of width through a bottleneck, Seyfried et al. 2009."""

BOTTLENECK_FLOWS = (
    (0.9, 1.71),
    (1.0, 2.02),
    (1.1, 2.19),
    (1.2, 2.53),
    (1.4, 2.91),
    (1.6, 3.11),
    (1.8, 3.91),
    (2.0, 3.91),
    (2.2, 4.52),
    (2.5, 5.55),
)
"""Width [m] and flow [1/s] of Liddle et al. 2009: 150 people, first to last; also used in the validation tests of
JuPedSim.
"""

SOURCES = (
    "Weidmann 1993, Transporttechnik der Fussgänger, ETH Zürich, Schriftenreihe des IVT 90,"
    " doi:10.3929/ethz-a-000687810",
    "Seyfried, Steffen, Klingsch, Boltes 2005, The fundamental diagram of pedestrian movement revisited,"
    " doi:10.1088/1742-5468/2005/10/P10002",
    "Steffen, Seyfried 2010, Methods for measuring pedestrian density, flow, speed and direction with minimal scatter,"
    " doi:10.1016/j.physa.2009.12.015 (density by Voronoi cells)",
    "Zhang, Klingsch, Schadschneider, Seyfried 2011, Transitions in pedestrian fundamental diagrams of straight"
    " corridors and T-junctions, doi:10.1088/1742-5468/2011/06/P06004 (the HERMES corridor runs)",
    "Rex, Löwen 2007, Lane formation in oppositely charged colloids driven by an electric field,"
    " doi:10.1103/PhysRevE.75.051402; Nowak, Schadschneider 2012, Quantitative analysis of pedestrian counterflow,"
    " doi:10.1103/PhysRevE.85.046128 (order parameter of lanes)",
    "Zhang, Klingsch, Schadschneider, Seyfried 2012, Ordering in bidirectional pedestrian flows and its influence on"
    " the fundamental diagram, doi:10.1088/1742-5468/2012/02/P02002 (two-way flows that move at 2 people/m2 and more)",
    "Seyfried, Passon, Steffen, Boltes, Rupprecht, Klingsch 2009, New insights into pedestrian flow through"
    " bottlenecks, doi:10.1287/trsc.1090.0263",
    "Liddle, Seyfried, Klingsch, Rupprecht, Schadschneider, Winkens 2009, An experimental study of pedestrian"
    " congestions: influence of bottleneck width and length, arXiv:0911.4350",
    "Adrian, Seyfried, Sieben 2020, Crowds in front of bottlenecks at entrances from the perspective of physics and"
    " social psychology, doi:10.1098/rsif.2019.0871 (run 040_c_56_h-)",
    "RiMEA e.V. 2016, Guideline for microscopic evacuation analysis, version 3.0.0",
)


def weidmann_speed(density: ArrayLike) -> Floats:
    """Return Weidmann's speed [m/s] over the density [1/m2] of a crowd in a plane.

    >>> weidmann_speed([0.5, 2.0]).round(2).tolist()
    [1.3, 0.61]
    """
    inverse = 1.0 / np.asarray(density, dtype=np.float64)
    return np.asarray(FREE_SPEED * np.clip(1.0 - np.exp(-1.913 * (inverse - 1.0 / 5.4)), 0.0, 1.0))


def line_speed(density: ArrayLike) -> Floats:
    """Return the speed [m/s] of a single file over its line density [1/m]: 1 / density = 0.36 m + 1.06 s * speed.

    Seyfried et al. 2005, cut at the free speed.

    >>> line_speed([0.5, 1.0, 2.0]).round(2).tolist()
    [1.34, 0.6, 0.13]
    """
    inverse = 1.0 / np.asarray(density, dtype=np.float64)
    return np.asarray(np.clip((inverse - 0.36) / 1.06, 0.0, FREE_SPEED))
