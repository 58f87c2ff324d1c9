"""Human bodies: walking animation, capsules for contacts and range sensors, skins for cameras."""

from .activities import ACTIVITIES
from .asset import LEVELS, Person, names, person, persons, shapes
from .body_pose import BodyPose, PoseMotion, PoseSource, PoseTrack, read_pose_file
from .body_reach import eye_offsets, reach_poses
from .clip import Bvh, Clip, clip_of, read_bvh, read_clip, write_clip
from .fall_pose import LYING, FallPose, blend_fall_poses, fall_postures
from .feet import Gaits
from .gait import CHAIR, WHEELCHAIR, Gait, Seat, posing_and_skinning
from .garments import LONG, SHORT, drape
from .keypoints import KEYPOINT_EDGES, KEYPOINTS, RestSkeleton, keypoint_places, rest_skeleton
from .limbs import LIMBS, REGIONS, Limb, limb_chain, mass_shares, striking_mass
from .people import Capsules, People
from .posture import Posture
from .rigged.body_rows import BodyRows
from .rigged.importer import ImportedBody, import_body, material_picture
from .rigged.rigged_body import BODY_NAME, RiggedBody, RiggedLevel, read_body, write_body
from .uneven import ankle_positions, stand_on_ground
from .wardrobe import Outfit, body_uv, outfit, paint_body, region_colors, worn_parts

__all__ = [
    "ACTIVITIES",
    "BODY_NAME",
    "CHAIR",
    "KEYPOINTS",
    "KEYPOINT_EDGES",
    "LEVELS",
    "LIMBS",
    "LONG",
    "LYING",
    "REGIONS",
    "SHORT",
    "WHEELCHAIR",
    "BodyPose",
    "BodyRows",
    "Bvh",
    "Capsules",
    "Clip",
    "FallPose",
    "Gait",
    "Gaits",
    "ImportedBody",
    "Limb",
    "Outfit",
    "People",
    "Person",
    "PoseMotion",
    "PoseSource",
    "PoseTrack",
    "Posture",
    "RestSkeleton",
    "RiggedBody",
    "RiggedLevel",
    "Seat",
    "ankle_positions",
    "blend_fall_poses",
    "body_uv",
    "clip_of",
    "drape",
    "eye_offsets",
    "fall_postures",
    "import_body",
    "keypoint_places",
    "limb_chain",
    "mass_shares",
    "material_picture",
    "names",
    "outfit",
    "paint_body",
    "person",
    "persons",
    "posing_and_skinning",
    "reach_poses",
    "read_body",
    "read_bvh",
    "read_clip",
    "read_pose_file",
    "region_colors",
    "rest_skeleton",
    "shapes",
    "stand_on_ground",
    "striking_mass",
    "worn_parts",
    "write_body",
    "write_clip",
]
