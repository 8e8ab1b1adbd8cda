"""The command line: each command is a thin shell over one public function that returns a result."""
