"""What all tests share: their folder on the path, and how hypothesis draws its examples."""

import os
import sys
from pathlib import Path

from hypothesis import settings

sys.path.insert(0, str(Path(__file__).parent))

# Where a run decides over a change, it draws the same examples each time; by hand each run draws new ones.
settings.register_profile("gate", derandomize=True)
if os.environ.get("CI"):
    settings.load_profile("gate")
