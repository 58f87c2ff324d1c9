"""Validation: how the crowd models walk, against experiments with people and the RiMEA tests, as one page."""

from .page import write_page
from .run import CHECKS, Outcome, Validation, chosen, validate
from .scenario import Check, Verdict

__all__ = ["CHECKS", "Check", "Outcome", "Validation", "Verdict", "chosen", "validate", "write_page"]
