"""The shipped schema of trials in the hands of an independent validator."""

from lxml import etree

from crowdbot.trials import schema

SCHEMA = etree.XMLSchema(etree.fromstring(schema().encode()))


def valid(text: str) -> bool:
    """Whether a trial has the form that the schema asks for."""
    return bool(SCHEMA.validate(etree.fromstring(text.encode())))
