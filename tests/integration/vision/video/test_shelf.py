"""Things put aside in a file without a name."""

from __future__ import annotations

import gc

from curlshot.vision.video.disk_cache import Cached, DiskCache


def test_a_thing_outlives_whoever_put_it_aside() -> None:
    kept = Cached("as it was")
    kept.put_aside(DiskCache())
    gc.collect()
    assert kept.get() == "as it was"
    del kept
    gc.collect()  # the file closes without a warning
