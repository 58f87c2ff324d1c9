"""Which fields of a running simulation are its state, and which are constants of its trial.

Each class that holds state is listed with its constant fields. All other fields are stored, so that a new field is
stored by itself or, if it holds an object of a class that is not listed, is refused by the tests of built-in trials.
"""

from __future__ import annotations

import dataclasses
import importlib
from typing import Any

__all__ = [
    "AVATARS",
    "ENVIRONMENT_TIME",
    "constants_of",
    "holder_fields",
    "is_holder",
    "qualified",
    "value_class",
    "value_name",
]

AVATARS = "crowdbot.world.crowd.avatars.Avatars"
"""Stored with the sources that take samples from outside."""
ENVIRONMENT_TIME = "crowdbot.world.environment_time.EnvironmentTime"
"""Stored as the ticks of the environments: a stored state continues on another clock."""

LAST = "readings"
"""A field that refers to robots, which are stored before it."""

HOLDERS = {
    "crowdbot.simulation.simulation.Simulation": "trial people around _ways_out _template",
    "crowdbot.simulation.robot_control.RobotControl": "robot agent limits control wanted planner",
    "crowdbot.simulation.decision_timer.DecisionTimer": "recorded clock spent _warm",
    "crowdbot.simulation.faults.fault_state.FaultState": "faults names",
    "crowdbot.simulation.mounted_sensor.MountedSensor": (
        "mount placed schedule space together wheels lateness keeps_people"
    ),
    "crowdbot.world.planar.PlanarWorld": (
        "model drives dt seed leave_radius robot_margin router contact limits journeys sources exits portals script"
        " heading_jitter substeps latency ghosts reactions joined _models _segments _surfaces _plain_router"
    ),
    "crowdbot.world.physics.world.PhysicsWorld": (
        "stage physics_dt _steps _outlined _plane _renderers _prop_names _slots_fixed"
    ),
    "crowdbot.world.environments.PhysicsBatch": "dt _stacked",
    "crowdbot.world.environments.PlanarBatch": "dt _stacked",
    "crowdbot.world.physics.world_bodies.WorldBodies": "walls step stage starts slots reader links model",
    "crowdbot.world.physics.rigid_bodies.RigidBodies": "compiled data",
    AVATARS: "agents names sources delay robots _latest",
    "crowdbot.world.crowd.people_flow.PeopleFlow": "router journeys mixture",
    "crowdbot.world.crowd.arrivals.Arrivals": "_first_journey _fresh",
    "crowdbot.world.crowd.arrivals._Queues": "sources",
    "crowdbot.world.physics.robots.robot_body.RobotBody": (
        "robot prefix step _model _data _mj body _sites _servo _wheels _steers _step_robots _rolling _delay _slip"
        " friction _forces _lag _base"
    ),
    "crowdbot.world.physics.people_bodies.PeopleBodies": "pushes _model _data step geoms bodies _place _speed _hold",
    "crowdbot.world.physics.people_motion.PeopleMotion": "agents people row gait radius ground",
    "crowdbot.world.physics.balance.falling_people.FallingPeople": "get_up",
    "crowdbot.world.physics.balance.balance.Balance": "rate center base reach",
    "crowdbot.world.physics.kinematic_bodies.KinematicBodies": "robots stage walls _renderer doors",
    "crowdbot.world.doors.doors.Doors": "leaves pushed _walls _routers _base",
    "crowdbot.world.physics.contact_events.BodyContactTracker": "_step _window _mass_of _limb_mass_of _heading_of",
}
"""Classes of objects that exist in a new simulation of the trial, with their constant fields."""

VALUES = {
    "Bodies": "crowdbot.core.bodies",
    "BodyContactEvent": "crowdbot.world.physics.contact_events",
    "BodyPose": "crowdbot.humans.body_pose",
    "BodyShapes": "crowdbot.world.physics.body_shapes",
    "BumperReading": "crowdbot.sensors.bumper",
    "Contact": "crowdbot.world.world",
    "ContactBody": "crowdbot.world.physics.contacts",
    "ContactForce": "crowdbot.world.physics.contact_events",
    "DepthImage": "crowdbot.sensors.depth_camera",
    "Fall": "crowdbot.world.physics.balance.fall",
    "FallPose": "crowdbot.humans.falls.fall_pose",
    "Gaits": "crowdbot.humans.feet",
    "ImuReading": "crowdbot.sensors.imu",
    "ImuState": "crowdbot.sensors.imu",
    "Odometry": "crowdbot.sensors.odometry.wheel_odometry",
    "OdometryState": "crowdbot.sensors.odometry.wheel_odometry",
    "Pending": "crowdbot.world.robots.drives.servo",
    "PointCloud": "crowdbot.sensors.lidar3d",
    "Pose": "crowdbot.core.pose",
    "PoseTrack": "crowdbot.humans.pose_source",
    "RangeReading": "crowdbot.sensors.range_reading",
    "PulsedScan": "crowdbot.sensors.realism.pulsed_lidar",
    "Reading": "crowdbot.sensors.sensor",
    "RgbImage": "crowdbot.sensors.rgb_camera",
    "RobotContact": "crowdbot.simulation.step_record",
    "RunFailure": "crowdbot.simulation.failure",
    "Scan": "crowdbot.sensors.lidar",
    "Scene": "crowdbot.core.scene",
    "SensorReadings": "crowdbot.simulation.mounted_sensor",
    "SpatialPose": "crowdbot.core.pose",
    "StateGroups": "crowdbot.sensors.state_rows",
    "SteeredTwists": "crowdbot.world.robots.drives.ackermann",
    "SweepState": "crowdbot.sensors.realism.moving_scene",
    "TrackBatch": "crowdbot.navigation.track_batch",
    "TrackHistory": "crowdbot.navigation.track_history",
    "TrackerState": "crowdbot.perception.tracker_state",
    "TrackedPeople": "crowdbot.sensors.ground_truth_people",
    "Tracks": "crowdbot.perception.tracks",
    "Twist": "crowdbot.core.pose",
    "Twists": "crowdbot.world.robots.drives.drive",
    "_Pressed": "crowdbot.world.physics.contact_events",
    "_Running": "crowdbot.world.physics.contact_events",
}
"""Classes of objects that a run creates, with their modules: dataclasses and named tuples of plain values."""


def qualified(kind: type) -> str:
    """Return module and name of a class."""
    return f"{kind.__module__}.{kind.__qualname__}"


def is_holder(value: Any) -> bool:
    """Return whether an object holds state and exists in every new simulation of the trial."""
    return qualified(type(value)) in HOLDERS


def constants_of(value: Any) -> frozenset[str]:
    """Return the names of the constant fields of such an object."""
    return frozenset(name for kind in type(value).__mro__ for name in HOLDERS.get(qualified(kind), "").split())


def holder_fields(value: Any) -> list[str]:
    """Return the names of the fields of such an object that are not constant."""
    names = dict.fromkeys(vars(value))
    if dataclasses.is_dataclass(value):
        names |= dict.fromkeys(field.name for field in dataclasses.fields(value))
    constant = constants_of(value)
    return sorted((name for name in names if name not in constant), key=lambda name: (name == LAST, name))


def value_name(value: Any) -> str | None:
    """Return the name of the class of a value that a run creates, None for other classes."""
    kind = type(value)
    return kind.__name__ if VALUES.get(kind.__name__) == kind.__module__ else None


def value_class(name: str) -> type[Any] | None:
    """Return a class by name, None for one that is not listed."""
    if name not in VALUES:
        return None
    kind: type[Any] = getattr(importlib.import_module(VALUES[name]), name)
    return kind
