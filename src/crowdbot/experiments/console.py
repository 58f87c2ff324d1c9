"""Console: the front end of an experiment that needs nothing but a terminal."""

from __future__ import annotations

import contextlib
import signal
import textwrap
import threading
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from types import FrameType

from crowdbot.core import CrowdbotError, InputError

from .background_run import BackgroundRun
from .event import Abort, Answered, Event, Fail, Next, Pause, Repeat, Resume, Start
from .page import CONTROL
from .question import Choice, Question
from .respondent import Respondent
from .session_runner import SessionRunner

__all__ = ["Console", "ConsoleClosed"]

WIDTH = 78
MENU = {
    "resume": "go on where it stopped",
    "next": "go on without this trial",
    "repeat": "run the trial once more from its beginning",
    "abort": "end the session for good",
    "leave": "close the program; go on later with --resume",
}


class ConsoleClosed(Exception):
    """The experimenter has closed the program; the session waits."""


class Console:
    """Shows screens, reads answers and runs trials until the session is over.

    Ctrl-C pauses, a trial too, and shows a menu.

    Args:
        sitting: of the participant.
        person: who answers.
        write: shows a text to the participant.
        tell: called with what runs and the share that is done, 0 to 1.
    """

    def __init__(
        self,
        sitting: SessionRunner,
        person: Respondent,
        write: Callable[[str], None],
        tell: Callable[[str, float], None],
    ) -> None:
        self.sitting, self.person, self.write, self.tell = sitting, person, write, tell
        self._interrupt = Interrupt()

    def run(self) -> None:
        """Go through the session.

        Raises:
            ConsoleClosed: the session was left before its end.
            InputError: answers that cannot be given anew are missing or wrong; the session waits.
        """
        with self._interrupt:
            while not self.sitting.session.over:
                try:
                    self._step()
                except KeyboardInterrupt:
                    self.sitting.do(Pause("Ctrl-C"))

    def _step(self) -> None:
        phase = self.sitting.session.phase
        if phase == "ready":
            self.sitting.do(Start())
        elif phase == "screen":
            self._screen()
        elif phase == "trial":
            self._trial()
        else:
            self._menu()

    def _screen(self) -> None:
        page, step = self.sitting.page, self.sitting.session.step
        assert page is not None
        text = "\n".join(_wrapped(line) for line in page.text.splitlines())
        self.write(f"\n{'-' * WIDTH}\n{text}\n" if text else f"\n{'-' * WIDTH}\n")
        if text:
            self.sitting.log_screen(text)
        for question in self.sitting.session.open:
            self._ask(step.name, question)
        self.write("\n[Enter] ")
        with self._interrupt.interruptible():
            self.person.go_on()
        self.sitting.do(Next())

    def _ask(self, screen: str, question: Question) -> None:
        text = _asked(question)
        self.write(text)
        self.sitting.log_screen(text.strip())
        while True:
            self.write("> ")
            with self._interrupt.interruptible():
                given = self.person.answer(screen, question)
            try:
                self.sitting.do(Answered(question.name, question.read(given)))
                return
            except InputError as error:
                if not self.person.patient:
                    raise
                self.write(f"  {CONTROL.sub('', str(error))}\n")

    def _trial(self) -> None:
        trial, seed, folder = self.sitting.begin()
        steps = self.sitting.session.steps
        what = f"trial {self.sitting.session.step.number} of {max(step.number for step in steps)}"
        running = BackgroundRun(trial, seed, folder / "episode.mcap")
        self.tell(what, 0.0)
        while self.sitting.session.phase == "running":
            try:
                with self._interrupt.interruptible():
                    while not running.wait(0.2):
                        self.tell(what, running.share)
            except KeyboardInterrupt:
                self._held(running)
                continue
            except BaseException:
                self._given_up(running)
                raise
            self._end(running, folder)
        self.tell(what, 1.0)

    def _held(self, running: BackgroundRun) -> None:
        """Hold a trial, and let it go on unless the experimenter wants something else."""
        running.hold()
        try:
            self.sitting.do(Pause("Ctrl-C"))
            while self.sitting.session.phase == "pause":
                self._menu()
        finally:
            if self.sitting.session.phase == "running":
                running.go()
            else:
                self._given_up(running)

    def _given_up(self, running: BackgroundRun) -> None:
        """Wait until a trial has given up, so that no other one begins beside it."""
        running.give_up()
        try:
            with self._interrupt.interruptible():
                while not running.wait(0.2):
                    pass
        except KeyboardInterrupt:
            raise ConsoleClosed("the trial does not end") from None

    def _end(self, running: BackgroundRun, folder: Path) -> None:
        try:
            episode = running.result()
        except CrowdbotError as error:
            self.sitting.do(Fail(str(error)))
        except Exception as error:  # code that a trial names may raise anything; the session must outlive it
            report = folder / "error.txt"
            trace = "".join(traceback.format_exception(error))
            try:
                report.write_text(trace, encoding="utf-8", errors="backslashreplace")
                where = f"the trace is in {report.name}"
            except OSError as failure:
                where = f"{report.name} cannot be written: {failure.strerror}"
            frame = traceback.extract_tb(error.__traceback__)[-1]
            place = f"{Path(frame.filename).name}, line {frame.lineno}"
            self.sitting.do(Fail(f"{type(error).__name__}: {error} ({place}); {where}"))
        else:
            if episode.failure is None:
                self.sitting.finish(episode)
                return
            report = folder / "error.txt"
            report.write_text(episode.failure.trace, encoding="utf-8")
            self.sitting.do(Fail(f"{episode.failure.message}; more in {report.name}"))

    def _menu(self) -> None:
        session = self.sitting.session
        words = (*session.possible_events, "leave")
        rows = "\n".join(f"  {word:<8}{MENU[word]}" for word in words)
        reason = CONTROL.sub("", session.reason)
        self.write(f"\n{'=' * WIDTH}\nPAUSE{f' ({reason})' if reason else ''}\n{rows}\n> ")
        try:
            with self._interrupt.interruptible():
                word = self.person.choose(words)
        except KeyboardInterrupt:
            word = "leave"
        if word == "leave":
            raise ConsoleClosed(session.reason)
        chosen: dict[str, Event] = {"resume": Resume(), "next": Next(), "repeat": Repeat(), "abort": Abort("menu")}
        self.sitting.do(chosen[word])


