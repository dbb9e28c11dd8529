"""Fit of the paths beside the hits: which hits there were, and what they and the glides tell.

In the order of the work:

`traces` has the detections of each stone as arrays. `breaks` and `segment_merging` find where a
path stops being one glide, and `segments` cuts it there and at its hits into pieces. `candidates`
finds where two paths come near enough for a hit; of very many `candidate_pruning` keeps some. `fit`
fits all pieces and the times of all meetings at once, held together by `constraints`; its result is
a `solution.LocalFit`. `hit_detection` strikes off meetings until all that are left are hits.

From a fit with the hits known, `glides` measures the friction, `hits` the restitution, and `spins`
the spins and the friction between stones, with the `noise` of the detections as the shot shows it;
`off_centre` takes out what caps are beside the centres of stones by, where their turning shows it;
`local` puts them together. `shared_error` and `shared_spin` are of errors that detections, and
stones in a hit, have in common; `last_pictures` is of hits too late to be told.
`finite_differences` is the method of the study, for comparison.

A *detection* is a measured place (and angle) of a stone, a *piece* a stretch of one stone's path
without a hit, a *meeting* of two stones what may be a hit, a *contact* one that is.
"""
