"""A brute force for the matcher, written from ``docs/matching.md`` alone.

It shares no code and no idea with ``situgraph.matching``: a fine grid of yaws, at each yaw every
vertex of the arrangement of all tolerance lines, plain assignments and least squares. It is slow
and simple, and it is what the matcher's answers are held against.
"""
