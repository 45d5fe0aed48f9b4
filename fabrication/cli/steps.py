"""Progress on the terminal: a line a step, with a tick and its time once it is done."""

from __future__ import annotations

import sys
import time
from typing import Any

import typer

_LIVE, _DONE, _STOPPED = "live", "done", "stopped"


class StepPrinter:
    """A callback (step, done, of): a bar a step on a terminal, a line a step elsewhere.

    A new step ends the one before it: its clock stops. The live step shows how long it has taken
    and, where it knows how much there is, how long it may still take.
    """

    def __init__(self, *, hidden: bool = False, timed: bool = False) -> None:
        self._hidden, self._timed = hidden, timed
        self._lines = _Lines(timed) if not sys.stderr.isatty() else None
        self._bars: _Bars | None = None

    def __call__(self, step: str, done: int, of: int) -> None:
        """Show that a step is at work, and how much of it is done."""
        if self._hidden:
            return
        if self._lines is not None:
            self._lines.show(step)
            return
        if self._bars is None:
            self._bars = _Bars()
        self._bars.show(step, done, of)

    def close(self) -> None:
        """The last step is done."""
        self._end(_DONE)

    def stop(self) -> None:
        """The last step will not end: an error, or Ctrl-C."""
        self._end(_STOPPED)

    def _end(self, state: str) -> None:
        if self._lines is not None:
            self._lines.end()
        if self._bars is not None:
            self._bars.end(state)
            self._bars = None


class _Lines:
    """Plain lines, for logs and pipes."""

    def __init__(self, timed: bool) -> None:
        self._timed = timed
        self._seen: set[str] = set()
        self._live: str | None = None
        self._begin = 0.0

    def show(self, step: str) -> None:
        """A step is at work."""
        if step == self._live:
            return
        self.end()
        self._live, self._begin = step, time.perf_counter()
        if step not in self._seen:
            self._seen.add(step)
            typer.echo(f"{step} ...", err=True)

    def end(self) -> None:
        """It is done."""
        if self._live is not None and self._timed:
            typer.echo(f"{self._live}: {time.perf_counter() - self._begin:.1f} s", err=True)
        self._live = None


class _Bars:
    """Bars that move, with rich."""

    def __init__(self) -> None:
        from rich.console import Console
        from rich.progress import Progress

        console = Console(stderr=True)
        self._progress = Progress(*_columns(console), console=console)
        self._tasks: dict[str, Any] = {}
        self._live: str | None = None
        self._progress.start()

    def show(self, step: str, done: int, of: int) -> None:
        """A step is at work."""
        if step != self._live:
            self._finish(_DONE)
            self._live = step
            self._begin(step)
        self._progress.update(self._tasks[step], completed=done, total=of or None)

    def _begin(self, step: str) -> None:
        """Start the clock of a step, or let it go on."""
        if step not in self._tasks:
            self._tasks[step] = self._progress.add_task(step, total=None, state=_LIVE)
            return
        task = next(task for task in self._progress.tasks if task.id == self._tasks[step])
        before = task.elapsed or 0.0
        self._progress.reset(task.id, state=_LIVE)
        task.start_time = self._progress.get_time() - before

    def _finish(self, state: str) -> None:
        if self._live is None:
            return
        task = self._tasks[self._live]
        if state == _DONE:
            total = next(t.total for t in self._progress.tasks if t.id == task)
            self._progress.update(task, total=total or 1, completed=total or 1)
        self._progress.update(task, state=state)
        self._progress.stop_task(task)
        self._live = None

    def end(self, state: str) -> None:
        """The last step is done, or stopped; nothing moves any more."""
        self._finish(state)
        self._progress.stop()


def _columns(console: Any) -> list[Any]:
    """State, name, bar, count, time taken, time left."""
    from rich.progress import BarColumn, ProgressColumn, SpinnerColumn, Task, TextColumn
    from rich.text import Text

    unicode = console.encoding.startswith("utf")
    marks = {
        _DONE: ("\N{CHECK MARK}" if unicode else "+", "green"),
        _STOPPED: ("\N{MULTIPLICATION SIGN}" if unicode else "x", "red"),
    }

    class State(SpinnerColumn):
        def render(self, task: Task) -> Any:
            state = task.fields["state"]
            return Text(*marks[state]) if state in marks else super().render(task)

    class Count(ProgressColumn):
        def render(self, task: Task) -> Text:
            known = task.total is not None and (task.fields["state"] == _LIVE or task.total > 1)
            return Text(f"{task.completed:.0f}/{task.total:.0f}" if known else "", justify="right")

    class Clock(ProgressColumn):
        max_refresh = 0.5

        def render(self, task: Task) -> Text:
            text = _duration(task.elapsed or 0.0)
            left = task.time_remaining
            if task.fields["state"] == _LIVE and left:
                text += f", about {_duration(left)} left"
            return Text(text)

    return [
        State("dots" if unicode else "line"),
        TextColumn("{task.description:20}"),
        BarColumn(16),
        Count(),
        Clock(),
    ]


def _duration(seconds: float) -> str:
    """Seconds, or minutes and seconds."""
    if seconds < 10.0:
        return f"{seconds:.1f} s"
    if seconds < 60.0:
        return f"{seconds:.0f} s"
    return f"{int(seconds) // 60} min {int(seconds) % 60:02d} s"
