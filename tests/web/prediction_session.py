"""A prediction desk without a server, for tests."""

import json
import threading

from crowdbot.web import JobBoard, SessionLimits, Workspace, call_command
from crowdbot.web.prediction import PredictionDesk


class LonelySession:
    """A session without windows that keeps the events."""

    name = "main"

    def __init__(self, folder, readable=()):
        self.workspace, self.events, self.changed = Workspace(folder, readable), [], threading.Condition()
        self.jobs = JobBoard(self.workspace, SessionLimits(), self.tell)

    def tell(self, event, data):
        with self.changed:
            self.events.append((event, json.loads(json.dumps(data, allow_nan=False))))
            self.changed.notify_all()

    def show(self, frame):
        raise AssertionError("the prediction desk sends no frames by itself")


class DeskCaller:
    """Calls commands of a prediction desk as the page does."""

    def __init__(self, folder, kind=PredictionDesk, readable=()):
        self.session = LonelySession(folder, readable)
        self.desk = kind(self.session)
        self.folder = self.session.workspace.folder

    def __call__(self, command, /, **arguments):
        return json.loads(json.dumps(call_command(self.desk, command, arguments), allow_nan=False))

    def events(self, name):
        return [data for event, data in list(self.session.events) if event == f"prediction.{name}"]

    def run(self, seconds=400, **arguments):
        """Run all predictors to the end."""
        before = len(self.events("ended"))
        self("run", **arguments)
        return self.wait(before, seconds)

    def wait(self, before, seconds=400):
        with self.session.changed:
            if not self.session.changed.wait_for(lambda: len(self.events("ended")) > before, seconds):
                raise TimeoutError(str(self.session.events[-3:]))
        return self.events("ended")[-1]

    def predictor(self, label):
        return next(item for item in self.desk.greet()["predictors"] if item["label"].startswith(label))
