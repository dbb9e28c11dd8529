"""How stones are turned: the pictures of their caps against each other.

`angles` gives those of a stone in a clip of any length, part by part. Of one part `handle` turns
each picture onto the clip's own mean picture of that cap: about, by circular cross-correlation
(`facing`), with half turns put right (`half_turns`), and then by registration (`align`). `cover`
leaves out rings that something lies before; `shade` and `glints` take out light that does not turn,
as it is matched; `inclined` unrolls a handle that rises anew, on a plane that rises with it, and
`pitch` takes out what parallax is left. `bearing` tells which way a handle points. At which height
handles are seen all stones tell (`common_height`).
"""
