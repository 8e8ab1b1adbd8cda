"""Class maps of public data sets, as package data."""
