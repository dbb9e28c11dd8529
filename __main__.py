"""The command ``curlshot`` as ``python -m curlshot``."""

import sys

from curlshot.pipeline import main

if __name__ == "__main__":
    sys.exit(main())
