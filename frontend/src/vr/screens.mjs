// Screens of an experiment for the board in the virtual room.
const TEXTS = {
  pause: "Please wait.",
  done: "The session is complete.\nThank you. You can take the headset off.",
  aborted: "The session has ended.\nThank you. You can take the headset off.",
};

/** Returns the screen of the state of an experiment, or null while a trial runs or nothing is open. */
export function experimentScreen(state) {
  if (!state?.open) return null;
  const { phase, index, text, questions, answers } = state;
  if (phase === "screen") return { key: `screen ${index}`, text, questions, answers, button: "Continue" };
  return phase in TEXTS ? { key: phase, text: TEXTS[phase], questions: [], answers: {}, button: "" } : null;
}

/** The board after the participant has stopped the robots. */
export function stopScreen(pause, close) {
  const button = (text, x, action) => ({ kind: "button", text, x, y: 520, w: 620, h: 120, action: ["do", action] });
  return {
    key: "stop", text: "All robots are stopped.\nThe experimenter releases them.", questions: [], answers: {}, button: "",
    buttons: [button("Pause for everybody", 100, pause), button("Close", 816, close)],
  };
}
