// Loads GLB files with three.js and compares what it would draw with our own PLY of the same pose.
//   node load.mjs FILE.glb                            it loads; every number is finite
//   node load.mjs FILE.glb SHAPE|- POSE.ply local|world   with SHAPE at 1, vertices agree to 1e-4 of the head's size
// `local` compares before node transforms (heads that came as OBJ, PLY or STL), `world` after them (GLB, glTF).
import {readFile} from 'node:fs/promises';
import {load, meshesOf, Vector3} from './loading.mjs';

function pointsOf(mesh, shape, space) {
  if (mesh.morphTargetInfluences && shape !== '-') {
    // A head with a shape of that name has ours under another.
    const index = mesh.morphTargetDictionary[`fascia_${shape}`] ?? mesh.morphTargetDictionary[shape];
    if (index !== undefined) mesh.morphTargetInfluences[index] = 1;
  }
  const points = [];
  for (let i = 0; i < mesh.geometry.attributes.position.count; ++i) {
    const point = mesh.getVertexPosition(i, new Vector3());
    points.push(space === 'world' ? point.applyMatrix4(mesh.matrixWorld) : point);
  }
  return points;
}

function plyPoints(text) {
  const count = Number(/element vertex (\d+)/.exec(text)[1]);
  const body = text.slice(text.indexOf('end_header') + 11).split('\n');
  return body.slice(0, count).map((line) => new Vector3(...line.split(' ').slice(0, 3).map(Number)));
}

const [path, shape = '-', ply, space = 'world'] = process.argv.slice(2);
const gltf = await load(path);
const points = meshesOf(gltf).flatMap((mesh) => pointsOf(mesh, shape, space));
if (points.length === 0 || points.some((p) => !Number.isFinite(p.x + p.y + p.z))) {
  console.error(`${path}: three.js finds no vertices, or some that are no numbers`);
  process.exit(1);
}
for (const clip of gltf.animations)
  for (const track of clip.tracks)
    if (track.values.length % track.times.length !== 0) {
      console.error(`${path}: track ${track.name} has ${track.values.length} values for ${track.times.length} keys`);
      process.exit(1);
    }
if (!ply) {
  console.log(`${path}: three.js loads ${points.length} vertices, ${gltf.animations.length} clips`);
  process.exit(0);
}
const expected = plyPoints(await readFile(ply, 'utf8'));
const low = expected.reduce((a, p) => a.clone().min(p), expected[0]);
const high = expected.reduce((a, p) => a.clone().max(p), expected[0]);
// A head far from the origin is near it in a GLB, and where it was in a PLY.
const size = high.distanceTo(low);
if (low.length() > 16 * size && points[0].length() < 16 * size) {
  const offset = expected[0].clone().sub(points[0]);
  points.forEach((p) => p.add(offset));
}
let worst = expected.length === points.length ? 0 : Infinity;
for (let i = 0; i < Math.min(expected.length, points.length); ++i) worst = Math.max(worst, expected[i].distanceTo(points[i]));
worst /= size;
console.log(`${path} ${shape}: ${points.length} vertices, farthest ${worst.toExponential(2)} of the head's size`);
process.exit(worst < 1e-4 ? 0 : 1);
