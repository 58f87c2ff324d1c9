// Mirror: a tall mirror in the virtual room, in which participants see their avatar.
import * as THREE from "three";
import { Reflector } from "three/examples/jsm/objects/Reflector.js";

const SIZE = [1.2, 2];
const AWAY = 1.6;
/** Overlay colour that changes nothing: half of the light. */
const CLEAR = new THREE.Color().setRGB(0.5, 0.5, 0.5);

export class Mirror {
  /**
   * @param {Scene3D} scene draws participants without their heads, except in the mirror
   * @param {THREE.Object3D[]} panels what has no mirror image
   */
  constructor(scene, panels) {
    this.group = new THREE.Group();
    this.group.visible = false;
    const glass = new Reflector(new THREE.PlaneGeometry(...SIZE), { textureWidth: 768, textureHeight: 1280, color: CLEAR, clipBias: 0.001, multisample: 4 });
    const reflect = glass.onBeforeRender;
    glass.onBeforeRender = (...args) => {
      this.reflections += 1;
      const shown = panels.filter((one) => one.visible);
      for (const one of shown) one.visible = false;
      scene.withHeads(() => reflect.apply(glass, args));
      for (const one of shown) one.visible = true;
    };
    const frame = new THREE.Mesh(new THREE.BoxGeometry(SIZE[0] + 0.08, SIZE[1] + 0.08, 0.03), new THREE.MeshStandardMaterial({ color: "#6b4a2f", roughness: 0.7 }));
    frame.position.z = -0.02;
    this.group.add(glass, frame);
    this.reflections = 0;
  }

  /** Shows the mirror in front of the participant, where it stays; in the frame of the headset, y up. */
  show(shown, eye, ahead) {
    if (shown && eye && !this.group.visible) {
      const flat = new THREE.Vector3(ahead.x, 0, ahead.z).normalize();
      this.group.position.copy(eye).addScaledVector(flat, AWAY);
      this.group.position.y = SIZE[1] / 2 + 0.06;
      this.group.rotation.set(0, Math.atan2(-flat.x, -flat.z), 0);
    }
    this.group.visible = Boolean(shown && (eye || this.group.visible));
  }

  get shown() {
    return this.group.visible;
  }
}
