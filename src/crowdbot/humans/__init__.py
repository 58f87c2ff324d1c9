"""Human bodies: walking animation, capsules for contacts and range sensors, skins for cameras."""

from .activities import ACTIVITIES
from .feet import Gaits
from .gait import Gait, posing_and_skinning
from .limbs import LIMBS, REGIONS, Limb, mass_shares
from .people import Capsules, People
from .person import Person, names, person, persons
from .posture import Posture
from .seat import CHAIR, WHEELCHAIR, Seat
from .wardrobe import Outfit, outfit

__all__ = [
    "ACTIVITIES",
    "CHAIR",
    "LIMBS",
    "REGIONS",
    "WHEELCHAIR",
    "Capsules",
    "Gait",
    "Gaits",
    "Limb",
    "Outfit",
    "People",
    "Person",
    "Posture",
    "Seat",
    "mass_shares",
    "names",
    "outfit",
    "person",
    "persons",
    "posing_and_skinning",
]
