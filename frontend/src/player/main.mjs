// Entry of the player: plays the episode in the page, if there is one.
import { decodeFrame } from "../net/state_frame.mjs";
import { BlendBuffer, blendFrames } from "../scene/blend.mjs";
import { Scene2D } from "../scene2d/scene2d.mjs";
import { Scene3D } from "../scene3d/scene3d.mjs";
import { readPack } from "./pack.mjs";
import { Player } from "./player.mjs";

globalThis.crowdbotPlayer = { Scene2D, Scene3D, decodeFrame, blendFrames, BlendBuffer };
const episode = document.getElementById("episode");
if (episode) {
  const player = new Player(document.getElementById("player"), await readPack(episode.textContent));
  episode.remove();
  globalThis.crowdbotPlayer.player = player;
  await player.show();
}
