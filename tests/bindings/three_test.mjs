// three.mjs on geometries of three.js, with a stand-in of the runtime: three_test.mjs NODE_MODULES, which has three.
// Positions, normals and tangents are the face's in each frame, in attributes of the head's own.
import assert from 'node:assert/strict';
import {copyFileSync, mkdtempSync, rmSync, symlinkSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {dirname, join, resolve} from 'node:path';
import {fileURLToPath, pathToFileURL} from 'node:url';

const modules = resolve(process.argv[2]);
const here = dirname(fileURLToPath(import.meta.url));
const folder = mkdtempSync(join(tmpdir(), 'fascia-three-'));  // where the binding finds three
process.on('exit', () => rmSync(folder, {recursive: true}));
copyFileSync(join(here, '../../bindings/web/three.mjs'), join(folder, 'three.mjs'));
symlinkSync(modules, join(folder, 'node_modules'));
const {FasciaFace} = await import(pathToFileURL(join(folder, 'three.mjs')));
const three = await import(pathToFileURL(join(folder, 'node_modules/three/build/three.module.js')));

const vertexCount = 3;
let frame = 0;
const numbers = (width, offset) => Float32Array.from({length: width * vertexCount}, (_, i) => 100 * frame + offset + i);
const face = {
  step: () => { ++frame; return true; },
  positions: () => numbers(3, 0), normals: () => numbers(3, 20),
  tangents: (mesh) => mesh === 2 ? new Float32Array(0) : numbers(4, 40), dispose: () => {},
};
const asset = {
  meshes: [0, 1, 2].map((mesh) => ({mesh, primitive: 0, vertexCount})), createFace: () => face, dispose: () => {},
};

/** Meshes of a file: with tangents, without, and with tangents that the runtime does not take. */
const scene = new three.Group();
const associations = new Map();
const stale = new Float32Array(4 * vertexCount).fill(-1);
for (const mesh of [0, 1, 2]) {
  const geometry = new three.BufferGeometry();
  geometry.setAttribute('position', new three.BufferAttribute(new Float32Array(3 * vertexCount), 3));
  geometry.setAttribute('normal', new three.BufferAttribute(new Float32Array(3 * vertexCount), 3));
  if (mesh !== 1) geometry.setAttribute('tangent', new three.BufferAttribute(stale.slice(), 4));
  const object = new three.Mesh(geometry);
  associations.set(object, {meshes: mesh, primitives: 0});
  scene.add(object);
}
const originals = scene.children.map((object) => object.geometry);
const head = new FasciaFace(asset, {scene, parser: {associations}});
for (const seconds of [0, 1 / 60, 1 / 60]) {
  if (seconds > 0) head.update(seconds);
  const [whole, plain, refused] = scene.children.map((object) => object.geometry.attributes);
  assert.deepEqual(whole.position.array, numbers(3, 0));
  assert.deepEqual(whole.normal.array, numbers(3, 20));
  assert.deepEqual(whole.tangent.array, numbers(4, 40));
  assert.equal(whole.tangent.itemSize, 4);
  assert.equal(plain.tangent, undefined);
  assert.deepEqual(plain.position.array, numbers(3, 0));
  assert.deepEqual(refused.tangent.array, stale);
}
assert.equal(scene.children[0].geometry.attributes.tangent.version, 3);  // sent to the GPU after each
assert.deepEqual(originals[0].attributes.tangent.array, stale);  // another head of the same file keeps its own
console.log('three: positions, normals and tangents are the face\'s');
