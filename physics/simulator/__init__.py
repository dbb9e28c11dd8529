"""Event-driven simulation of a shot: one by `simulate.simulate`, many by `many.simulate_many`.

`simulation` has a shot and its outcome, `shot` reads one from a file. `curve` integrates the one
curve that all glides on an ice follow, `motion` lays the path of a stone along it, `approach` finds
when two paths meet, `bounds` when one leaves the play, and `event_queue` keeps what comes next.
`batch` and `paths` do the same for many variants of a shot on arrays.
"""
