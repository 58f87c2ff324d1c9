// Textures of meshes: PNG files in the frame of a robot, decoded before the robot is drawn.
import * as THREE from "three";

/** Largest side of an image [pixels]; a larger one is not drawn. */
const MOST = 4096;

/** Decodes the images of a robot; those that cannot be decoded are null, and their triangles keep the plain colour. */
export async function readTextures({ arrays }) {
  const found = [];
  for (let k = 0; arrays[`image${k}`]; k++) found.push(readTexture(arrays[`image${k}`]));
  return Promise.all(found);
}

async function readTexture(bytes) {
  let bitmap;
  try {
    bitmap = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
  } catch {
    return null;
  }
  if (Math.max(bitmap.width, bitmap.height) > MOST) return null;
  const texture = new THREE.Texture(bitmap);
  texture.colorSpace = THREE.SRGBColorSpace;
  texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
  texture.flipY = false; // an ImageBitmap is never turned over: the coordinates are
  texture.anisotropy = 4;
  texture.needsUpdate = true;
  return texture;
}

/** For each triangle, the number of its image, or -1. */
export function imageOfFaces({ faces, textured }) {
  const found = new Int32Array(faces.length / 3).fill(-1);
  for (let k = 0; textured && k < textured.length; k += 3) found.fill(textured[k + 2], textured[k], textured[k + 1]);
  return found;
}
