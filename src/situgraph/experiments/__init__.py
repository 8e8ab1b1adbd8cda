"""The experiments, one module each with one entry, on one resumable runner."""
