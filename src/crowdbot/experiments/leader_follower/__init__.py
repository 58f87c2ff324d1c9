"""The experiment on leaders and followers: emulated participants and measures."""

from .emulated_participant import EmulatedParticipant
from .leader_follower_study import LeaderFollowerStudy
from .leading import roles_of

__all__ = ["EmulatedParticipant", "LeaderFollowerStudy", "roles_of"]
