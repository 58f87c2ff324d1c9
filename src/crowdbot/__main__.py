"""``python -m crowdbot``."""

from crowdbot.cli import main

raise SystemExit(main())
