// Poses of head, controllers and hands in an XR frame, as the arrays of a message to the server.
export const VISIBLE = 1, EMULATED = 2, LEFT_HAND = 4, RIGHT_HAND = 8;
const SIDES = ["left", "right"];
const PINCH = 0.02;
/** Names of the feature with which browsers give the direction of the eyes; there is no standard one. */
export const EYE_FEATURES = ["eye-tracking", "gaze-tracking"];
const EYE_PROFILE = "eye-gaze";

/**
 * Returns {arrays, head, hands, fingers, rays, pressed, tracked}: arrays of the message, and positions in the room of the headset.
 * @param {XRFrame} frame
 * @param {XRReferenceSpace} space local-floor
 */
export function readPoses(frame, space) {
  const viewer = frame.getViewerPose(space);
  const tracked = Boolean(viewer) && !viewer.emulatedPosition;
  let flags = frame.session.visibilityState === "hidden" ? 0 : VISIBLE;
  let press = 0;
  const arrays = [];
  const found = { head: null, hands: {}, fingers: {}, rays: {}, pressed: [], tracked };
  if (viewer) {
    if (!tracked) flags |= EMULATED;
    found.head = viewer.transform;
    arrays.push(["head", pose(viewer.transform)]);
  }
  const eyes = eyeGaze(frame, space);
  if (viewer && eyes) arrays.push(["gaze", pose(eyes)]);
  for (const source of frame.session.inputSources) {
    const k = SIDES.indexOf(source.handedness);
    if (k < 0 || arrays.some(([name]) => name === SIDES[k])) continue;
    const one = source.hand ? wrist(frame, space, source.hand) : grip(frame, space, source);
    if (!one) continue;
    if (source.hand) flags |= k ? RIGHT_HAND : LEFT_HAND;
    if (source.hand ? pinches(frame, space, source.hand) : source.gamepad?.buttons[0]?.pressed) {
      press |= 1 << k;
      found.pressed.push(SIDES[k]);
    }
    const aim = frame.getPose(source.targetRaySpace, space);
    if (aim) found.rays[SIDES[k]] = aim.transform;
    found.hands[SIDES[k]] = one;
    found.fingers[SIDES[k]] = Boolean(source.hand);
    arrays.push([SIDES[k], pose(one)]);
  }
  arrays.push(["flags", new Uint8Array([flags])], ["press", new Uint8Array([press])]);
  return { ...found, arrays };
}

/** Lets the controllers vibrate: side "left", "right", or "" for both; strength 0 to 1. */
export function vibrate(session, side, strength, milliseconds = 60) {
  for (const { handedness, gamepad } of session.inputSources) {
    if (side && handedness !== side) continue;
    const motor = gamepad?.hapticActuators?.[0];
    if (motor?.pulse) motor.pulse(strength, milliseconds);
    else gamepad?.vibrationActuator?.playEffect?.("dual-rumble", { duration: milliseconds, strongMagnitude: strength });
  }
}

/** Pose whose -z is the direction of the eyes; null while they are closed, or for a ray that only follows the head. */
function eyeGaze(frame, space) {
  const granted = EYE_FEATURES.some((name) => frame.session.enabledFeatures?.includes(name));
  const source = [...frame.session.inputSources].find((one) => one.targetRayMode === "gaze" && (granted || one.profiles.includes(EYE_PROFILE)));
  return (source && frame.getPose(source.targetRaySpace, space)?.transform) ?? null;
}

function pose({ position: p, orientation: q }) {
  return new Float32Array([p.x, p.y, p.z, q.x, q.y, q.z, q.w]);
}

function grip(frame, space, source) {
  const found = source.gripSpace && frame.getPose(source.gripSpace, space);
  return found?.transform ?? null;
}

function wrist(frame, space, hand) {
  const joint = hand.get("wrist");
  return (joint && frame.getJointPose?.(joint, space)?.transform) ?? null;
}

function pinches(frame, space, hand) {
  const [thumb, index] = ["thumb-tip", "index-finger-tip"].map((name) => {
    const joint = hand.get(name);
    return joint && frame.getJointPose?.(joint, space)?.transform.position;
  });
  return Boolean(thumb && index) && Math.hypot(thumb.x - index.x, thumb.y - index.y, thumb.z - index.z) < PINCH;
}
