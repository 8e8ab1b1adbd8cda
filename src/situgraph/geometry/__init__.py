"""Pure functions on arrays: poses, planes, ellipsoids. No situgraph type appears here but Placement."""
