"""Readers of tracks in pictures of cameras."""
