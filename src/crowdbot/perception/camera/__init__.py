"""Detectors of people in the images of a calibrated camera, as places on the floor."""

from .box_detector import BoxDetector, Boxes
from .hog_people import HogPeople
from .network_people import NetworkPeople

__all__ = ["BoxDetector", "Boxes", "HogPeople", "NetworkPeople"]
