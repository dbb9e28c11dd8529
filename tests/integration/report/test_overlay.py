from __future__ import annotations

import av
import pytest

from curlshot.config import VideoConfig
from curlshot.report.overlay import write_overlay
from curlshot.tests.helpers.report.browser import needs_chromium
from curlshot.tests.helpers.report.clips import camera, pictures
from curlshot.vision.video.reader import open_video


@needs_chromium
def test_it_plays_in_a_browser(browser, tmp_path, shot):
    clip = open_video(pictures(tmp_path, 25), VideoConfig(fps=25.0))
    path = tmp_path / "overlay.mp4"
    assert write_overlay(clip, [camera(k) for k in range(25)], shot.tracks, (), path) == 0.0
    with av.open(str(path)) as video:
        assert video.streams.video[0].average_rate == 25
    page = tmp_path / "page.html"
    page.write_text(
        '<!DOCTYPE html><title>clip</title><video src="overlay.mp4" muted></video>',
        encoding="utf-8",
    )
    with browser.tab() as tab:
        tab.open(page)
        tab.wait("document.querySelector('video').readyState >= 3")
        size = "(v => [v.videoWidth, v.videoHeight, v.duration])(document.querySelector('video'))"
        assert tab.value(size) == [322, 242, pytest.approx(1.0, abs=0.002)]
        tab.value("document.querySelector('video').play()")
        tab.wait("document.querySelector('video').currentTime > 0.2")
        tab.wait("document.querySelector('video').ended")
        assert tab.value("document.querySelector('video').error") is None
        assert tab.complaints == []
