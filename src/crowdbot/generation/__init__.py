"""Generated data: sensor readings with ground truth, from trials and many seeds, as shards with a data card."""

from .card import DataCard, card_of, card_text, generate
from .episode_labels import LABEL_FORMATS, LabelFiles, export_labels
from .plan import FORMATS, RECIPES, GenerationPlan, Recipe, ShardJob
from .sample_log import SampleLog, occluded_shares
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
    "generate",
    "make_shard",
    "occluded_shares",
]
