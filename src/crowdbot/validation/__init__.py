"""Validation of crowd models against experiments with people and the RiMEA tests."""

from .contacts import (
    CONTACT_REASONS,
    CONTACT_SECONDS,
    OTHER_VALUES,
    ContactSummary,
    compare_contacts,
    measure_contacts,
    write_contact_page,
)
from .page import write_page
from .rimea import ISO_CASES, RIMEA_CASES, Case
from .run import CHECKS, STUDIES, CheckOutcome, Validation, select_models, validate, variant_of
from .scenario import Check, Verdict

__all__ = [
    "CHECKS",
    "CONTACT_REASONS",
    "CONTACT_SECONDS",
    "ISO_CASES",
    "OTHER_VALUES",
    "RIMEA_CASES",
    "STUDIES",
    "Case",
    "Check",
    "CheckOutcome",
    "ContactSummary",
    "Validation",
    "Verdict",
    "compare_contacts",
    "measure_contacts",
    "select_models",
    "validate",
    "variant_of",
    "write_contact_page",
    "write_page",
]
