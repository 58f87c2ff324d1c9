"""Generated data: sensor readings with ground truth, from trials and many seeds, as shards with a data card."""

from .card import DataCard, card_of, card_text
from .episode_labels import LABEL_FORMATS, LabelFiles, export_labels
from .generator import generate
from .occlusion import occluded_shares
from .plan import FORMATS, GenerationPlan, ShardJob
from .recipe import RECIPES, Recipe, find_recipe
from .sample_log import SampleLog
from .shard import Shard, make_shard

__all__ = [
    "FORMATS",
    "LABEL_FORMATS",
    "RECIPES",
    "DataCard",
    "GenerationPlan",
    "LabelFiles",
    "Recipe",
    "SampleLog",
    "Shard",
    "ShardJob",
    "card_of",
    "card_text",
    "export_labels",
    "find_recipe",
    "generate",
    "make_shard",
    "occluded_shares",
]
