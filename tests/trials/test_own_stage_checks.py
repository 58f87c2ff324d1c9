"""check_stage accepts stages with walls and room for a person."""

import pytest

from crowdbot.core import InputError
from crowdbot.trials import Stage, Wall, check_stage


@pytest.mark.parametrize("width", [0.62, 1.0, 8.0])
def test_a_stage_with_room_passes(width: float) -> None:
    assert check_stage(Stage(walkable=[(0, 0), (8, 0), (8, width), (0, width)])) is None


@pytest.mark.parametrize("width", [0.3, 0.59])
def test_a_stage_without_room_for_a_person_is_refused(width: float) -> None:
    with pytest.raises(InputError, match=r"no place for a person, 0.3 m from every wall"):
        check_stage(Stage(walkable=[(0, 0), (8, 0), (8, width), (0, width)]))


def test_a_stage_needs_walls() -> None:
    with pytest.raises(InputError, match="the stage has no walls"):
        check_stage(Stage())
    assert check_stage(Stage(walls=[Wall([(0.0, 0.0), (3.0, 4.0)])])) is None
