"""Readers of the supported file formats, one file per source program."""
