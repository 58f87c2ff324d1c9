"""Bodies made of rigged characters of other programs."""
