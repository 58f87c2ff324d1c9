"""Presets of commercial sensors. Each value has a source or is marked as assumed."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

from crowdbot.core import UnknownName

from .depth_camera import DepthCamera
from .lidar import Lidar2D
from .lidar3d import Lidar3D
from .noise import Gaussian
from .range_finders import SLIM, Infrared, Ultrasound
from .realism import PulsedLidar2D
from .sensor import Sensor

ASSUMED = "assumed: "
"""Prefix of the source of an assumed value."""


@dataclass(frozen=True)
class SensorPreset:
    """A sensor with the values of a product and their sources.

    Fields:
        sensor: the sensor without noise.
        noisy: the sensor with the noise of the product.
        sources: source of the value of each field; ``assumed: ...`` if no source was found.
    """

    sensor: Sensor
    noisy: Sensor
    sources: Mapping[str, str]


def preset(name: str, *, noisy: bool = False) -> Sensor:
    """Return the sensor of a product.

    Raises:
        UnknownName: there is no preset of this name.

    >>> preset("hokuyo-utm-30lx").range_max
    30.0
    """
    if name not in PRESETS:
        raise UnknownName("sensor preset", name, PRESETS)
    return PRESETS[name].noisy if noisy else PRESETS[name].sensor


def _made(sensor: Sensor, sources: dict[str, str], noise: float = 0.0, **stereo: Any) -> SensorPreset:
    changes: dict[str, Any] = stereo or {"noise": Gaussian(noise) if noise else ()}
    return SensorPreset(sensor, replace(sensor, **changes), MappingProxyType(sources))


SCIP = "Hokuyo, Communication protocol specification for SCIP 2.0, C-42-03320B"
UTM_SHEET = "Hokuyo UTM-30LX specification sheet, as quoted in docs/source/laser.rst of github.com/Gastd/cacic"
TIM_SHEET = "SICK TiM55x/TiM56x operating instructions 8015886/YDR0 (the same family)"
TIM_DRIVER = "SICK, README of github.com/SICKAG/sick_scan, TiM571"
TIM_INFO = "SICK, TiM55x/56x/57x technical information 8015883"
TIM8_SHEET = "SICK, TiM8xxP operating instructions 8024355, section 3.7.4 (a newer scanner of the family)"
SLAMTEC = "Slamtec, RPLIDAR A2M8 introduction and datasheet, revision 2.5"
VELODYNE = "Velodyne, VLP-16 user manual 63-9243"
INTEL = "Intel RealSense white papers on D400: tuning (revision 2.0) and subpixel linearity (revision 1.3)"
LASERS = "Aldebaran, Pepper technical overview 2.0, lasers (doc.aldebaran.com/2-0)"
SONARS = "Aldebaran, Pepper technical overview 2.0, sonars (doc.aldebaran.com/2-0)"
CROWDBOT = "CrowdBot simulator, Pepper model (github.com/FabienGrzeskowiakInria/CrowdBot_robots)"

_UTM_30LX: dict[str, Any] = {
    "rays": 1081,
    "field_of_view": math.radians(270.0),
    "range_min": 0.1,
    "range_max": 30.0,
    "resolution": 0.001,
    "rate": 40.0,
}
_UTM_30LX_SOURCES = {
    "rays": f"{SCIP}, table 2 (steps 0 to 1080)",
    "field_of_view": f"{UTM_SHEET} (270 deg, 0.25 deg)",
    "range_min": UTM_SHEET,
    "range_max": UTM_SHEET,
    "resolution": f"{SCIP} (distances in whole millimetres)",
    "rate": f"{UTM_SHEET} (25 ms a scan)",
    "noise": f"{UTM_SHEET} (sd under 10 mm up to 10 m, under 30 mm beyond); 10 mm taken for all",
}
_TIM571: dict[str, Any] = {
    "rays": 811,
    "field_of_view": math.radians(270.0),
    "range_min": 0.05,
    "range_max": 25.0,
    "resolution": 0.001,
    "rate": 15.0,
}
_TIM571_SOURCES = {
    "rays": f"{TIM_DRIVER} (0.33 deg: 811 in 270 deg)",
    "field_of_view": f"{TIM_INFO} (-45 to +225 deg)",
    "range_min": ASSUMED + "0.05 m",
    "range_max": TIM_DRIVER,
    "resolution": ASSUMED + "whole millimetres",
    "rate": TIM_DRIVER,
    "noise": f"{TIM_SHEET} (statistical error 20 mm; a systematic one of up to 60 mm is left out)",
}

_PRESETS = {
    "hokuyo-utm-30lx": _made(Lidar2D(**_UTM_30LX), _UTM_30LX_SOURCES, noise=0.01),
    "hokuyo-urg-04lx": _made(
        Lidar2D(
            rays=682,
            field_of_view=681.0 * math.radians(360.0 / 1024.0),
            range_min=0.02,
            range_max=5.6,
            resolution=0.001,
            rate=10.0,
        ),
        {
            "rays": f"{SCIP}, table 2 (steps 44 to 725)",
            "field_of_view": f"{SCIP}, table 2 (360/1024 deg a step)",
            "range_min": f"{SCIP}, section 8.12 (DMIN 20 mm)",
            "range_max": f"{SCIP}, section 8.12 (DMAX 5600 mm); the accuracy holds up to 4 m",
            "resolution": f"{SCIP} (distances in whole millimetres)",
            "rate": f"{SCIP}, section 8.12 (600 rpm)",
            "noise": ASSUMED + "10 mm, of the size of the accuracy within 1 m",
        },
        noise=0.01,
    ),
    "sick-tim571": _made(Lidar2D(**_TIM571), _TIM571_SOURCES, noise=0.02),
    "sick-tim571-pulsed": _made(
        PulsedLidar2D(**_TIM571, scan_time=0.05, beam_width=0.0144, pulse_length=0.75, range_10=8.0),
        _TIM571_SOURCES
        | {
            "scan_time": f"{TIM_INFO}, measured value output (15 turns a second, 270 of 360 deg in 50 ms)",
            "beam_width": f"{TIM8_SHEET}: 8.6 mrad and 5.8 mrad of overlapping pulses",
            "pulse_length": f"{TIM_SHEET}: pulses of at most 5 ns, half of 1.5 m",
            "range_10": ASSUMED + "8 m",
        },
        noise=0.02,
    ),
    "hokuyo-utm-30lx-pulsed": _made(
        PulsedLidar2D(**_UTM_30LX, scan_time=0.01875),
        _UTM_30LX_SOURCES | {"scan_time": f"{UTM_SHEET}: 270 of the 360 deg of 25 ms"},
        noise=0.01,
    ),
    "rplidar-a2": _made(
        Lidar2D(rays=800, range_min=0.2, range_max=12.0, resolution=0.0005, rate=10.0),
        {
            "rays": f"{SLAMTEC} (8000 samples a second, 0.45 deg at 10 Hz)",
            "field_of_view": f"{SLAMTEC} (360 deg)",
            "range_min": ASSUMED + "0.2 m",
            "range_max": SLAMTEC,
            "resolution": ASSUMED + "0.5 mm, which the data sheet of the A1 says for under 1.5 m",
            "rate": SLAMTEC,
            "noise": ASSUMED + "10 mm; the data sheets say less than 1 % of the distance",
        },
        noise=0.01,
    ),
    "velodyne-vlp-16": _made(
        Lidar3D(columns=1800, range_min=1.0, range_max=100.0, resolution=0.002, rate=10.0),
        {
            "elevations": f"{VELODYNE} (16 channels, -15 to +15 deg, 2 deg apart)",
            "columns": f"{VELODYNE} (0.1 to 0.4 deg; 0.2 deg at 600 rpm, 1800 for round numbers)",
            "range_min": f"{VELODYNE}, as quoted in issue 60 of github.com/ros-drivers/velodyne (1 m to 100 m)",
            "range_max": VELODYNE,
            "resolution": f"{VELODYNE}, section 9.3.1.3 (granularity of 2 mm)",
            "rate": f"{VELODYNE} (5 to 20 Hz)",
            "noise": f"{VELODYNE} (accuracy of 3 cm, typical), taken as a standard deviation",
        },
        noise=0.03,
    ),
    "realsense-d435": _made(
        DepthCamera(
            width=848,
            height=480,
            field_of_view=math.radians(90.0),
            range_min=0.2,
            range_max=10.0,
            resolution=0.001,
            rate=30.0,
        ),
        {
            "width": f"{INTEL} (848 x 480 is best for the D435)",
            "height": INTEL,
            "field_of_view": f"{INTEL} (90 deg)",
            "range_min": ASSUMED + "0.2 m at 848 x 480",
            "range_max": "Intel community, D435 (up to 10 m)",
            "resolution": ASSUMED + "depth units of 1 mm",
            "rate": ASSUMED + "30 Hz",
            "baseline": "Intel community, D435 (50 mm)",
            "disparity_noise": ASSUMED + "0.08 pixels on a well textured wall",
            "disparity_step": f"{INTEL} (1/32 pixel)",
        },
        baseline=0.05,
        disparity_noise=0.08,
        disparity_step=1.0 / 32.0,
    ),
    "pepper-laser": _made(
        Lidar2D(rays=15, field_of_view=math.radians(60.0), range_min=0.1, range_max=3.0, rate=20.0 / 3.0),
        {
            "rays": ASSUMED + "15, as many segments as NAOqi's memory keys have",
            "field_of_view": f"{LASERS} (beam angle 60 deg)",
            "range_min": ASSUMED + "0.1 m",
            "range_max": ASSUMED + "3 m",
            "rate": f"{LASERS} (6.66 Hz a laser)",
            "noise": ASSUMED + "none",
        },
    ),
    "pepper-lidar-crowdbot": _made(
        Lidar2D(rays=481, field_of_view=math.radians(240.0), range_min=0.2, range_max=50.0, rate=6.25),
        {
            "rays": f"{CROWDBOT} (0.5 deg)",
            "field_of_view": f"{CROWDBOT} (240 deg)",
            "range_min": CROWDBOT,
            "range_max": CROWDBOT,
            "rate": CROWDBOT,
            "noise": f"{CROWDBOT} (0)",
        },
    ),
    "pepper-sonar": _made(
        Ultrasound(
            radius=round(2.0 * math.tan(math.radians(30.0)) * 2.5 / SLIM, 9),
            range_min=0.15,
            range_max=2.5,
            resolution=0.03,
            rate=10.0,
        ),
        {
            "radius": f"{SONARS} (effective cone 60 deg)",
            "rays": ASSUMED + "400",
            "range_min": SONARS,
            "range_max": f"{SONARS} (operational to 2.5 m, detection to 6.45 m)",
            "resolution": SONARS,
            "rate": ASSUMED + "10 Hz",
            "noise": ASSUMED + "none",
        },
    ),
    "pepper-infrared": _made(
        Infrared(dispersion=math.radians(0.5), max_incidence=math.radians(45.0), rate=6.25),
        {
            "dispersion": f"{CROWDBOT}, default of its infrared sensor",
            "max_incidence": f"{CROWDBOT}, default of its infrared sensor",
            "rays": f"{CROWDBOT}, default of its infrared sensor (100)",
            "rate": f"{CROWDBOT}, default of its sensors",
            "range_min": ASSUMED + "0.05 m",
            "range_max": ASSUMED + "1.5 m",
            "noise": ASSUMED + "none",
        },
    ),
}
PRESETS: Mapping[str, SensorPreset] = MappingProxyType(_PRESETS)
"""Presets by name."""
