"""Which detection is which stone, from the first picture to the last.

In the order of the work:

While the clip is read, `watch` takes in frame by frame. `follower` measures the known stones where
they are expected (`expected`): a `lead` has where a stone was, how it moved and how it looked, and
`still` tells by the picture alone that it has not moved. Now and then all the ice is searched for
new ones, and stones whose motion was not known yet are measured `again`. `rows` keeps the
detections in little memory.

When it has been read, `follow` joins the detections to tracks by gating and global assignment
(`assign`), and `rejoin` what goes out of sight to what comes back. `strays` takes out detections of
what covers a stone; `graphic` and `bare` take out tracks of what is none. `naming` names those that
are left, and `late` says which were first seen at rest. `curlshot.vision.track` calls them in this
order.
"""
