"""Navigators that wrap another navigator: a safety layer, and a map of the last scans."""
