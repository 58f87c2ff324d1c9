"""Human bodies: walking animation, capsules for contacts and range sensors, skins for cameras."""

from .activities import ACTIVITIES
from .asset import LEVELS, shapes
from .body_pose import BodyPose
from .body_reach import eye_offsets, reach_poses
from .effective_mass import limb_chain, striking_mass
from .feet import Gaits
from .gait import Gait, posing_and_skinning
from .limbs import LIMBS, REGIONS, Limb, mass_shares
from .people import Capsules, People
from .person import Person, names, person, persons
from .pose_file import read_pose_file
from .pose_source import PoseMotion, PoseSource, PoseTrack
from .posture import Posture
from .rest_bones import RestSkeleton, rest_skeleton
from .seat import CHAIR, WHEELCHAIR, Seat
from .uneven import ankle_positions, stand_on_ground
from .wardrobe import Outfit, outfit, region_colors, worn_parts

__all__ = [
    "ACTIVITIES",
    "CHAIR",
    "LEVELS",
    "LIMBS",
    "REGIONS",
    "WHEELCHAIR",
    "BodyPose",
    "Capsules",
    "Gait",
    "Gaits",
    "Limb",
    "Outfit",
    "People",
    "Person",
    "PoseMotion",
    "PoseSource",
    "PoseTrack",
    "Posture",
    "RestSkeleton",
    "Seat",
    "ankle_positions",
    "eye_offsets",
    "limb_chain",
    "mass_shares",
    "names",
    "outfit",
    "person",
    "persons",
    "posing_and_skinning",
    "reach_poses",
    "read_pose_file",
    "region_colors",
    "rest_skeleton",
    "shapes",
    "stand_on_ground",
    "striking_mass",
    "worn_parts",
]
