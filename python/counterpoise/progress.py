"""How far long work is: a bar in a notebook, a line on a terminal."""

from __future__ import annotations

import html
import sys
from collections.abc import Callable
from typing import Any

Progress = Callable[[str, int, int], None]


class ProgressBar:
    """Shows how far work is: give it as `progress` of a method that works long.

    In a notebook it draws a bar below the cell, elsewhere it rewrites one line of the error stream.
    """

    def __init__(self) -> None:
        self._cell: Any = None
        self._width = 0

    def __call__(self, stage: str, done: int, of: int) -> None:
        if _is_notebook():
            self._draw(stage, done, of)
        else:
            self._write(f"{stage} {done} of {of}" if of > 1 else stage)

    def close(self) -> None:
        """Takes the bar away."""
        if self._cell is not None:
            from IPython.display import HTML

            self._cell.update(HTML(""))
            self._cell = None
        elif self._width:
            self._write("")
            print("\r", end="", file=sys.stderr, flush=True)
            self._width = 0

    def _draw(self, stage: str, done: int, of: int) -> None:
        from IPython.display import HTML, display

        count = f" {done} of {of}" if of > 1 else ""
        bar = HTML(f'<progress value="{done}" max="{max(of, 1)}"></progress> {html.escape(stage)}{count}')
        if self._cell is None:
            self._cell = display(bar, display_id=True)
        else:
            self._cell.update(bar)

    def _write(self, text: str) -> None:
        print("\r" + text.ljust(self._width), end="", file=sys.stderr, flush=True)
        self._width = len(text)


class Telling:
    """The `progress` that a method was given; in a notebook, where nothing was given, a bar that goes when the work is done."""

    def __init__(self, progress: Progress | None) -> None:
        self._own = ProgressBar() if progress is None and _is_notebook() else None
        self._progress = progress or self._own

    def __enter__(self) -> Progress | None:
        return self._progress

    def __exit__(self, *_: object) -> None:
        if self._own is not None:
            self._own.close()


def _is_notebook() -> bool:
    """Whether a notebook's kernel runs this: IPython is loaded, and its shell talks to a front end."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return shell is not None and hasattr(shell, "kernel")
