"""Hashes in kernels."""
