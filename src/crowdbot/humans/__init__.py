"""Human bodies: walking animation, capsules for contacts and range sensors, skins for cameras."""

from .activities import ACTIVITIES
from .asset import LEVELS, shapes
from .body_pose import BodyPose
from .body_reach import eye_offsets, reach_poses
from .clips.bvh import Bvh, read_bvh
from .clips.clip import Clip, read_clip, write_clip
from .clips.retarget import clip_of
from .effective_mass import limb_chain, striking_mass
from .falls.fall_pose import LYING, FallPose, blend_fall_poses, fall_postures
from .feet import Gaits
from .gait import Gait, posing_and_skinning
from .limbs import LIMBS, REGIONS, Limb, mass_shares
from .looks.atlas import body_uv, paint_body
from .looks.keypoints import KEYPOINT_EDGES, KEYPOINTS, keypoint_places
from .people import Capsules, People
from .person import Person, names, person, persons
from .pose_file import read_pose_file
from .pose_source import PoseMotion, PoseSource, PoseTrack
from .posture import Posture
from .rest_bones import RestSkeleton, rest_skeleton
from .rigged.body_rows import BodyRows
from .rigged.importer import ImportedBody, import_body
from .rigged.picture import material_picture
from .rigged.rigged_body import BODY_NAME, RiggedBody, RiggedLevel, read_body, write_body
from .seat import CHAIR, WHEELCHAIR, Seat
from .uneven import ankle_positions, stand_on_ground
from .wardrobe import Outfit, outfit, region_colors, worn_parts

__all__ = [
    "ACTIVITIES",
    "BODY_NAME",
    "CHAIR",
    "KEYPOINTS",
    "KEYPOINT_EDGES",
    "LEVELS",
    "LIMBS",
    "LYING",
    "REGIONS",
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
