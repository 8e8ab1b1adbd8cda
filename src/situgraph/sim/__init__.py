"""A building to drive in: world, sensors, robot; a drive is a recording with its truth apart."""