class Interrupt:
    """Lets Ctrl-C interrupt only where nothing can be torn; one that comes elsewhere waits until then."""

    def __init__(self) -> None:
        self._open = self._asked = False
        self._before: object = None

    def __enter__(self) -> Interrupt:
        """Take Ctrl-C over, in the main thread."""
        if threading.current_thread() is threading.main_thread():
            self._before = signal.signal(signal.SIGINT, self._ask)
        return self

    def __exit__(self, *error: object) -> None:
        """Give it back."""
        if self._before is not None:
            signal.signal(signal.SIGINT, self._before)  # type: ignore[arg-type]

    @contextlib.contextmanager
    def interruptible(self) -> Iterator[None]:
        """Let Ctrl-C interrupt here."""
        self._open = True
        try:
            if self._asked:
                raise KeyboardInterrupt
            yield
        finally:
            self._open = self._asked = False

    def _ask(self, number: int, frame: FrameType | None) -> None:
        self._asked = True
        if self._open:
            raise KeyboardInterrupt


def _asked(question: Question) -> str:
    """Return a question and what may be answered."""
    lines = [_wrapped(CONTROL.sub("", question.text))]
    if isinstance(question, Choice):
        lines += [f"  {k}  {CONTROL.sub('', option.label)}" for k, option in enumerate(question.options, 1)]
        hint = "numbers with commas between" if question.multiple else "a number"
    else:
        hint = CONTROL.sub("", question.hint)
    return "\n" + "\n".join(lines) + f"\n  ({hint}{'' if question.required else ', or nothing'})\n"


def _wrapped(line: str) -> str:
    return textwrap.fill(line, WIDTH, drop_whitespace=True, replace_whitespace=False) if len(line) > WIDTH else line
