"""The command line: `counterpoise`, or `python -m counterpoise`."""

import sys

from ._native import run_command_line


def main() -> None:
    """Runs the command line with the arguments of this program, and ends it with the command's exit code."""
    sys.exit(run_command_line(["counterpoise", *sys.argv[1:]]))


if __name__ == "__main__":
    main()
