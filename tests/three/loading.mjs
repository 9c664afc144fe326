// GLB files by three.js, as tests need them: vertices, not pictures.
import {readFile} from 'node:fs/promises';

// What the loader expects of a browser; pictures are not looked at.
globalThis.self = globalThis;
globalThis.Image = class {
  set src(_) {
    this.height = 1;
    queueMicrotask(() => this.onload?.());
  }
};
globalThis.createImageBitmap = async () => ({width: 1, height: 1, close() {}});
const {GLTFLoader} = await import('three/examples/jsm/loaders/GLTFLoader.js');
const {Texture, Vector3} = await import('three');
export {Vector3};
// Pictures of KTX2 are not looked at either.
const pictures = {load: (url, done) => done(new Texture())};

export async function load(path) {
  const bytes = await readFile(path);
  const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
  return new Promise((resolve, reject) => new GLTFLoader().setKTX2Loader(pictures).parse(buffer, '', resolve, reject));
}

/** Meshes in the order of the file: by mesh, then by primitive. */
export function meshesOf(gltf) {
  const found = [];
  gltf.scene.updateMatrixWorld(true);
  gltf.scene.traverse((object) => {
    if (!object.isMesh) return;
    const {meshes, primitives} = gltf.parser.associations.get(object);
    found.push({object, order: [meshes ?? 0, primitives ?? 0]});
  });
  found.sort((a, b) => a.order[0] - b.order[0] || a.order[1] - b.order[1]);
  return found.map((entry) => entry.object);
}
