"""Validation of crowd models against experiments with people and the RiMEA tests."""

from .page import write_page
from .run import CHECKS, CheckOutcome, Validation, select_models, validate
from .scenario import Check, Verdict

__all__ = ["CHECKS", "Check", "CheckOutcome", "Validation", "Verdict", "select_models", "validate", "write_page"]
