"""Wheels on the floor of the physics world: friction of sliding tyres and of rollers, and control of skid steering."""
