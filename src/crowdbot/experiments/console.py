"""Console: the terminal front end of experiments."""

from __future__ import annotations

import contextlib
import signal
import textwrap
import threading
from collections.abc import Callable, Iterator, Sequence
from types import FrameType

from crowdbot.core import InputError, PacedClock
from crowdbot.simulation import OrderSource
from crowdbot.trials import Trial

from .background_run import BackgroundRun
from .log import Abort, Answered, Event, Next, Pause, Repeat, Resume, Start
from .page import CONTROL
from .question import Choice, Question
from .respondent import Respondent
from .session_runner import SessionRunner

WIDTH = 78
MENU = {
    "resume": "continue",
    "next": "continue without this trial",
    "repeat": "repeat the trial from its start",
    "abort": "end the session permanently",
    "leave": "close the program; continue later with --resume",
}


class ConsoleClosed(Exception):
    """The experimenter closed the program; the session can be resumed."""


class Console:
    """Shows screens, reads answers and runs trials until the session is over.

    Ctrl-C pauses the session, including a running trial, and shows a menu.

    Args:
        runner: runner of the session of the participant.
        respondent: source of the answers.
        write: shows a text to the participant.
        report: called with the name of the running trial and the completed fraction, 0 to 1.
        rehearse: returns the programs that take the place of the participant in a trial (default: none).
        rate: simulated time over real time in the trials; None: as fast as possible.
        warn: called with a remark for the experimenter, such as that a trial could not keep up with the rate.
    """

    def __init__(
        self,
        runner: SessionRunner,
        respondent: Respondent,
        write: Callable[[str], None],
        report: Callable[[str, float], None],
        rehearse: Callable[[Trial], Sequence[OrderSource]] = lambda trial: (),
        rate: float | None = None,
        warn: Callable[[str], None] = lambda text: None,
    ) -> None:
        self._rehearse, self._rate, self._warn = rehearse, rate, warn
        self.runner, self.respondent, self.write, self.report = runner, respondent, write, report
        self._interrupt = Interrupt()

    def run(self) -> None:
        """Run the session.

        Raises:
            ConsoleClosed: the program was closed before the end of the session.
            InputError: scripted answers are missing or wrong; the session can be resumed.
        """
        with self._interrupt:
            while not self.runner.session.over:
                try:
                    self._step()
                except KeyboardInterrupt:
                    self.runner.do(Pause("Ctrl-C"))

    def _step(self) -> None:
        phase = self.runner.session.phase
        if phase == "ready":
            self.runner.do(Start())
        elif phase == "screen":
            self._screen()
        elif phase == "trial":
            self._trial()
        else:
            self._menu()

    def _screen(self) -> None:
        page, step = self.runner.page, self.runner.session.step
        assert page is not None
        text = "\n".join(_wrapped(line) for line in page.text.splitlines())
        self.write(f"\n{'-' * WIDTH}\n{text}\n" if text else f"\n{'-' * WIDTH}\n")
        if text:
            self.runner.log_screen(text)
        for question in self.runner.session.open:
            self._ask(step.name, question)
            if self.runner.session.over:
                return
        self.write("\n[Enter] ")
        with self._interrupt.interruptible():
            self.respondent.go_on()
        self.runner.do(Next())

    def _ask(self, screen: str, question: Question) -> None:
        text = _asked(question)
        self.write(text)
        self.runner.log_screen(text.strip())
        while True:
            self.write("> ")
            with self._interrupt.interruptible():
                given = self.respondent.answer(screen, question)
            try:
                self.runner.do(Answered(question.name, question.read(given)))
                return
            except InputError as error:
                if not self.respondent.patient:
                    raise
                self.write(f"  {CONTROL.sub('', str(error))}\n")

    def _trial(self) -> None:
        trial, seed, folder = self.runner.begin()
        steps = self.runner.session.steps
        what = f"trial {self.runner.session.step.number} of {max(step.number for step in steps)}"
        clock = None if self._rate is None else PacedClock(trial.step, rate=self._rate)
        sources = self._rehearse(trial)
        running = BackgroundRun(trial, seed, folder / "episode.mcap", clock, self.runner.sinks, sources)
        self.report(what, 0.0)
        while self.runner.session.phase == "running":
            try:
                with self._interrupt.interruptible():
                    while not running.wait(0.2):
                        self.report(what, running.share)
            except KeyboardInterrupt:
                self._held(running)
                continue
            except BaseException:
                self._given_up(running)
                raise
            self.runner.end(running.result, folder)
        self.report(what, 1.0)
        if clock is not None and (remark := clock.late_remark("--rate")):
            self._warn(f"{what}: {remark}")

    def _held(self, running: BackgroundRun) -> None:
        """Pause a trial, and continue it unless the experimenter decides otherwise."""
        running.hold()
        try:
            self.runner.do(Pause("Ctrl-C"))
            while self.runner.session.phase == "pause":
                self._menu()
        finally:
            if self.runner.session.phase == "running":
                running.go()
            else:
                self._given_up(running)

    def _given_up(self, running: BackgroundRun) -> None:
        """Wait until a trial has aborted, before another one begins."""
        running.give_up()
        try:
            with self._interrupt.interruptible():
                while not running.wait(0.2):
                    pass
        except KeyboardInterrupt:
            raise ConsoleClosed("the trial does not stop") from None

    def _menu(self) -> None:
        session = self.runner.session
        words = (*session.possible_events, "leave")
        rows = "\n".join(f"  {word:<8}{MENU[word]}" for word in words)
        reason = CONTROL.sub("", session.reason)
        self.write(f"\n{'=' * WIDTH}\nPAUSE{f' ({reason})' if reason else ''}\n{rows}\n> ")
        try:
            with self._interrupt.interruptible():
                word = self.respondent.choose(words)
        except KeyboardInterrupt:
            word = "leave"
        if word == "leave":
            raise ConsoleClosed(session.reason)
        chosen: dict[str, Event] = {"resume": Resume(), "next": Next(), "repeat": Repeat(), "abort": Abort("menu")}
        self.runner.do(chosen[word])


class Interrupt:
    """Delays Ctrl-C outside of interruptible sections."""

    def __init__(self) -> None:
        self._open = self._asked = False
        self._before: object = None

    def __enter__(self) -> Interrupt:
        """Install the signal handler, in the main thread."""
        if threading.current_thread() is threading.main_thread():
            self._before = signal.signal(signal.SIGINT, self._ask)
        return self

    def __exit__(self, *error: object) -> None:
        """Restore the signal handler."""
        if self._before is not None:
            signal.signal(signal.SIGINT, self._before)  # type: ignore[arg-type]

    @contextlib.contextmanager
    def interruptible(self) -> Iterator[None]:
        """Allow Ctrl-C to interrupt in this section."""
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
    """Return a question with its allowed answers."""
    lines = [_wrapped(CONTROL.sub("", question.text))]
    if isinstance(question, Choice):
        lines += [f"  {k}  {CONTROL.sub('', option.label)}" for k, option in enumerate(question.options, 1)]
        hint = "numbers separated by commas" if question.multiple else "a number"
    else:
        hint = CONTROL.sub("", question.hint)
    return "\n" + "\n".join(lines) + f"\n  ({hint}{'' if question.required else ', or nothing'})\n"


def _wrapped(line: str) -> str:
    return textwrap.fill(line, WIDTH, drop_whitespace=True, replace_whitespace=False) if len(line) > WIDTH else line
