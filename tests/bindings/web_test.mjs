// The web package on a rig against native positions: node web_test.mjs PACKAGE_FOLDER RIG.glb POSES.json
// POSES.json, by native_poses.py: {"poses": [{"level", "values": {NAME: VALUE}, "frames", "mesh", "positions": BASE64}]},
// metres. Every bit is the native library's. Prints milliseconds a frame.
import assert from 'node:assert/strict';
import {readFile} from 'node:fs/promises';
import {pathToFileURL} from 'node:url';

const [packageFolder, rig, poses] = process.argv.slice(2);
const {loadFascia, FasciaError} = await import(pathToFileURL(`${packageFolder}/index.mjs`));
const fascia = await loadFascia();
const bytes = await readFile(rig);
const asset = fascia.loadAsset(bytes);
const expected = JSON.parse(await readFile(poses));

/** How many of the numbers have other bits, and by how much at most they differ. */
function compare(found, base64, worst) {
  const expected = new Float32Array(new Uint8Array(Buffer.from(base64, 'base64')).buffer);
  assert.equal(found.length, expected.length);
  const bits = [found.slice(), expected].map(({buffer}) => new Uint32Array(buffer));
  for (let i = 0; i < found.length; ++i) {
    worst.others += bits[0][i] !== bits[1][i] ? 1 : 0;
    worst.metres = Math.max(worst.metres, Math.abs(found[i] - expected[i]));
  }
  worst.numbers += found.length;
}

const apart = {numbers: 0, others: 0, metres: 0};
let face = null, posed = '';
for (const {level, values, frames, mesh, positions} of expected.poses) {
  const pose = JSON.stringify([level, values, frames]);
  if (pose !== posed) {  // the meshes of one pose follow each other
    posed = pose;
    face?.dispose();
    face = asset.createFace({level, space: 'metres'});
    for (const [name, value] of Object.entries(values)) face.set(name, value);
    if (frames === 0) face.pose();
    for (let i = 0; i < frames; ++i) face.step(1 / 60);
  }
  compare(face.positions(mesh), positions, apart);
}
face.dispose();
assert.ok(apart.numbers > 0);
assert.equal(apart.others, 0, `${apart.others} of ${apart.numbers} numbers have other bits, up to ${apart.metres} m apart`);

// Time, states, and faults.
face = asset.createFace({level: 0});
const muscle = asset.channels.findIndex(({group}) => group === 'muscle');
const rest = face.positions(0).slice();
face.values[muscle] = 0.8;
for (let i = 0; i < 10; ++i) assert.ok(face.step(1 / 60));
const state = face.save();
face.step(1 / 60);
const after = face.positions(0).slice();
face.restore(state);
face.step(1 / 60);
assert.deepEqual(face.positions(0), after);
assert.notDeepEqual(after, rest);
assert.equal(face.normals(0).length, rest.length);
for (let mesh = 0; mesh < asset.meshes.length; ++mesh) {
  const tangents = face.tangents(mesh).slice(), normals = face.normals(mesh);
  assert.ok(tangents.length === 0 || tangents.length === 4 * asset.meshes[mesh].vertexCount);
  for (let v = 0; v < tangents.length / 4; ++v) {
    const [x, y, z, hand] = tangents.subarray(4 * v, 4 * v + 4);
    assert.ok(Math.abs(Math.hypot(x, y, z) - 1) < 1e-4 && Math.abs(hand) === 1);
    assert.ok(Math.abs(x * normals[3 * v] + y * normals[3 * v + 1] + z * normals[3 * v + 2]) < 1e-4);
  }
}
assert.throws(() => face.tangents(asset.meshes.length), FasciaError);
const curves = fascia.loadCurves(`time,${asset.channels[muscle].name}\n0,0\n1,1\n`);
assert.equal(curves.duration, 1);
face.clear();
face.apply(curves, 0.5);
face.pose();
assert.ok(Math.abs(face.effectiveValues[muscle] - 0.5) < 1e-6);
face.setLayer(1, {combine: 'max', weight: 0.5});
face.layerValues(1)[muscle] = 1;
face.lookAt([0, 0, 1]);
face.blend(0, 0);
face.step(1 / 60);
assert.throws(() => face.set('no such thing', 1), FasciaError);
assert.throws(() => face.setLayer(1, {combine: 'overide'}), FasciaError);
assert.throws(() => face.setLayer(1, {mask: [1]}), FasciaError);
assert.throws(() => face.moveHead([1, 2]), FasciaError);
assert.throws(() => face.lookAt([0, 0]), FasciaError);
assert.throws(() => asset.createFace({space: 'metre'}), FasciaError);
assert.throws(() => asset.createFace({level: 'hihg'}), FasciaError);
assert.throws(() => face.setAll({[asset.channels[muscle].name]: NaN}), FasciaError);
const gone = asset.createFace({level: 0});
gone.dispose();
assert.throws(() => gone.values, FasciaError);
assert.throws(() => fascia.loadAsset(new Uint8Array(10)), FasciaError);
assert.throws(() => face.restore(state.slice(1)), FasciaError);
assert.deepEqual(face.setAll({[asset.channels[muscle].name]: 0.1, nonsense: 1}), ['nonsense']);

const times = {};
for (let level = 0; level < asset.levels.length; ++level) {
  const timed = asset.createFace({level});
  const frames = 60;
  let spent = 0;
  for (let i = 0; i < frames; ++i) {
    timed.values[muscle] = 0.5 - 0.5 * Math.cos(i / 5);
    const before = performance.now();
    timed.step(1 / 60);
    timed.positions(0);
    spent += performance.now() - before;
  }
  times[asset.levels[level].name] = +(spent / frames).toFixed(2);
}
console.log(JSON.stringify({numbers_with_the_native_bits: apart.numbers, milliseconds_a_frame: times, version: fascia.version.join('.')}));
