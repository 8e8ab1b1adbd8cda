"""``python -m situgraph.cli``."""

from situgraph.cli.app import main

if __name__ == "__main__":
    main()
