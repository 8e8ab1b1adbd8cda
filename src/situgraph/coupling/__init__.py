"""A match and both scene graphs in one factor graph: the robot in the building."""
