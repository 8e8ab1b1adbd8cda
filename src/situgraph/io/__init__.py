"""Logs in and out: recordings, bags, S-Graphs+ logs, trajectories."""
