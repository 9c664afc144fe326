// Plays a GLB that `fascia play` wrote with three.js, and compares it at the take's frames with the caches of the
// same take, in which nothing is compressed.
//   node played.mjs PLAY.glb FRAMES_PER_SECOND CACHE.pc2...
import {readFile} from 'node:fs/promises';
import {load, meshesOf, Vector3} from './loading.mjs';

const {AnimationMixer} = await import('three');
const millimetres = 1e3, allowed = 0.15;  // play's own bound and single precision

function cacheOf(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const points = view.getUint32(16, true), frames = view.getUint32(28, true);
  const at = (frame, point) => {
    const place = 32 + 12 * (frame * points + point);
    return new Vector3(view.getFloat32(place, true), view.getFloat32(place + 4, true), view.getFloat32(place + 8, true));
  };
  return {points, frames, at};
}

const [path, rate, ...caches] = process.argv.slice(2);
const gltf = await load(path);
const mixer = new AnimationMixer(gltf.scene);
mixer.clipAction(gltf.animations.at(-1)).play();

/** The vertices of each object of the scene, its primitives one after the other. */
function objectsAt(seconds) {
  mixer.setTime(seconds);
  gltf.scene.updateMatrixWorld(true);
  const objects = new Map();
  for (const mesh of meshesOf(gltf)) {
    const owner = gltf.parser.associations.get(mesh).meshes;
    if (!objects.has(owner)) objects.set(owner, []);
    for (let i = 0; i < mesh.geometry.attributes.position.count; ++i)
      objects.get(owner).push(mesh.getVertexPosition(i, new Vector3()).applyMatrix4(mesh.matrixWorld));
  }
  return [...objects.values()];
}

const distance = (points, cache, frame) => points.reduce((most, p, i) => Math.max(most, p.distanceTo(cache.at(frame, i))), 0);
let worst = 0, moved = 0;
for (const name of caches) {
  const cache = cacheOf(await readFile(name));
  // Objects are known by their number of vertices and by where they are at the beginning.
  const start = objectsAt(0).map((points) => (points.length === cache.points ? distance(points, cache, 0) : Infinity));
  const object = start.indexOf(Math.min(...start));
  for (const frame of [0, Math.floor(cache.frames / 2), cache.frames - 1]) {
    const points = objectsAt(frame / Number(rate))[object];
    worst = Math.max(worst, start[object] === Infinity ? Infinity : distance(points, cache, frame));
    moved = Math.max(moved, cache.at(frame, 0).distanceTo(cache.at(0, 0)), distance(points, cache, 0));
  }
}
console.log(`${path}: ${caches.length} caches, farthest ${(millimetres * worst).toFixed(3)} mm of ${(millimetres * moved).toFixed(1)} mm of motion`);
process.exit(millimetres * worst < allowed && moved > 0.001 ? 0 : 1);
