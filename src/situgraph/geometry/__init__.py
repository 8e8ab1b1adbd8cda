"""Pure functions on arrays: poses, planes, ellipsoids."""
