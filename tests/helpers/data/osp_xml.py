"""What tests of osp xml share."""

from __future__ import annotations

from curlshot.data.osp_xml import Thing, parse


def read(lines: list[str]) -> Thing:
    return parse("\n".join(lines).encode(), "a.trk")
