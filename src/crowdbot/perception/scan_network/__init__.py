"""ScanNetwork: a learned detector of people in planar scans, with its training on generated scans."""

from .detector import ScanNetwork
from .generated_scans import LabelledScan, generate_scan
from .training import NetworkFit, train_scan_network

__all__ = ["LabelledScan", "NetworkFit", "ScanNetwork", "generate_scan", "train_scan_network"]
