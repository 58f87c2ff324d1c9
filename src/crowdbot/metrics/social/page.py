"""Write the reference page of all metrics: ``python -m crowdbot.metrics.social.page FILE``."""

from __future__ import annotations

import sys
from pathlib import Path

from .metric import metric_page

if __name__ == "__main__":
    Path(sys.argv[1]).write_text(metric_page(), encoding="utf-8")
