// Screens of an experiment for the board in the virtual room.
const TEXTS = {
  done: "The session is complete.\nThank you. You can take the headset off.",
  aborted: "The session has ended.\nThank you. You can take the headset off.",
};

const CAUSES = {
  tracking: ["Tracking of your headset was lost.", "Tracking of another headset was lost."],
  gone: ["Your headset was disconnected.", "Another participant has left."],
  asked: ["You asked for a pause.", "Another participant asked for a pause."],
};

/**
 * Returns why everything stands still, for the participant who moves an avatar.
 * @param {{kind: string, avatar: string}|null} pause its cause; null: the operator
 * @param {string} operator who continues
 */
export function pauseText(pause, avatar, operator) {
  const [own, other] = CAUSES[pause?.kind] ?? [];
  if (!own) return `Paused by the ${operator}.`;
  return `${pause.avatar === avatar ? own : other}\nPlease wait for the ${operator}.`;
}

/**
 * Returns the screen of the state of an experiment, or null while a trial runs or nothing is open.
 * @param {string} wait why a pause is, and what to do
 */
export function experimentScreen(state, wait) {
  if (!state?.open) return null;
  const { phase, index, text, questions, answers } = state;
  if (phase === "screen") return { key: `screen ${index}`, text, questions, answers, button: "Continue" };
  if (phase === "pause") return { key: "pause", text: wait, questions: [], answers: {}, button: "" };
  return phase in TEXTS ? { key: phase, text: TEXTS[phase], questions: [], answers: {}, button: "" } : null;
}

/** Whether the room is empty around the board: between trials, where a picture would show what is over. */
export function emptyRoom(state) {
  return Boolean(state?.open) && (state.phase === "screen" || state.phase in TEXTS);
}

/** The board after the participant has stopped the robots. */
export function stopScreen(pause, close) {
  const button = (text, x, action) => ({ kind: "button", text, x, y: 520, w: 620, h: 120, action: ["do", action] });
  return {
    key: "stop", text: "All robots are stopped.\nThe experimenter releases them.", questions: [], answers: {}, button: "",
    buttons: [button("Pause for everybody", 100, pause), button("Close", 816, close)],
  };
}
