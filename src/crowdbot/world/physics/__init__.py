"""Physics: the world in which robots, people, walls and props have bodies, with forces between them."""

from .camera import Camera, Images
from .chassis import Chassis
from .collisions import BodyForce, Collision
from .solids import bodies
from .stage import Cube, Light, PhysicsStage, Prop, Table, Tree
from .studio import Studio
from .tissue import TISSUES, Tissue, permitted_speed, region_of, two_body_force
from .touches import Party
from .walkers import Limbs, Walkers
from .world import PhysicsWorld

__all__ = [
    "TISSUES",
    "BodyForce",
    "Camera",
    "Chassis",
    "Collision",
    "Cube",
    "Images",
    "Light",
    "Limbs",
    "Party",
    "PhysicsStage",
    "PhysicsWorld",
    "Prop",
    "Studio",
    "Table",
    "Tissue",
    "Tree",
    "Walkers",
    "bodies",
    "permitted_speed",
    "region_of",
    "two_body_force",
]
