"""Validation of crowd models against experiments with people and the RiMEA tests."""

from .contact_table import CONTACT_REASONS, CONTACT_SECONDS, OTHER_VALUES, compare_contacts, write_contact_page
from .contacts import ContactSummary, measure_contacts
from .page import write_page
from .run import CHECKS, CheckOutcome, Validation, select_models, validate
from .scenario import Check, Verdict

__all__ = [
    "CHECKS",
    "CONTACT_REASONS",
    "CONTACT_SECONDS",
    "OTHER_VALUES",
    "Check",
    "CheckOutcome",
    "ContactSummary",
    "Validation",
    "Verdict",
    "compare_contacts",
    "measure_contacts",
    "select_models",
    "validate",
    "write_contact_page",
    "write_page",
]
