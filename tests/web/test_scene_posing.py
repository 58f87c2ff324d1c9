"""The page poses people as the simulation does: the modules of the page run in node, without a browser."""

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest

from crowdbot.humans import shapes
from crowdbot.simulation import Simulation
from crowdbot.trials import load_trial
from crowdbot.web.scene import scene_description, scene_frame, scene_resource
from crowdbot.world import worlds_of

pytestmark = pytest.mark.live

SOURCES = Path(__file__).parents[2] / "frontend" / "src"

SKIN = """
import { readFileSync, writeFileSync } from "node:fs";
const [sources, folder] = process.argv.slice(2);
const { decodeFrame } = await import(`${sources}/net/state_frame.mjs`);
const { SceneState } = await import(`${sources}/scene/scene_state.mjs`);
const read = (name) => { const data = readFileSync(`${folder}/${name}`); return data.buffer.slice(data.byteOffset, data.byteOffset + data.length); };
const body = decodeFrame(read("body.bin"));
const state = new SceneState();
state.describe(JSON.parse(readFileSync(`${folder}/description.json`, "utf8")), body);
if (!state.apply(decodeFrame(read("frame.bin")))) throw new Error("the revision differs");
const bones = new Float32Array(state.people * 224);
state.pose(bones, 224);
const { source, bones: index, weights, rest, long, short, group, stature } = body.arrays;
const all = rest.length / 3 / 45;
const out = new Float32Array(3 * state.people * source.length);
const { body: bodies, scale, height, cuts } = state.description.people;
for (let i = 0; i < state.people; i++) for (let v = 0; v < source.length; v++) {
  const who = state.frame.arrays.who[i];
  const cut = [null, long, short][cuts[who][group[v]]];
  const p = [0, 1, 2].map((c) => 1e-4 * scale[who] * rest[3 * (bodies[who] * all + source[v]) + c]);
  if (cut) p.forEach((_, c) => (p[c] += 1e-4 * (height[who] / stature[0]) * cut[3 * v + c]));
  for (let k = 0; k < 4; k++) {
    const at = i * 224 + 8 * index[4 * v + k];
    const [x, y, z, w, dx, dy, dz] = bones.subarray(at, at + 7);
    const t = [2 * (y * p[2] - z * p[1]), 2 * (z * p[0] - x * p[2]), 2 * (x * p[1] - y * p[0])];
    const q = [p[0] + w * t[0] + y * t[2] - z * t[1] + dx, p[1] + w * t[1] + z * t[0] - x * t[2] + dy, p[2] + w * t[2] + x * t[1] - y * t[0] + dz];
    for (let c = 0; c < 3; c++) out[3 * (i * source.length + v) + c] += (weights[4 * v + k] / 65535) * q[c];
  }
}
writeFileSync(`${folder}/skin.bin`, out);
"""  # noqa: E501

BLEND = """
const [sources] = process.argv.slice(2);
const { blendFrames } = await import(`${sources}/scene/blend.mjs`);
const frame = (time, ids, place, bones, extra = {}) => ({ time, arrays: {
  revision: new Uint32Array([1]), ids: new Int32Array(ids), place: new Float32Array(place),
  pelvis: new Float32Array(3 * ids.length), bones: new Int16Array(112 * ids.length).map((_, k) => bones[k % 4]),
  bots: new Uint16Array(0), botplace: new Float32Array(0), links: new Float32Array(0), ...extra } });
const a = frame(1, [7, 8], [0, 0, 3, 0, 0, 5, 5, 0, 0, 0], [32767, 0, 0, 0]);
const b = frame(2, [8, 9], [7, 9, 0, 0, 0, 1, 1, 1, 0, 0], [-32767, 0, 0, 0]);
const c = frame(2, [7], [2, 4, -3, 1, 0], [0, 0, 0, 32767]);
const half = blendFrames(a, b, 0.5), turned = blendFrames(a, c, 0.5);
console.log(JSON.stringify({ time: half.time, ids: Array.from(half.arrays.ids), place: Array.from(half.arrays.place),
  bone: Array.from(half.arrays.bones.subarray(0, 4)), heading: turned.arrays.place[2], x: turned.arrays.place[0],
  quaternion: Array.from(turned.arrays.bones.subarray(0, 4)), first: blendFrames(a, b, 0) === a, last: blendFrames(a, b, 1) === b }));
"""  # noqa: E501


def run_node(folder, text, *arguments):
    script = folder / "script.mjs"
    script.write_text(text)
    done = subprocess.run(["node", script, *arguments], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_skins_of_the_page_are_those_of_the_simulation(tmp_path):
    simulation = Simulation(load_trial("circle-crossing"), 3, posed=True)
    for _ in range(15):
        simulation.advance()
    (tmp_path / "frame.bin").write_bytes(scene_frame(simulation).encode())
    (tmp_path / "description.json").write_text(json.dumps(scene_description(simulation)))
    (tmp_path / "body.bin").write_bytes(scene_resource(simulation, "bodies/2.bin", {}).data)
    run_node(tmp_path, SKIN, str(SOURCES), str(tmp_path))
    motion = worlds_of(simulation.world)[0].people
    expected = motion.skin(2)
    mesh = shapes().levels[2]
    corner = np.stack([mesh.faces.ravel(), np.repeat(mesh.face_region, 3), np.repeat(mesh.face_part, 3)], axis=1)
    source = np.unique(corner, axis=0)[:, 0]
    found = np.fromfile(tmp_path / "skin.bin", dtype=np.float32).reshape(len(expected), len(source), 3)
    assert np.abs(found - expected[:, source]).max() < 1e-3


def test_frames_are_blended_by_person_and_on_the_shorter_way(tmp_path):
    document = json.loads(run_node(tmp_path, BLEND, str(SOURCES)))
    assert document["time"] == 1.5
    assert document["ids"] == [8, 9]
    assert document["place"] == [6, 7, 0, 0, 0, 1, 1, 1, 0, 0]
    assert document["bone"] in ([-32767, 0, 0, 0], [32767, 0, 0, 0])
    assert abs(abs(document["heading"]) - np.pi) < 1e-6
    assert document["x"] == 1
    assert document["quaternion"][0] == document["quaternion"][3] > 0
    assert document["first"]
    assert document["last"]
