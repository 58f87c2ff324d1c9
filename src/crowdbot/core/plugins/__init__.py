"""Plugins: classes by name or address, and their fields from text."""
