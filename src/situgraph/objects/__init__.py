"""situgraph."""
