"""The gaze of an emulated headset with eye tracking in a real browser; a headset without sends the head only."""

import math

import pytest
from vr_headset import STATE, call, desks, emulated_headsets, enter, wait

from crowdbot.recording import read_episode, replay
from crowdbot.vr import VrServer, read_headset_clock, read_headset_recording

pytestmark = [pytest.mark.live, pytest.mark.xdist_group("headset")]

TRIAL = """<trial name="meet" duration="600" world="planar"><stage><wall points="-6,-4 6,-4 6,4 -6,4 -6,-4"/></stage>
<crowd type="orca"/><avatar name="guest" source="external" x="1" y="0.5" heading="0.5" body="man-20"/>
<robot name="robot" type="turtlebot2" x="3.5" y="0" default-sensors="false"><goal x="-5" y="-1"/>
<navigator type="straight" speed="0.05"/></robot><end goal="false" collision="false"/></trial>"""


def test_the_gaze_reaches_the_episode_and_a_headset_without_eye_tracking_sends_none(browser, modules, serve, tmp_path):
    folder = tmp_path / "files"
    folder.mkdir()
    (folder / "meet.xml").write_text(TRIAL)
    with serve(folder, desks("meet.xml"), VrServer) as app, emulated_headsets(browser, app, modules) as headset:
        page = headset("metaQuestPro")
        half = 0.5 * 0.3  # the eyes look 0.3 rad to the left of a head that is turned by 0.4 rad
        page.evaluate("device.quaternion.set(0, Math.sin(0.2), 0, Math.cos(0.2))")
        page.evaluate(f"device.gaze.quaternion.set(0, Math.sin({half}), 0, Math.cos({half}))")
        enter(page, app)
        wait(page, f"{STATE}?.gaze === true && {STATE}.steps > 5")
        call(app, "vr.save", name="eyes")
        page.context.close()
        plain = headset()
        enter(plain, app)
        wait(plain, f"{STATE}?.hands.length === 2 && {STATE}.steps > 2")
        assert plain.evaluate(f"{STATE}.gaze") is False
    looks = [item.gaze for _, item in read_episode(app.folder / "eyes.mcap").orders if item.gaze]
    assert len(looks) > 3
    assert math.dist(looks[-1], (math.cos(0.3), math.sin(0.3), 0.0)) < 1e-5
    assert replay(app.folder / "eyes.mcap").equal
    records = list(read_headset_recording(app.folder / "eyes-guest.headset"))
    assert sum(record.sample is not None and record.sample.gaze is not None for record in records) > 5
    clock = read_headset_clock(app.folder / "eyes-guest.headset")
    samples = [record for record in records if record.sample is not None]
    behind = [
        sample.time - time
        for sample, time in zip(samples, clock.to_server([s.sample.time for s in samples]), strict=True)
    ]
    assert min(behind) > -0.5 * clock.round_trip.max() - 1e-4  # no message arrives before it was sent
