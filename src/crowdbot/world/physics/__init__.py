"""Physics: the world in which robots, people, walls and props have bodies, with forces between them."""

from .camera import Camera, Images
from .chassis import Chassis
from .collisions import BodyForce, Collision
from .stage import Cube, Light, PhysicsStage, Prop, Table, Tree
from .tissue import TISSUES, Tissue, permitted_speed, region_of, two_body_force
from .touches import Party
from .walkers import Limbs
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
    "Table",
    "Tissue",
    "Tree",
    "permitted_speed",
    "region_of",
    "two_body_force",
]
