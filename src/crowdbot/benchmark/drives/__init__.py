"""The drive laboratory: how robots follow velocity commands in the physics world, beside the planar world."""
