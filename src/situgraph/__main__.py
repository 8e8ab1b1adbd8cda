"""``python -m situgraph``: the command line, where its script is not on the path."""

from situgraph.cli.app import main

if __name__ == "__main__":
    main()
