"""Published values of the room stay; ``tests/published_values.py`` says what they are and how to change them."""

from published_values import differences


def test_published_values_are_those_of_the_file() -> None:
    assert differences("prediction") == []
