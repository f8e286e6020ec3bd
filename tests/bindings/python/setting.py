"""What all tests import first: with PACKCELL_TEST_NO_NUMPY=1 NumPy cannot be found."""
import os
import sys

if os.environ.get("PACKCELL_TEST_NO_NUMPY") == "1":
    sys.modules["numpy"] = None
try:
    import numpy
except ImportError:
    numpy = None

GOLDEN_SIZES = [(2, 1), (4, 3), (2, 2), (4, 4), (2, 4), (3, 4), (3, 2),
                (3, 1), (3, 5), (2, 2), (2, 2), (2, 3), (5, 5), (2, 4)]
