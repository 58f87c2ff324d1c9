// Meshes of props and doors.
import * as THREE from "three";

const [LEG, CHAIR_LEG] = [0.05, 0.035];

/** Returns the mesh of a prop at its place, or null for one that is not there. `userData.rise` is its origin's height. */
export function propMesh(prop, look) {
  const make = MAKERS[prop.kind];
  if (!make) return null;
  const mesh = make(prop, look);
  mesh.position.set(prop.x, prop.y, 0);
  mesh.rotation.z = prop.heading;
  mesh.userData.rise = prop.kind === "cube" ? 0.5 * prop.size : 0;
  return mesh;
}

/** Returns the leaf of a door, closed; its hinge is the origin. */
export function doorMesh(door, look) {
  const leaf = box(door.width, 0.04, door.height, new THREE.MeshStandardMaterial({
    color: look.door, transparent: true, opacity: 0.55, roughness: 0.25,
  }));
  leaf.position.set(0.5 * door.width, 0, 0.5 * door.height);
  const group = new THREE.Group();
  group.add(leaf);
  group.position.set(door.x, door.y, 0);
  group.rotation.z = door.yaw;
  return group;
}

const MAKERS = {
  cube({ size, color }) {
    const group = new THREE.Group();
    const cube = box(size, size, size, new THREE.MeshLambertMaterial({
      color: new THREE.Color().setRGB(...color, THREE.SRGBColorSpace),
    }));
    cube.position.z = 0.5 * size;
    group.add(cube);
    return group;
  },
  table({ length, width, height }, look) {
    return onLegs(length, width, height, LEG, new THREE.MeshLambertMaterial({ color: look.prop }));
  },
  chair({ length, width, seat, height }, look) {
    const wood = new THREE.MeshLambertMaterial({ color: look.prop });
    const group = onLegs(length, width, seat, CHAIR_LEG, wood);
    const back = box(CHAIR_LEG, width, height - seat, wood);
    back.position.set(0.5 * (CHAIR_LEG - length), 0, 0.5 * (height + seat));
    group.add(back);
    return group;
  },
  tree({ height, trunk, crown }) {
    const group = new THREE.Group();
    const stem = Math.max(0.3 * height, height - 1.6 * crown);
    const tall = 0.5 * (height - stem) + 0.2 * crown;
    const wood = solid(
      new THREE.CylinderGeometry(0.8 * trunk, trunk, stem, 12).rotateX(Math.PI / 2),
      new THREE.MeshLambertMaterial({ color: "#73543a" }),
    );
    wood.position.z = 0.5 * stem;
    const leaves = solid(
      new THREE.IcosahedronGeometry(1, 3),
      new THREE.MeshLambertMaterial({ color: "#5f8f4c" }),
    );
    leaves.scale.set(crown, crown, tall);
    leaves.position.z = height - tall;
    group.add(wood, leaves);
    return group;
  },
};

function onLegs(length, width, height, leg, material) {
  const group = new THREE.Group();
  const top = box(length, width, leg, material);
  top.position.z = height - 0.5 * leg;
  group.add(top);
  for (const a of [-1, 1]) {
    for (const b of [-1, 1]) {
      const foot = box(leg, leg, height - leg, material);
      foot.position.set(0.5 * a * (length - leg), 0.5 * b * (width - leg), 0.5 * (height - leg));
      group.add(foot);
    }
  }
  return group;
}

function box(x, y, z, material) {
  return solid(new THREE.BoxGeometry(x, y, z), material);
}

function solid(geometry, material) {
  const mesh = new THREE.Mesh(geometry, material);
  mesh.castShadow = mesh.receiveShadow = mesh.userData.casts = true;
  return mesh;
}
