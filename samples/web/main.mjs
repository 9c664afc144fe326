// A head with sliders. Drop a rig (.glb) on the page to see it, or a capture (.csv, .json) to play it.
import {loadFascia} from '@fascia/runtime';
import {FasciaFace} from '@fascia/runtime/three';
import * as THREE from 'three';
import {OrbitControls} from 'three/addons/controls/OrbitControls.js';
import {RoomEnvironment} from 'three/addons/environments/RoomEnvironment.js';

const element = (id) => document.getElementById(id);
const panelWidth = 300;
const renderer = new THREE.WebGLRenderer({antialias: true, preserveDrawingBuffer: true});
renderer.toneMapping = THREE.ACESFilmicToneMapping;
document.body.prepend(renderer.domElement);
const scene = new THREE.Scene();
scene.background = new THREE.Color(0x2a2f38);
scene.environment = new THREE.PMREMGenerator(renderer).fromScene(new RoomEnvironment(), 0.04).texture;
scene.environmentIntensity = 0.55;
const key = new THREE.DirectionalLight(0xfff2e4, 1.8);
key.position.set(0.6, 0.9, 1.2);
scene.add(key);
const camera = new THREE.PerspectiveCamera(24, 1, 0.01, 100);
const controls = new OrbitControls(camera, renderer.domElement);

function resize() {
  const width = Math.max(200, innerWidth - panelWidth);
  renderer.setSize(width, innerHeight);
  renderer.setPixelRatio(devicePixelRatio);
  camera.aspect = width / innerHeight;
  camera.updateProjectionMatrix();
}
addEventListener('resize', resize);
resize();

const fascia = await loadFascia();
let face = null, take = null, milliseconds = 0;

async function show(bytes) {
  const made = await FasciaFace.parse(fascia, bytes);
  face?.dispose();
  face = made;
  take = null;
  scene.add(face.scene);
  const box = headBox();
  const centre = box.getCenter(new THREE.Vector3()), size = box.getSize(new THREE.Vector3()).length();
  controls.target.copy(centre);
  camera.position.copy(centre).add(new THREE.Vector3(0.25, 0.06, 1).normalize().multiplyScalar(1.75 * size));
  camera.near = size / 50;
  camera.far = size * 50;
  camera.updateProjectionMatrix();
  element('set').replaceChildren(...Object.keys(face.asset.sets).map((name) => new Option(name)), new Option('channels'));
  if (face.asset.sets.arkit) element('set').value = 'arkit';  // what most people know
  element('level').replaceChildren(...face.asset.levels.map(({name}) => new Option(name)));
  element('level').selectedIndex = face.face.level;
  listSliders();
  element('status').textContent = '';
}

/** The box of what the rig moves that is skin, in the scene. */
function headBox() {
  const box = new THREE.Box3();
  for (const {index, object} of face.parts)
    if (face.asset.meshes[index].part === 'skin') box.expandByObject(object);
  return box.isEmpty() ? box.setFromObject(face.scene) : box;
}

function slider(name, minimum, maximum, set, get) {
  const label = document.createElement('label');
  const input = Object.assign(document.createElement('input'), {type: 'range', min: minimum, max: maximum, step: 0.01,
                                                               value: get()});
  const output = document.createElement('output');
  const write = () => { output.value = Number(input.value).toFixed(2); };
  input.addEventListener('input', () => { set(Number(input.value)); write(); });
  write();
  label.append(Object.assign(document.createElement('span'), {textContent: name, title: name}), input, output);
  label.dataset.name = name.toLowerCase();
  return label;
}

function listSliders() {
  const set = element('set').value, {face: head, asset} = face;
  element('sliders').replaceChildren(...(set === 'channels' ?
    asset.channels.map((channel, i) => slider(channel.name, channel.minimum, channel.maximum,
                                              (value) => { head.values[i] = value; }, () => head.values[i])) :
    asset.sets[set].map((member) => slider(member, 0, 1, (value) => head.set(`${set}:${member}`, value),
                                           () => head.get(`${set}:${member}`)))));
  filter();
}

function filter() {
  const wanted = element('search').value.toLowerCase();
  for (const label of element('sliders').children) label.hidden = !label.dataset.name.includes(wanted);
}

function replay(bytes) {
  if (take) face.stop(take);
  const curves = fascia.loadCurves(bytes);
  take = face.play(curves, {loop: true});
}

element('set').addEventListener('change', listSliders);
element('search').addEventListener('input', filter);
element('level').addEventListener('change', () => face.face.setLevel(element('level').selectedIndex));
element('rest').addEventListener('click', () => {
  if (take) face.stop(take);
  take = null;
  face.face.clear();
  listSliders();
});
element('replay').addEventListener('click', async () => {
  replay(new Uint8Array(await (await fetch('./capture.csv')).arrayBuffer()));
});
addEventListener('dragover', (event) => event.preventDefault());
addEventListener('drop', async (event) => {
  event.preventDefault();
  const file = event.dataTransfer.files[0];
  if (!file) return;
  try {
    const bytes = await file.arrayBuffer();
    if (/\.glb$/i.test(file.name)) await show(bytes);
    else replay(new Uint8Array(bytes));
  } catch (error) {
    element('status').textContent = `${file.name}: ${error.message}`;
  }
});

const clock = new THREE.Clock();
function frame() {
  const seconds = clock.getDelta();
  if (face) {
    const before = performance.now();
    face.update(seconds);
    milliseconds += 0.1 * (performance.now() - before - milliseconds);
    element('status').textContent = `${milliseconds.toFixed(1)} ms a frame for the face`;
  }
  controls.update();
  renderer.render(scene, camera);
}

const response = await fetch('./rig.glb');
if (response.ok) await show(await response.arrayBuffer());
else element('status').textContent = 'drop a rig (.glb) here';
if (new URLSearchParams(location.search).has('still')) {
  // For pictures: ?still&arkit:jawOpen=0.4 poses the face once.
  for (const [name, value] of new URLSearchParams(location.search)) if (name !== 'still') face.face.set(name, Number(value));
  face.pose();
  listSliders();
  controls.update();
  renderer.render(scene, camera);
  document.body.dataset.ready = 'yes';
} else {
  renderer.setAnimationLoop(frame);
}
Object.assign(window, {fascia: {get face() { return face; }, show, replay}});
